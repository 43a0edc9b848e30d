// What the steps of closing an orbit share: units, what a trial says as an orbit, symmetry in time.
#pragma once

#include <functional>

#include "core/periodic/closed_orbit.hpp"
#include "core/periodic/shooting.hpp"

namespace least::periodic {

/// The scene's equations with some parameters of the card as variables, or why there are none.
std::variant<Motion::Equations, std::string> equations_of(const Scene& scene, std::optional<std::size_t> varied);

/// The components of a start, as the equations have them, and the scene that starts at them; backward, if they are.
std::vector<double> components_of(const variations::ParametricScene& equations, const Scene& scene);
std::shared_ptr<const Scene> scene_at(const Setting& setting, const variations::ParametricScene& equations,
                                      const Trial& trial);

/// How far an orbit moves: coordinates, momenta, s and the variables of a flow each as far as those of their kind that
/// move the farthest; 0 where none of a kind moves. Empty: it cannot be followed, for the reason.
std::vector<double> extents_of(Motion& motion, const Trial& trial, double start, Effort& effort, std::string& reason);

/// ẋ of components at a time.
using Rates = std::function<std::vector<double>(std::span<const double> x, double t)>;
/// Whether equations are the same after a time, at places around one.
bool repeats(const Rates& a, const Rates& b, std::span<const double> x, double t, double dt, double later);
/// The components that change their sign where a motion is reversed in time, of those that are 0: a start so that the
/// motion crosses what stays as it is at right angles. Nothing: there are none.
std::optional<std::vector<bool>> reversed_components(const Rates& rates, std::span<const double> x, double t,
                                                     std::size_t coordinates);

/// Half an orbit between two crossings at right angles: what is reversed is 0 at both. `trial`: the guess, which
/// becomes it. False: there is none, for the reason.
bool close_half(Motion& motion, const Setting& setting, const std::vector<bool>& minus, Trial& trial, Effort& effort,
                int& iterations, std::string& reason);

/// An orbit, with its multipliers where it is closed.
Orbit orbit_of(Shooting& shooting, const Setting& setting, const Trial& trial, const Look& look, Effort& effort);

/// The time, of those not too far from a guess, after which a motion comes by far the nearest to its start; the guess
/// itself where it is about as good. The start is that of the guess.
double nearest_return(Motion& motion, const Setting& setting, const Trial& guess, Effort& effort);

/// A family from its first orbit on; `motion`: for the value that it begins with; `take` says of each member whether
/// more are wanted. Why it ends.
std::string follow_family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, const Trial& first,
                          Effort& effort, const std::function<bool(Member&&)>& take);

/// How many states a trajectory of a manifold keeps, and all that they hold.
std::int64_t samples_of_a_curve(const Question& question, std::size_t components);
std::size_t bytes_of_manifolds(const Question& question, std::size_t components);

/// The unstable and the stable manifold of a closed orbit.
std::vector<Manifold> manifolds_of(const Question& question, const Setting& setting, Motion& forward,
                                   const Trial& closed, Effort& effort);

}  // namespace least::periodic

// Shared steps of closing an orbit: units, orbits from trials, time-reversal symmetry.
#pragma once

#include <functional>

#include "core/periodic/closed_orbit.hpp"
#include "core/periodic/shooting.hpp"

namespace least::periodic {

/// equations_of returns the scene's equations with the parameter `varied` as a variable, or why there are none.
std::variant<Motion::Equations, std::string> equations_of(const Scene& scene, std::optional<std::size_t> varied);

/// components_of returns a scene's start in the order of the equations' components; scene_at returns the scene that
/// starts on the trial.
std::vector<double> components_of(const variations::ParametricScene& equations, const Scene& scene);
std::shared_ptr<const Scene> scene_at(const Setting& setting, const variations::ParametricScene& equations,
                                      const Trial& trial);

/// extents_of returns by how much an orbit moves, by component: coordinates, momenta, s, and the variables of a flow,
/// each get the largest extent of their kind, 0 where none of the kind moves. Empty where the orbit cannot be followed;
/// `reason` then says why.
std::vector<double> extents_of(Motion& motion, const Trial& trial, double start, Effort& effort, std::string& reason);

/// Rates returns ẋ at a state and a time.
using Rates = std::function<std::vector<double>(std::span<const double> x, double t)>;
/// repeats tells whether a(x, t) = b(x, t + later), at random places around x and times within dt.
bool repeats(const Rates& a, const Rates& b, std::span<const double> x, double t, double dt, double later);
/// reversed_components looks for a time-reversal symmetry that flips the sign of some components, all 0 at the start:
/// then the orbit crosses the symmetry's fixed set at right angles. Returns by component whether it is flipped; nothing
/// where there is no such symmetry.
std::optional<std::vector<bool>> reversed_components(const Rates& rates, std::span<const double> x, double t,
                                                     std::size_t coordinates);

/// close_half finds half an orbit between two right-angle crossings: the `minus` components are 0 at both. `trial` is
/// the guess and becomes the solution. False: none was found; `reason` says why.
bool close_half(Motion& motion, const Setting& setting, const std::vector<bool>& minus, Trial& trial, Effort& effort,
                int& iterations, std::string& reason);

/// orbit_of returns a trial as an Orbit, with multipliers where it is closed.
Orbit orbit_of(Shooting& shooting, const Setting& setting, const Trial& trial, const Look& look, Effort& effort);

/// nearest_return returns the time, near the guess's period, at which the motion comes closest to its start; the
/// guess's period where that is less than twice as far off.
double nearest_return(Motion& motion, const Setting& setting, const Trial& guess, Effort& effort);

/// follow_family follows a family from its first orbit and returns why it ends. `motion` belongs to the value at which
/// the family begins; `take` receives each member and returns whether more are wanted.
std::string follow_family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, const Trial& first,
                          Effort& effort, const std::function<bool(Member&&)>& take);

/// samples_of_a_curve returns the number of states that a manifold's trajectory keeps; bytes_of_manifolds the memory of
/// all.
std::int64_t samples_of_a_curve(const Question& question, std::size_t components);
std::size_t bytes_of_manifolds(const Question& question, std::size_t components);

/// manifolds_of returns the unstable and the stable manifold of a closed orbit.
std::vector<Manifold> manifolds_of(const Question& question, const Setting& setting, Motion& forward,
                                   const Trial& closed, Effort& effort);

}  // namespace least::periodic

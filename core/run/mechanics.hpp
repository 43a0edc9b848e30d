// A scene as a value, and the interface of the mechanics that it belongs to: cards, runs and the true motion. Problems
// of the catalogue are one implementation (core/catalogue/compiled.hpp).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "core/run/outcome.hpp"
#include "core/state_error.hpp"

namespace least {

class Mechanics;
class RunBackend;
struct Request;
namespace text {
struct TextScene;
}

/// KeepGoing is asked now and then by long computations; false makes them give up.
using KeepGoing = std::function<bool()>;

/// Scene is a mechanics with parameters and a start. It is shared, and not changed once it is shared.
struct Scene {
  std::shared_ptr<const Mechanics> mechanics;
  std::vector<double> parameters;  ///< in the order of the card
  std::vector<double> initial;     ///< in the order of the card's variables
  double start = 0;                ///< t at the start

  const ProblemCard& card() const;
  /// key returns a byte string that two scenes share if and only if their content is the same.
  std::string key() const;
};

/// The true states of a scene at increasing times.
struct Truth {
  std::vector<std::vector<double>> states;  ///< by time; the variables that the motion needs
  double uncertainty = 0;                   ///< as an *error* in the absolute norm
  double relative_uncertainty = 0;          ///< in the relative one
  std::vector<double> sizes;   ///< divisors of the relative norm, from the sizes at these times and the start
  std::string_view how;        ///< closed form | quad (or double) precision run
  bool complete = false;       ///< false: it gave up, or the solution ceased to be finite
  std::string_view missing{};  ///< another reason why it is not complete, if known

  double uncertainty_in(Norm norm) const { return norm == Norm::absolute ? uncertainty : relative_uncertainty; }
  /// The divisors for state_error in this norm.
  std::span<const double> sizes_in(Norm norm) const {
    return norm == Norm::absolute ? std::span<const double>() : std::span<const double>(sizes);
  }
  std::size_t bytes() const;  ///< in memory, about
};

/// Why there is no truth.
namespace missing {
inline constexpr std::string_view
    too_long = "the equations of motion take more operations than a reference solution is made of",
    no_series =
        "the equations of motion hold what no reference solution is made of, as x^y of two that vary or a sum of "
        "very many terms",
    no_motion =
        "the reference solution ends where a formula changes and the forces on either side lead back to the "
        "other, as where friction holds what has come to rest: from there the equations have no solution";
}  // namespace missing

/// can_tell returns whether a truth of this uncertainty suffices to state this error: the uncertainty is at most a
/// tenth of it, or negligible (1e-12).
constexpr bool can_tell(double uncertainty, double error) {
  constexpr double share = 0.1, nothing = 1e-12;
  return uncertainty <= nothing || uncertainty <= share * error;
}

/// Conditioning says how well the states of a motion can be known: how fast small differences of its start grow. Growth
/// is ‖∂x(t)/∂x_j(0)‖ · ‖x(0)‖ / max(1, ‖x(t)‖), the largest over all directions j, with ‖x‖ = max|x_i|: the factor by
/// which a relative error of the start appears in the error at t. In the relative norm it is the largest
/// |∂x_i(t)/∂x_j(0)| · size_j / size_i, which does not depend on units.
struct Conditioning {
  static constexpr std::size_t parts = 8;
  std::size_t variables = 0;                             ///< number of the card's variables that the motion needs
  double growth = 1, most_growth = 1;                    ///< at the end, and the largest along the motion
  double relative_growth = 1, most_relative_growth = 1;  ///< in the relative norm
  std::array<double, parts> so_far{};                    ///< the largest growth up to each eighth of the span
  std::array<double, parts> relative_so_far{};           ///< in the relative norm
  std::vector<double> sizes;                             ///< divisors of the relative norm
  double size = 0;                                       ///< the largest ‖x(t)‖
  double size_halfway = 0;                               ///< the same up to half the span
  double reached = 0;                 ///< time that the motion reaches: the end that was asked for, or earlier
  bool ends = false;                  ///< the motion ends there: it leaves its domain, or ceases to be finite
  bool leaves = false;                ///< it ends because it leaves its domain
  bool complete = true;               ///< false: keep_going() ended the computation
  std::vector<double> pace;           ///< times to look at the motion: evenly by its steps, and where it is fastest
  std::vector<double> relative_pace;  ///< the same where components count in their own sizes
  /// The least and the largest local frequency that the problem estimates along the motion; NaN: it does not.
  double slowest = std::numeric_limits<double>::quiet_NaN(), fastest = std::numeric_limits<double>::quiet_NaN();
  double damping = std::numeric_limits<double>::quiet_NaN();  ///< α where it does not change in time; 0: none
  /// The unit for changes of a conserved energy: the largest |energy| or kinetic energy; 0 where none is conserved.
  double energy = 0;

  /// Growth in a norm: at the end, or the largest.
  double growth_in(Norm norm, bool at_end) const {
    if (norm == Norm::absolute) return at_end ? growth : most_growth;
    return at_end ? relative_growth : most_relative_growth;
  }
  const std::array<double, parts>& so_far_in(Norm norm) const {
    return norm == Norm::absolute ? so_far : relative_so_far;
  }
  const std::vector<double>& pace_in(Norm norm) const { return norm == Norm::absolute ? pace : relative_pace; }
  /// Whether differences grow exponentially all along the span: by a large factor in each of its last two quarters.
  /// Growth as a power of time, or in a single close passage, does not count.
  bool chaotic(Norm norm = Norm::absolute) const;
  /// Whether the state outgrows its size in the first half of the span, as an angle that keeps turning.
  bool travels() const { return size > 1.5 * size_halfway; }
  std::size_t bytes() const;  ///< in memory, about
};

/// Scales are the characteristic time, energy and length of a motion near its start; 0 where the start does not tell,
/// as in an equilibrium, or on a straight line at constant speed.
struct Scales {
  double time = 0;      ///< about the inverse of an angular frequency: a period is some six of it
  double energy = 0;    ///< about the kinetic energy within that time; 0 for a flow
  double length = 0;    ///< about the distance that a coordinate moves within that time
  bool damped = false;  ///< H is linear in s: steps in a transformed time follow another power of the kinetic energy
};

/// RegularStart is the state of the one regular motion from a singular start, at a later time, for a run that is given
/// that time but no state. Where there is an objection, the run has to be given a state.
struct RegularStart {
  std::vector<double> state;  ///< in the order of the card's variables
  std::string objection;      ///< why that motion has no state at this time; empty: it has
};

/// PaceMark is a time at which a motion should be looked at, and its speed there: see core/run/landmarks.hpp.
struct PaceMark {
  double t = 0, speed = 0;
};

class Mechanics {
 public:
  virtual ~Mechanics() = default;

  virtual const ProblemCard& card() const = 0;
  /// A byte string of its content, different for any two mechanics that differ.
  virtual std::string_view key() const = 0;
  /// The text that the scene was given as; null for a problem of the catalogue.
  virtual const text::TextScene* text() const { return nullptr; }
  /// The cards of all schemes; a request's scheme is a position among them.
  virtual std::span<const SchemeCard> schemes() const = 0;

  /// run executes a checked request (every value within its card's range, problem and scheme fit). Samples go to the
  /// sink as they come; `cancelled` is read between blocks of steps. It never throws for numerical reasons: every end
  /// is a status.
  virtual Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const = 0;

  /// What a run of this request needs of the problem. The mechanics and the request's scene have to outlive it.
  virtual std::unique_ptr<const RunBackend> backend(const Request& request) const = 0;

  /// The regular start at the time t; empty where the card's own start holds at every time.
  virtual std::optional<RegularStart> regular_start(std::span<const double> parameters, double t) const = 0;

  /// The characteristic scales of a scene, in its units.
  virtual Scales scales(const Scene&) const { return {}; }

  // The true motion, computed anew.
  virtual Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const = 0;
  /// Conditioning of the motion from the start to `end`.
  virtual Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const = 0;
  /// At most 128 times to look at the motion, from the start to `end` or as far as it goes, in order.
  virtual std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const = 0;
  /// The time at which the motion becomes infinite, if that is before `latest`, else NaN. `step` is a length of time in
  /// which little changes.
  virtual double blow_up_time(const Scene& scene, double latest, double step, const KeepGoing& keep_going) const = 0;
};

/// weight_of_force returns how many times longer than for a small scene a force evaluation may take, at least 1. Checks
/// of a finished run use so many times fewer of them.
std::int64_t weight_of_force(const Mechanics& mechanics);

/// truth_along returns the true states at these increasing times. In the relative norm, sizes of components are those
/// along the whole motion up to the last time, not only at these times.
Truth truth_along(const Scene& scene, const std::vector<double>& times, Norm norm, const KeepGoing& keep_going);

}  // namespace least

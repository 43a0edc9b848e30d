// A scene as a value, and what can be asked of the mechanics it is a scene of, erased: cards, runs and the true motion.
// Problems of the catalogue are one kind of mechanics (core/catalogue/compiled.hpp).
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

/// Asked now and then by what may take long; false gives up.
using KeepGoing = std::function<bool()>;

/// Shared, and never changed once it is shared.
struct Scene {
  std::shared_ptr<const Mechanics> mechanics;
  std::vector<double> parameters;  ///< in the order of the card
  std::vector<double> initial;     ///< in the order of the card's variables
  double start = 0;                ///< t at the start

  const ProblemCard& card() const;
  /// The same for scenes of the same content and for no others, whatever holds them.
  std::string key() const;
};

/// The true states of a scene at increasing times.
struct Truth {
  std::vector<std::vector<double>> states;  ///< by time; the variables that the motion has
  double uncertainty = 0;                   ///< as an *error* in the absolute norm
  double relative_uncertainty = 0;          ///< in the relative one
  std::vector<double> sizes;                ///< what the relative norm divides by, as seen at these times and the start
  std::string_view how;                     ///< closed form | quad (or double) precision run
  bool complete = false;                    ///< false: it was told to give up, or the solution ceased to be finite
  std::string_view missing{};               ///< why it is not complete, where that is known to be something else

  double uncertainty_in(Norm norm) const { return norm == Norm::absolute ? uncertainty : relative_uncertainty; }
  /// What a state_error in this norm asks for.
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

/// Whether a truth so uncertain can tell of such an error: it is a tenth of it at most, or next to nothing.
constexpr bool can_tell(double uncertainty, double error) {
  constexpr double share = 0.1, nothing = 1e-12;
  return uncertainty <= nothing || uncertainty <= share * error;
}

/// How well the states of a motion can be known: how fast small differences of its start grow. Growth is
/// ‖∂x(t)/∂x_j(0)‖ · ‖x(0)‖ / max(1, ‖x(t)‖), the largest of all directions j, with ‖x‖ = max|x_i|: how many times a
/// relative error of the start appears in the error at t. In the relative norm each component counts in its own size,
/// so that growth does not depend on units: it is the largest |∂x_i(t)/∂x_j(0)| · size_j / size_i.
struct Conditioning {
  static constexpr std::size_t parts = 8;
  std::size_t variables = 0;                             ///< of the card, that the motion has
  double growth = 1, most_growth = 1;                    ///< at the end, and the largest
  double relative_growth = 1, most_relative_growth = 1;  ///< in the relative norm
  std::array<double, parts> so_far{};                    ///< the largest growth up to each eighth of the span
  std::array<double, parts> relative_so_far{};           ///< in the relative norm
  std::vector<double> sizes;                             ///< what the relative norm divides by
  double size = 0;                                       ///< the largest ‖x(t)‖
  double size_halfway = 0;                               ///< the same up to half the span
  double reached = 0;                 ///< time up to which the motion goes on, if not to the end that was asked for
  bool ends = false;                  ///< it leaves its domain there, or ceases to be finite
  bool leaves = false;                ///< it ends because it leaves its domain
  bool complete = true;               ///< false: given up on the way
  std::vector<double> pace;           ///< times that follow the motion: evenly by its steps, and where it is fastest
  std::vector<double> relative_pace;  ///< the same where components count in their own sizes
  /// The least and the largest local frequency that the problem estimates along the motion; NaN: it does not.
  double slowest = std::numeric_limits<double>::quiet_NaN(), fastest = std::numeric_limits<double>::quiet_NaN();
  double damping = std::numeric_limits<double>::quiet_NaN();  ///< α where it does not change in time; 0: none
  /// What changes of a kept energy are measured by: the largest |energy| or kinetic energy; 0 where none is kept.
  double energy = 0;

  /// At the end, or the largest.
  double growth_in(Norm norm, bool at_end) const {
    if (norm == Norm::absolute) return at_end ? growth : most_growth;
    return at_end ? relative_growth : most_relative_growth;
  }
  const std::array<double, parts>& so_far_in(Norm norm) const {
    return norm == Norm::absolute ? so_far : relative_so_far;
  }
  const std::vector<double>& pace_in(Norm norm) const { return norm == Norm::absolute ? pace : relative_pace; }
  /// Whether differences grow exponentially all along the span: by far in each of its last quarters. What grows as a
  /// power of time, or in a single close passage, does not.
  bool chaotic(Norm norm = Norm::absolute) const;
  /// Whether the motion goes ever further, as an angle that turns.
  bool travels() const { return size > 1.5 * size_halfway; }
  std::size_t bytes() const;  ///< in memory, about
};

/// How long, how strong and how wide a motion is near its start; 0 where that does not tell, as in an equilibrium, or
/// on a straight line at constant speed.
struct Scales {
  double time = 0;      ///< about the inverse of an angular frequency: a period is some six of it
  double energy = 0;    ///< about the kinetic energy within that time; 0 for a flow
  double length = 0;    ///< about the way of a coordinate within that time
  bool damped = false;  ///< H is linear in s: steps in a transformed time follow another power of the kinetic energy
};

/// The state of a run that names a time after a singular start but none itself: that of the one regular motion from
/// there. Where there is an objection, the state has to be given.
struct RegularStart {
  std::vector<double> state;  ///< in the order of the card's variables
  std::string objection;      ///< why that motion has no state at this time; empty: it has
};

/// A time at which a motion should be looked at, and how fast it is there: of core/run/landmarks.hpp.
struct PaceMark {
  double t = 0, speed = 0;
};

class Mechanics {
 public:
  virtual ~Mechanics() = default;

  virtual const ProblemCard& card() const = 0;
  /// Its content, which tells it from every other mechanics.
  virtual std::string_view key() const = 0;
  /// Where the scene was given as text: what was given. Else null.
  virtual const text::TextScene* text() const { return nullptr; }
  /// The cards of all schemes; a request's scheme is a position among them.
  virtual std::span<const SchemeCard> schemes() const = 0;

  /// Runs a checked request (every value within its card's range, the pair fits). Samples go to the sink as they come;
  /// `cancelled` is looked at between blocks of steps. Never throws for numerical reasons: every end is a status.
  virtual Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const = 0;

  /// What a run of such a request asks of the problem. The mechanics and the request's scene outlive it.
  virtual std::unique_ptr<const RunBackend> backend(const Request& request) const = 0;

  /// At the time t; empty where the card's own start stands for every time.
  virtual std::optional<RegularStart> regular_start(std::span<const double> parameters, double t) const = 0;

  /// In the units of the scene.
  virtual Scales scales(const Scene&) const { return {}; }

  // The true motion, computed anew.
  virtual Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const = 0;
  /// From the start to `end`.
  virtual Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const = 0;
  /// Where to look at it, from the start to `end` or as far as it goes: no more than 128 times, in their order.
  virtual std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const = 0;
  /// When it becomes infinite, if it does so before `latest`, else NaN. `step`: a length of time in which little
  /// happens.
  virtual double blow_up_time(const Scene& scene, double latest, double step, const KeepGoing& keep_going) const = 0;
};

/// How many forces of a scene of some size take as long as one of this one: 1, and more where its texts are long. What
/// looks at a run when it is over takes so many times fewer.
std::int64_t weight_of_force(const Mechanics& mechanics);

/// The true states at these times, which increase; in the relative norm the sizes of components are those of the whole
/// way to the last of them, wherever the others lie.
Truth truth_along(const Scene& scene, const std::vector<double>& times, Norm norm, const KeepGoing& keep_going);

}  // namespace least

// What the states of a run depend on: their derivatives by numbers of the start and parameters, along the true motion
// from the start of the run.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "core/variations/parametric.hpp"

namespace least::variations {

/// Something that derivatives are by.
struct Quantity {
  enum class Kind : std::uint8_t { variable, velocity, parameter, time };
  Kind kind = Kind::variable;
  std::size_t index = 0;  ///< of the card's variables or parameters; of velocities that of the coordinate
};

inline constexpr std::size_t most_quantities = 64, most_in_pairs = 16;

/// Of what: the true motion, or the map that the scheme is.
inline constexpr std::array<std::string_view, 2> map_names{"motion", "scheme"};

/// What is asked for beside a run.
struct SensitivitiesAsked {
  std::vector<Quantity> by;
  std::vector<std::string> names;  ///< of these, as JSON pointers
  bool whole_start = false;        ///< by all variables of the motion: then the structure of the map is told
  bool keeps_velocities = false;   ///< where one number changes, the velocities of the start stay, and not the momenta
  int order = 1;
  bool of_scheme = false;
  bool at_samples = false;
  std::shared_ptr<const ParametricScene> equations;
};

/// Derivatives of the state at one time: those of its first component by all quantities, then of the next.
using Slopes = std::vector<double>;

/// What was found. A number that cannot be said is NaN.
struct Sensitivities {
  std::vector<std::string> rows;  ///< names of the components of the state
  Slopes final;                   ///< empty: not found, for the reason given
  /// Of order 2: of which two quantities each, and the derivatives at the end as those of first order stand.
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  Slopes second;
  std::vector<Slopes> samples;
  /// Of each event of the run its name, and the derivatives of its time.
  std::vector<std::pair<std::string, std::vector<double>>> events;
  double uncertainty = unknown;  ///< an estimate of the largest error of an entry, divided by the largest entry
  std::string reason;
  std::vector<Report> structure;  ///< kind, max_defect and factor of the whole map; empty: not asked for
  Held held = HeldByThread::take(0);
};

/// The quantities that are parameters, marked among those of the card.
std::vector<bool> varied_parameters(const SensitivitiesAsked& asked, std::size_t parameters);

/// Along the motion of a run from its start to where it came, at its end, at its events and, where samples are asked
/// for, at these times, which do not decrease. Where an event has ended the run, the end is that event, whose time
/// changes, too. `tolerance` as that of the scheme `taylor`. Throws MemoryShortage.
Sensitivities sensitivities_of_motion(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, double tolerance, const KeepGoing& keep_going);

/// The same of the map of the request's scheme, of equal steps, by dual numbers through its steps; samples are whole
/// steps. Times of events have no derivatives. The control are differences of runs.
Sensitivities sensitivities_of_scheme(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, const KeepGoing& keep_going);

/// The name of an event of a run that was asked for, or the kind of one of its own.
std::string name_of_event(const Report& event);

}  // namespace least::variations

// Derivatives of the states of a run by its start and parameters, along the true motion from the start of the run.
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

/// Quantity is something to differentiate by.
struct Quantity {
  enum class Kind : std::uint8_t { variable, velocity, parameter, time };
  Kind kind = Kind::variable;
  std::size_t index = 0;  ///< of the card's variables or parameters; for a velocity, that of its coordinate
};

inline constexpr std::size_t most_quantities = 64, most_in_pairs = 16;

/// What is differentiated: the true motion, or the map of the scheme.
inline constexpr std::array<std::string_view, 2> map_names{"motion", "scheme"};

/// SensitivitiesAsked is what a request asks for beside its run.
struct SensitivitiesAsked {
  std::vector<Quantity> by;
  std::vector<std::string> names;  ///< names of `by`, as JSON pointers
  bool whole_start = false;  ///< `by` contains all variables of the motion: then the structure of the map is reported
  /// While one number changes, the other velocities of the start stay fixed instead of the momenta
  bool keeps_velocities = false;
  int order = 1;
  bool of_scheme = false;
  bool at_samples = false;
  std::shared_ptr<const ParametricScene> equations;
};

/// Slopes are the derivatives of the state at one time: those of its first component by all quantities, then of the
/// next.
using Slopes = std::vector<double>;

/// Sensitivities is the result. Numbers that are not known are NaN.
struct Sensitivities {
  std::vector<std::string> rows;  ///< names of the components of the state
  Slopes final;                   ///< empty where none were found; `reason` says why
  /// Of order 2: the pairs of quantities, and the second derivatives at the end, component by component and then by
  /// pair.
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  Slopes second;
  std::vector<Slopes> samples;
  /// By event of the run: its name, and the derivatives of its time by all quantities.
  std::vector<std::pair<std::string, std::vector<double>>> events;
  double uncertainty = unknown;  ///< an estimate of the largest error of an entry, divided by the largest entry
  std::string reason;
  /// kind, max_defect and factor of the map from start to end; empty where not asked for
  std::vector<Report> structure;
  Held held = HeldByThread::take(0);
};

/// varied_parameters marks, among the card's parameters, those that are differentiated by.
std::vector<bool> varied_parameters(const SensitivitiesAsked& asked, std::size_t parameters);

/// sensitivities_of_motion differentiates along the motion of a run: at its end, at its events and at these ascending
/// times of samples. Where an event has ended the run, the end is that event, and its time changes with the quantities.
/// `tolerance` is used as by the scheme `taylor`. Throws MemoryShortage.
Sensitivities sensitivities_of_motion(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, double tolerance, const KeepGoing& keep_going);

/// sensitivities_of_scheme differentiates the map of the request's fixed-step scheme, by dual numbers through its
/// steps; samples are at whole steps. Event times have no derivatives. The uncertainty comes from differences of runs.
Sensitivities sensitivities_of_scheme(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, const KeepGoing& keep_going);

/// name_of_event returns the name of an event that was asked for, or the kind of an event of the run's own.
std::string name_of_event(const Report& event);

}  // namespace least::variations

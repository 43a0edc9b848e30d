// A step of a scene by a scheme, as a trace: the scheme itself is run with recording numbers (core/ensemble/traced.hpp)
// in the place of state, time and step. The same trace holds the columns of a run, and the conditions under which a run
// can begin.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/ensemble/lane_compiler.hpp"
#include "core/run/request.hpp"

namespace least {

/// StepTrace holds one trace, including the constants that parameters have become, and the places of its results.
struct StepTrace {
  using Place = Trace::Place;
  Trace trace;
  std::vector<std::uint32_t> rows;  ///< by component of the state, its place on the card
  std::vector<Place> start;         ///< must be finite for a run to begin
  Place pole = -1;                  ///< must be 0 at the start of a run with steps of length h; −1: no such condition
  Place inside = -1;   ///< must not be negative, at the start and after each step; −1: the motion has no bounds
  Place turn = -1;     ///< the squared frequency ω² at the start; −1: the scene has none
  Place damping = -1;  ///< α where it is constant; −1: it is not, or there is none
  bool turn_is_fixed = false;  ///< ω² is the same in all states
  Place turn_limit = -1;       ///< the constant that ω² must not exceed after a step; −1: ω² is not checked there
  std::vector<Place> parameters;  ///< the constants that stand for the varied parameters, in their order
  std::vector<Place> columns;     ///< of the request
  // Some columns take functions that lanes do not have; these are finished outside of the trace.
  std::vector<std::size_t> wrapped;                           ///< columns that are angles, to be reduced to [−π, π)
  std::vector<std::pair<std::size_t, std::size_t>> elements;  ///< (column, number of its orbital element)
  std::vector<Place> orbit;                                   ///< q, p and μ from which these elements follow
  Place values_end = 0;      ///< the end of the part of the trace that holds all of the above
  Place begin = 0, end = 0;  ///< the step; empty where none was asked for
  std::vector<std::pair<Place, Place>> kept;
  std::vector<Place> state;  ///< the state after the step
  Place failed = -1;         ///< a StepFailure; −1: steps cannot fail
  std::int64_t forces_at_start = 0, forces_of_step = 0;

  /// has_shape_of tells whether two traces are equal but for the values of constants.
  bool has_shape_of(const StepTrace& other) const {
    return trace.nodes() == other.trace.nodes() && kept == other.kept && state == other.state && start == other.start &&
           columns == other.columns;
  }
};

/// trace_text traces a scene given as text, with these parameters, and the scheme at that place of lane_schemes;
/// `full`: with s. Nothing where lanes cannot run it: its rates are found by iteration, or a step takes too many
/// operations.
std::optional<StepTrace> trace_text(const Request& request, std::span<const double> parameters, std::size_t scheme,
                                    bool full);

/// trace_problem traces a problem of the catalogue, the scene of the request. Parameters in `varied` become unfolded
/// constants, so that members can have their own values. Without a scheme no step is traced. Nothing where lanes cannot
/// run it: its start is a series, or its state has a tangent.
std::optional<StepTrace> trace_problem(const Request& request, std::span<const std::size_t> varied,
                                       std::optional<std::size_t> scheme, bool full);

}  // namespace least

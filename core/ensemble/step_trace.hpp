// A step of a scene under a scheme, written down: the scheme itself is run, with numbers that record
// (core/ensemble/traced.hpp) in the place of the state, the time and the step. The same trace holds what a run asks of
// states: its columns, and what must hold where a run begins.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/ensemble/lane_compiler.hpp"
#include "core/run/request.hpp"

namespace least {

/// All of it stands on one trace, with the constants that the parameters have become.
struct StepTrace {
  using Place = Trace::Place;
  Trace trace;
  std::vector<std::uint32_t> rows;  ///< the variables of the card that the state is made of
  std::vector<Place> start;         ///< what has to be finite where a run begins
  Place pole = -1;             ///< what must not be set there if there are steps, which are as long as h; −1: nothing
  Place inside = -1;           ///< what must not be negative there, nor after a step; −1: the motion has no bounds
  Place turn = -1;             ///< the squared frequency ω² there; −1: the scene says none
  Place damping = -1;          ///< α where it is constant; −1: it is not, or there is none
  bool turn_is_fixed = false;  ///< ω² is the same in all states
  Place turn_limit = -1;  ///< the constant that ω² must not exceed after a step; −1: ω² is not looked at there
  std::vector<Place> parameters;  ///< the constants that stand for those parameters that vary, in their order
  std::vector<Place> columns;     ///< of the request
  // Some columns take functions that lanes have not, and are finished outside of the trace.
  std::vector<std::size_t> wrapped;  ///< those columns that are angles, to be brought into [−π, π)
  std::vector<std::pair<std::size_t, std::size_t>> elements;  ///< columns with the numbers of their orbital elements
  std::vector<Place> orbit;                                   ///< the q, p and μ that these elements follow from
  Place values_end = 0;      ///< the end of that part of the trace which holds all of the above
  Place begin = 0, end = 0;  ///< the step; empty where none was asked for
  std::vector<std::pair<Place, Place>> kept;
  std::vector<Place> state;  ///< after it
  Place failed = -1;         ///< a StepFailure after it; −1: no step fails
  std::int64_t forces_at_start = 0, forces_of_step = 0;

  /// The same but for the values of constants.
  bool has_shape_of(const StepTrace& other) const {
    return trace.nodes() == other.trace.nodes() && kept == other.kept && state == other.state && start == other.start &&
           columns == other.columns;
  }
};

/// The scene of a request, given as text, with these parameters under the scheme at that place of lane_schemes; with s
/// where it is `full`. Nothing where lanes cannot run it: its rates are found by iteration, or a step takes too many
/// operations.
std::optional<StepTrace> trace_text(const Request& request, std::span<const double> parameters, std::size_t scheme,
                                    bool full);

/// A problem of the catalogue, which the request has as its scene; those parameters that are `varied` become constants
/// that are not folded, so that each member may have its own. Without a scheme no step is written down. Nothing where
/// lanes cannot run it: its start is a series, or its state has a tangent.
std::optional<StepTrace> trace_problem(const Request& request, std::span<const std::size_t> varied,
                                       std::optional<std::size_t> scheme, bool full);

}  // namespace least

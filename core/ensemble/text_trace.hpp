// A step of a scene as text under a scheme, written down: the scheme itself is run, with numbers that record
// (core/ensemble/traced.hpp) in the place of the state, the time and the step.
#pragma once

#include <optional>

#include "core/ensemble/lane_compiler.hpp"
#include "core/run/request.hpp"

namespace least {

/// All of it stands on one trace, with the constants that the parameters have become.
struct TextTrace {
  using Place = Trace::Place;
  Trace trace;
  std::vector<std::uint32_t> rows;  ///< the variables of the card that the state is made of
  std::vector<Place> start;         ///< what has to be finite where a run begins
  Place pole = -1;             ///< what must not be set there if there are steps, which are as long as h; −1: nothing
  std::vector<Place> columns;  ///< of the request
  Place values_end = 0;        ///< so far of the trace all that is needed
  Place begin = 0, end = 0;    ///< the step
  std::vector<std::pair<Place, Place>> kept;
  std::vector<Place> state;  ///< after it
  Place failed = -1;
  std::int64_t forces_at_start = 0, forces_of_step = 0;

  /// The same but for the values of constants.
  bool has_shape_of(const TextTrace& other) const {
    return trace.nodes() == other.trace.nodes() && kept == other.kept && state == other.state && start == other.start &&
           columns == other.columns;
  }
};

/// The scene of a request with these parameters under its scheme, which is at that place of lane_schemes; with s where
/// it is `full`. Nothing where lanes cannot run it: its rates are found by iteration, or a step takes too many
/// operations.
std::optional<TextTrace> trace_text(const Request& request, std::span<const double> parameters, std::size_t scheme,
                                    bool full);

}  // namespace least

// What a diagnostic is: a class that sees the states of a run and reports when the run is over, and a row of the table
// in table.cpp that says its card, what it sees, and on which scenes it means something. The catalogue, the decoder and
// the page follow.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/diagnostics/events.hpp"
#include "core/run/diagnostics/largest_error.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/outcome.hpp"
#include "core/run/problem_table.hpp"
#include "core/run/request.hpp"

namespace least {

/// What a diagnostic sees of a run before its end.
enum class Sees : std::uint8_t {
  nothing,
  every_step,
  sections,  ///< the changes of sign of the scene's sections, located
  states,    ///< some whole states along the run
};

/// What a run leaves to its diagnostics.
struct RunEnd {
  const RunBackend& backend;
  const Scene& scene;
  const Request& request;
  const SchemeCard& scheme;
  const RunState& x;                    ///< the final state
  const std::vector<RunState>& states;  ///< kept along the run, where a diagnostic sees states
  const Events& events;                 ///< found along the run, where a diagnostic sees sections
  TimeLeft left;
  std::vector<Warning>& warnings;  ///< what a report cannot say
  const ProblemTable& problem = backend.table();
};

class Diagnostic {
 public:
  virtual ~Diagnostic() = default;

  virtual void start(const ProblemTable&, StateView) {}
  /// The state after a step; and those after some steps.
  virtual void see(const ProblemTable&, StateView) {}
  virtual void see(const ProblemTable& problem, const StateRows& states) {
    for (std::size_t i = 0; i < states.count; ++i) see(problem, states[i]);
  }
  /// A state within a step, if it `looks` at those of the next one.
  virtual bool looks() const { return false; }
  virtual void look(const ProblemTable&, StateView) {}
  /// The run ends within the step whose inner states were looked at last: they are going to be looked at again.
  virtual void look_again() {}
  /// Asked once, when the run is over.
  virtual Report report(const RunEnd& end) = 0;
};

}  // namespace least

// A diagnostic is a class that sees the states of a run and reports when the run is over, with a row of the table in
// table.cpp: its card, what it sees, and the scenes to which it applies. The catalogue, the decoder and the page follow
// from that table.
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

/// Sees says what a diagnostic sees of a run before its end.
enum class Sees : std::uint8_t {
  nothing,
  every_step,
  sections,  ///< the located changes of sign of the scene's sections
  states,    ///< some states along the run
};

/// RunEnd is what a run leaves to its diagnostics.
struct RunEnd {
  const RunBackend& backend;
  const Scene& scene;
  const Request& request;
  const SchemeCard& scheme;
  const RunState& x;                    ///< the final state
  const std::vector<RunState>& states;  ///< states kept along the run, if a diagnostic sees states
  const Events& events;                 ///< events found along the run, if a diagnostic sees sections
  TimeLeft left;
  std::vector<Warning>& warnings;  ///< to be extended by diagnostics
  const ProblemTable& problem = backend.table();
};

class Diagnostic {
 public:
  virtual ~Diagnostic() = default;

  virtual void start(const ProblemTable&, StateView) {}
  /// Sees the state after a step, or the states after several steps.
  virtual void see(const ProblemTable&, StateView) {}
  virtual void see(const ProblemTable& problem, const StateRows& states) {
    for (std::size_t i = 0; i < states.count; ++i) see(problem, states[i]);
  }
  /// looks returns whether the diagnostic wants to look at states within the next step; look is called with each of
  /// them.
  virtual bool looks() const { return false; }
  virtual void look(const ProblemTable&, StateView) {}
  /// The run ends within the step whose inner states were looked at last: their look calls are void, and come again.
  virtual void look_again() {}
  /// Called once, when the run is over.
  virtual Report report(const RunEnd& end) = 0;
};

}  // namespace least

// The table of all diagnostics, with one row each in table.cpp, and the set of diagnostics of a run.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/run/diagnostics/diagnostic.hpp"
#include "core/run/diagnostics/watch.hpp"
#include "core/run/request.hpp"

namespace least {

class RunBackend;

/// diagnostic_cards returns the cards of the diagnostics that apply to a problem, in the order of the catalogue.
std::vector<DiagnosticCard> diagnostic_cards(const ProblemTraits& traits);

/// SignsSeen is what is known of signs up to the last state that was looked at. It can be copied, so that a block of
/// steps can be undone.
struct SignsSeen {
  Watch::Looks looks;
  SectionValues sections{};
  bool crossed = false, halted = false;
};

/// DiagnosticSet holds the diagnostics of a request; without any it costs nothing.
class DiagnosticSet {
 public:
  /// Between writes the state at a time within a step; false if it cannot.
  using Between = std::function<bool(double t, RunState& x)>;

  /// Makes the diagnostics of the request. The arguments have to outlive the set. `keep_going`: whether the run has
  /// time left.
  DiagnosticSet(const RunBackend& backend, const Request& request, const Watch& watch, const KeepGoing& keep_going);

  bool sees_steps() const { return sees(Sees::every_step) || watches(); }
  bool watches_sections() const { return sees(Sees::sections); }
  /// Whether sections or expressions of the caller are watched.
  bool watches() const { return watches_; }
  /// Whether states within a step are needed, other than for the expressions of the caller.
  bool looks_within() const { return watches_sections() || looks_; }
  bool keeps_states() const { return sees(Sees::states); }

  /// Whether a section, or an expression of the caller, may have vanished since this was last cleared.
  bool crossed() const { return signs_.crossed; }
  bool clear_crossed() { return std::exchange(signs_.crossed, false); }

  void start(StateView x);
  /// Sees the state after a step: its signs, then all the rest. If the run may end before that state, only its signs
  /// are seen: see `resume`.
  void see(StateView x);
  /// The same for the state x, with a search for zeros of the caller's expressions within the step from `left`.
  void see(const RunState& left, const RunState& x, int pieces, const Between& between);
  /// Sees only the signs of the states after a block of steps. For several states it does not matter in which of their
  /// steps something may have vanished.
  void see_signs(const StateRows& rows);
  /// Sees the rest of these states.
  void take(const StateRows& rows);
  const SignsSeen& signs() const { return signs_; }
  void restore(const SignsSeen& signs) { signs_ = signs; }

  /// Looks at a state within a step.
  void look(StateView x);
  /// To be called if the run ends within the step whose inner states were looked at: some of them are not part of the
  /// run.
  void look_again();
  /// If the last state was held back and the run goes on: sees that state.
  void resume(StateView x);
  /// Sees the state at which the run ends instead.
  void end(StateView x);
  /// Sees the state from which a run restarts.
  void begin_anew(StateView x);

  /// The reports, in the order of the request.
  std::vector<Report> reports(const RunEnd& end);

 private:
  void see_sign(StateView x, bool among_many);
  void see_sections(StateView x);
  void note(bool passed);
  void take(StateView x);
  bool sees(Sees what) const { return sees_[static_cast<std::size_t>(what)]; }

  const ProblemTable& problem_;
  std::vector<std::unique_ptr<Diagnostic>> wanted_;
  std::vector<Diagnostic*> seeing_;  ///< diagnostics that see every step
  std::array<bool, 4> sees_{};
  const Watch* watch_;  ///< null if the caller watches nothing
  bool watches_ = false, looks_ = false;
  SignsSeen signs_;
  StateNumbers observed_;  ///< arguments of the caller's expressions at the last state
};

}  // namespace least

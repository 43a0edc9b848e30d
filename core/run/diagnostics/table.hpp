// Every diagnostic, one row each in table.cpp, and the set of them that a run was asked for.
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

/// The cards of those that apply to a problem, in the order of the catalogue.
std::vector<DiagnosticCard> diagnostic_cards(const ProblemTraits& traits);

/// What is known of signs after the last state that was looked at. A value, so that a block of steps can be taken back.
struct SignsSeen {
  Watch::Looks looks;
  SectionValues sections{};
  bool crossed = false, halted = false;
};

/// What was asked for; costs nothing where nothing was.
class DiagnosticSet {
 public:
  /// Writes the state at a time within a step; false where it cannot.
  using Between = std::function<bool(double t, RunState& x)>;

  /// Those of the request. All outlive the set. `keep_going`: whether the run has time left.
  DiagnosticSet(const RunBackend& backend, const Request& request, const Watch& watch, const KeepGoing& keep_going);

  bool sees_steps() const { return sees(Sees::every_step) || watches(); }
  bool watches_sections() const { return sees(Sees::sections); }
  /// Sections, or what the caller asked for.
  bool watches() const { return watches_; }
  /// Whether states within a step are of interest, beside what the caller watches.
  bool looks_within() const { return watches_sections() || looks_; }
  bool keeps_states() const { return sees(Sees::states); }

  /// A section, or what the caller watches, may have vanished since this was last cleared.
  bool crossed() const { return signs_.crossed; }
  bool clear_crossed() { return std::exchange(signs_.crossed, false); }

  void start(StateView x);
  /// The state after a step: its signs, and then the rest. Nothing but signs is seen of a state before which the run
  /// may end: see `resume`.
  void see(StateView x);
  /// The same of the state x, where what the caller watches is looked for within the step from `left`.
  void see(const RunState& left, const RunState& x, int pieces, const Between& between);
  /// Of the states after a block of steps the signs alone. Of many nobody asks in which of their steps something may
  /// have vanished.
  void see_signs(const StateRows& rows);
  /// And then the rest.
  void take(const StateRows& rows);
  const SignsSeen& signs() const { return signs_; }
  void restore(const SignsSeen& signs) { signs_ = signs; }

  /// A state within a step.
  void look(StateView x);
  /// Of the step in which the run ends: not all of what was looked at is part of it.
  void look_again();
  /// Where the last state was kept back, and the run goes on: that state.
  void resume(StateView x);
  /// The state at which the run ends instead.
  void end(StateView x);
  /// The state from which the run goes on, wherever it has been before.
  void begin_anew(StateView x);

  /// In the order of the request.
  std::vector<Report> reports(const RunEnd& end);

 private:
  void see_sign(StateView x, bool among_many);
  void see_sections(StateView x);
  void note(bool passed);
  void take(StateView x);
  bool sees(Sees what) const { return sees_[static_cast<std::size_t>(what)]; }

  const ProblemTable& problem_;
  std::vector<std::unique_ptr<Diagnostic>> wanted_;
  std::vector<Diagnostic*> seeing_;  ///< those that see every step
  std::array<bool, 4> sees_{};
  const Watch* watch_;  ///< null: nothing of the caller's own
  bool watches_ = false, looks_ = false;
  SignsSeen signs_;
  StateNumbers observed_;  ///< of the last state, by the caller's own
};

}  // namespace least

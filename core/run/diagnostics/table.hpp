// Every diagnostic, one row each, and the set of them that a run was asked for.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "core/run/diagnostics/conserved.hpp"
#include "core/run/diagnostics/decay.hpp"
#include "core/run/diagnostics/error.hpp"
#include "core/run/diagnostics/flows.hpp"
#include "core/run/diagnostics/lyapunov.hpp"
#include "core/run/diagnostics/orbit.hpp"
#include "core/run/diagnostics/sections.hpp"
#include "core/run/diagnostics/states.hpp"
#include "core/run/diagnostics/watch.hpp"
#include "core/run/request.hpp"

namespace least {

/// In the order of the catalogue.
using DiagnosticTable = std::tuple<EnergyRow, MomentaRow, StructureRow, ErrorRow, OrbitRow, DecayRow, VolumeRow,
                                   EntropyRow, ZerosRow, CycleRow, PolesRow, MomentsRow, LyapunovRow>;

namespace detail {
template <class P, class Row>
using IfApplies = std::conditional_t<Row::template applies<P>, std::tuple<Row>, std::tuple<>>;
template <class P, class... Row>
auto rows_of(std::tuple<Row...>*) -> decltype(std::tuple_cat(IfApplies<P, Row>{}...));
}  // namespace detail

/// Those that apply to a problem.
template <class P>
using DiagnosticRows = decltype(detail::rows_of<P>(static_cast<DiagnosticTable*>(nullptr)));

template <class P>
std::vector<DiagnosticCard> diagnostic_cards() {
  return std::apply([](auto... row) { return std::vector<DiagnosticCard>{decltype(row)::info...}; },
                    DiagnosticRows<P>{});
}

/// What was asked for; costs nothing where nothing was. A value, so that a block of steps can be taken back.
template <class P, class X>
class DiagnosticSet {
 public:
  bool crossed = false;  ///< a section, or what the caller watches, may have vanished since this was last cleared

  /// `asked`: positions among the problem's cards. `watch` outlives the set.
  DiagnosticSet(const std::vector<std::size_t>& asked, const Watch& watch) : watch_(watch.empty() ? nullptr : &watch) {
    for (const std::size_t index : asked) wanted_.at(index) = true;
    for_each([&]<class Row>(Row, auto& seen) {
      sees_[static_cast<std::size_t>(Row::sees)] = true;
      if constexpr (requires(const P& problem, const X& x) { seen.look(problem, x); }) turns_ = true;
    });
    watches_ = watch_ || watches_sections();
  }

  bool sees_steps() const { return sees(Sees::every_step) || watches(); }
  bool watches_sections() const { return sees(Sees::sections); }
  /// Sections, or what the caller asked for.
  bool watches() const { return watches_; }
  bool watches_events() const { return watch_ != nullptr; }
  /// Whether states within a step are of interest, beside what the caller watches.
  bool looks_within() const { return watches_sections() || turns_; }
  bool keeps_states() const { return sees(Sees::states); }

  /// `tangents`: of steps of the scheme; they outlive the set.
  void start(const P& problem, const X& x, const StepTangents<P>& tangents) {
    for_each([&](auto, auto& seen) {
      if constexpr (requires { seen.start(problem, x); }) seen.start(problem, x);
      if constexpr (requires { seen.start(problem, x, tangents); }) seen.start(problem, x, tangents);
    });
    before_ = sections(problem, x);
    if (watch_) watch_->look(looks_, observe(problem, x, watch_->measures()).data(), x.t);
  }
  /// Before states of which nobody asks in which of their steps something may have vanished, and after them.
  void begin_block() { among_many_ = true; }
  void end_block() {
    among_many_ = false;
    if (watch_) crossed = watch_->settle(looks_) || crossed;
  }
  /// Nothing but signs is seen of a state before which the run may end: see `resume`.
  void see(const P& problem, const X& x) {
    if (watches_) see_signs(problem, x);
    if (!halted_) take(problem, x);
  }
  /// The same of the state x, where what the caller watches is looked for within the step from `left`: `between` writes
  /// the state at a time, false where it cannot.
  template <class Between>
  void see(const P& problem, const X& left, const X& x, int pieces, Between&& between) {
    if (watches_sections()) see_sections(problem, x);
    if (watch_) {
      const Measures& measures = watch_->measures();
      const auto observe_at = [&](double t, double* observed) {
        X y = x;
        if (!between(t, y)) return false;
        std::copy_n(observe(problem, y, measures).begin(), measures.reads.size(), observed);
        return true;
      };
      note(watch_->may_vanish(observe(problem, left, measures).data(), left.t, observe(problem, x, measures).data(),
                              x.t, observe_at, pieces));
    }
    if (!halted_) take(problem, x);
  }
  /// A state within a step.
  void look(const P& problem, const X& x) {
    if (watches_sections()) see_sections(problem, x);
    for_each([&](auto, auto& seen) {
      if constexpr (requires { seen.look(problem, x); }) seen.look(problem, x);
    });
  }
  /// Of the step in which the run ends: not all of what was looked at is part of it.
  void look_again() {
    for_each([](auto, auto& seen) {
      if constexpr (requires { seen.look_again(); }) seen.look_again();
    });
  }
  /// Where the last state was kept back, and the run goes on: that state.
  void resume(const P& problem, const X& x) {
    if (std::exchange(halted_, false)) take(problem, x);
  }
  /// The state at which the run ends instead.
  void end(const P& problem, const X& x) { take(problem, x); }

  /// In the order of `asked`.
  std::vector<Report> reports(const std::vector<std::size_t>& asked, const RunEnd<P, X>& end) {
    std::vector<Report> all;
    for (const std::size_t index : asked) {
      std::size_t row = 0;
      visit([&](auto, auto& seen) {
        if (row++ == index) all.push_back(seen.report(end));
      });
    }
    return all;
  }

 private:
  using Rows = DiagnosticRows<P>;
  static constexpr std::size_t count = std::tuple_size_v<Rows>;

  /// A lean state says less than a diagnostic may need: then a run that asks for it carries a full one.
  template <class Row>
  static constexpr bool says = !Row::info.full_state || std::is_same_v<X, FullRunState<P>>;
  struct Nothing {
    Report report(const RunEnd<P, X>&) const { return {}; }
  };
  template <class Row>
  static auto seen_by(Row) {
    if constexpr (says<Row>) {
      return typename Row::template Seen<P, X>{};
    } else {
      return Nothing{};
    }
  }
  using Values = decltype(std::apply([](auto... row) { return std::tuple<decltype(seen_by(row))...>{}; }, Rows{}));

  /// Whether something may have vanished since the last state that was looked at.
  void see_signs(const P& problem, const X& x) {
    if (watches_sections()) see_sections(problem, x);
    if (!watch_) return;
    const auto observed = observe(problem, x, watch_->measures());
    note(among_many_ ? watch_->collect(looks_, observed.data(), x.t) : watch_->look(looks_, observed.data(), x.t) != 0);
  }
  void see_sections(const P& problem, const X& x) {
    const auto now = sections(problem, x);
    for (std::size_t i = 0; i < now.size(); ++i) crossed = crossed || (now[i] < 0) != (before_[i] < 0);
    before_ = now;
  }
  /// Of what the caller watches whether something may have vanished.
  void note(bool passed) {
    crossed = crossed || passed;
    halted_ = halted_ || (passed && watch_->may_end());
  }
  void take(const P& problem, const X& x) {
    for_each([&](auto, auto& seen) {
      if constexpr (requires { seen.see(problem, x); }) seen.see(problem, x);
    });
  }
  bool sees(Sees what) const { return sees_[static_cast<std::size_t>(what)]; }

  template <class F>
  void visit(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (f(std::tuple_element_t<I, Rows>{}, std::get<I>(values_)), ...);
    }
    (std::make_index_sequence<count>{});
  }
  /// Those that are wanted.
  template <class F>
  void for_each(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((wanted_[I] ? f(std::tuple_element_t<I, Rows>{}, std::get<I>(values_)) : void()), ...);
    }
    (std::make_index_sequence<count>{});
  }

  std::array<bool, count> wanted_{};
  std::array<bool, 4> sees_{};
  Values values_;
  const Watch* watch_;  ///< null: nothing of the caller's own
  Watch::Looks looks_;
  bool watches_ = false, turns_ = false, halted_ = false, among_many_ = false;
  decltype(sections(std::declval<const P&>(), std::declval<const X&>())) before_{};
};

}  // namespace least

// Every diagnostic, one row each, and the set of them that a run was asked for.
#pragma once

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
  bool crossed = false;  ///< a section, or what the caller watches, changed its sign since this was last cleared

  /// `asked`: positions among the problem's cards. `watch` outlives the set.
  DiagnosticSet(const std::vector<std::size_t>& asked, const Watch& watch) : watch_(watch.empty() ? nullptr : &watch) {
    for (const std::size_t index : asked) wanted_.at(index) = true;
    for_each([&]<class Row>(Row, auto&) { sees_[static_cast<std::size_t>(Row::sees)] = true; });
    watches_ = watch_ || watches_sections();
  }

  bool sees_steps() const { return sees(Sees::every_step) || watches(); }
  bool watches_sections() const { return sees(Sees::sections); }
  /// Sections, or what the caller asked for.
  bool watches() const { return watches_; }
  bool watches_events() const { return watch_ != nullptr; }
  bool keeps_states() const { return sees(Sees::states); }

  /// `tangents`: of steps of the scheme; they outlive the set.
  void start(const P& problem, const X& x, const StepTangents<P>& tangents) {
    for_each([&](auto, auto& seen) {
      if constexpr (requires { seen.start(problem, x); }) seen.start(problem, x);
      if constexpr (requires { seen.start(problem, x, tangents); }) seen.start(problem, x, tangents);
    });
    before_ = sections(problem, x);
    if (watch_) signs_ = signs(problem, x);
  }
  /// Nothing but signs is seen of a state before which the run may end: see `resume`.
  void see(const P& problem, const X& x) {
    if (watches_) see_signs(problem, x);
    if (!halted_) take(problem, x);
  }
  /// Whether something changed its sign, of a state at the end of a step or within one.
  void see_signs(const P& problem, const X& x) {
    if (watches_sections()) {
      const auto now = sections(problem, x);
      for (std::size_t i = 0; i < now.size(); ++i) crossed = crossed || (now[i] < 0) != (before_[i] < 0);
      before_ = now;
    }
    if (!watch_) return;
    const Watch::Signs now = signs(problem, x);
    crossed = crossed || watch_->crossed(signs_, now);
    halted_ = halted_ || watch_->halts(signs_, now);
    signs_ = now;
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

  void take(const P& problem, const X& x) {
    for_each([&](auto, auto& seen) {
      if constexpr (requires { seen.see(problem, x); }) seen.see(problem, x);
    });
  }
  Watch::Signs signs(const P& problem, const X& x) const {
    return watch_->signs(observe(problem, x, watch_->measures()).data(), x.t);
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
  Watch::Signs signs_ = 0;
  bool watches_ = false, halted_ = false;
  decltype(sections(std::declval<const P&>(), std::declval<const X&>())) before_{};
};

}  // namespace least

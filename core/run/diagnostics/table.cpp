#include "core/run/diagnostics/table.hpp"

#include <algorithm>

#include "core/run/backend.hpp"
#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

/// Row is a diagnostic: its card, what it sees of a run, the problems to which it applies, and the function that makes
/// it.
struct Row {
  DiagnosticCard info;
  Sees sees;
  bool (*applies)(const ProblemTraits& traits);
  std::unique_ptr<Diagnostic> (*make)(const RunBackend& backend, const Request& request, const KeepGoing& keep_going);
};
/// In the order of the catalogue.
std::span<const Row> all_rows() {
  static const Row rows[] = {
      {{"energy", "extremes and drift of the energy", true, true},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.has_energy; },
       energy_diagnostic},
      {{"momenta", "extremes of what else the motion keeps"},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.potential || p.general || p.invariants > 0; },
       momenta_diagnostic},
      {{"structure", "defect of the symplectic or the contact form over steps of the run"},
       Sees::states,
       [](const ProblemTraits& p) { return p.potential || p.general; },
       structure_diagnostic},
      {{"error", "against the closed form or a quad-precision run"},
       Sees::every_step,
       [](const ProblemTraits&) { return true; },
       error_diagnostic},
      {{"orbit", "closure, apsidal rotation and osculating elements of an orbit"},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.elements > 0; },
       orbit_diagnostic},
      {{"decay", "residual of Ḣ = −H H_s + H_t along the run", false, true},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.contact; },
       decay_diagnostic},
      {{"volume", "defect of the contact volume over steps of the run", false, true},
       Sees::states,
       [](const ProblemTraits& p) { return p.contact; },
       volume_diagnostic},
      {{"entropy", "whether the entropy ever fell"},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.has_entropy; },
       entropy_diagnostic},
      {{"zeros", "times at which the section vanishes"},
       Sees::sections,
       [](const ProblemTraits& p) { return p.has_section; },
       zeros_diagnostic},
      {{"cycle", "period and amplitude of the last whole cycle"},
       Sees::sections,
       [](const ProblemTraits& p) { return p.oscillates; },
       cycle_diagnostic},
      {{"poles", "times at which the slope has a pole", false, true},
       Sees::sections,
       [](const ProblemTraits& p) { return p.carries_slope; },
       poles_diagnostic},
      {{"moments", "averages over time along the orbit"},
       Sees::every_step,
       [](const ProblemTraits& p) { return p.moments > 0; },
       moments_diagnostic},
      {{"lyapunov", "largest Lyapunov exponent of the run and its MEGNO"},
       Sees::every_step,
       [](const ProblemTraits&) { return true; },
       lyapunov_diagnostic},
  };
  return rows;
}

template <class F>
void for_each_row(const ProblemTraits& traits, F&& f) {
  for (const Row& row : all_rows())
    if (row.applies(traits)) f(row);
}

}  // namespace

std::vector<DiagnosticCard> diagnostic_cards(const ProblemTraits& traits) {
  std::vector<DiagnosticCard> cards;
  for_each_row(traits, [&](const Row& row) { cards.push_back(row.info); });
  return cards;
}

DiagnosticSet::DiagnosticSet(const RunBackend& backend, const Request& request, const Watch& watch,
                             const KeepGoing& keep_going)
    : problem_(backend.table()), watch_(watch.empty() ? nullptr : &watch) {
  watches_ = watch_ != nullptr;
  if (request.diagnostics.empty()) return;
  std::vector<const Row*> rows;
  for_each_row(problem_.traits, [&](const Row& row) { rows.push_back(&row); });
  for (const std::size_t index : request.diagnostics) {
    const Row& row = *rows.at(index);
    wanted_.push_back(row.make(backend, request, keep_going));
    sees_[static_cast<std::size_t>(row.sees)] = true;
    if (row.sees == Sees::every_step) seeing_.push_back(wanted_.back().get());
    looks_ = looks_ || wanted_.back()->looks();
  }
  watches_ = watches_ || watches_sections();
}

void DiagnosticSet::start(StateView x) {
  for (Diagnostic* const one : seeing_) one->start(problem_, x);
  problem_.sections(x, signs_.sections.data());
  if (!watch_) return;
  observed_ = observe(problem_, x, watch_->measures());
  watch_->look(signs_.looks, observed_.data(), x.t);
}

void DiagnosticSet::see(StateView x) {
  if (watches_) see_sign(x, false);
  if (!signs_.halted) take(x);
}

void DiagnosticSet::see(const RunState& left, const RunState& x, int pieces, const Between& between) {
  if (watches_sections()) see_sections(x);
  if (watch_) {
    const Measures& measures = watch_->measures();
    RunState y = x;
    const auto observe_at = [&](double t, double* observed) {
      if (!between(t, y)) return false;
      std::ranges::copy(observe(problem_, y, measures), observed);
      return true;
    };
    note(watch_->may_vanish(observe(problem_, left, measures).data(), left.t, observe(problem_, x, measures).data(),
                            x.t, std::ref(observe_at), pieces));
  }
  if (!signs_.halted) take(x);
}

void DiagnosticSet::see_signs(const StateRows& rows) {
  if (!watches_) return;
  const bool many = rows.count > 1;
  for (std::size_t i = 0; i < rows.count; ++i) see_sign(rows[i], many);
  if (many && watch_) signs_.crossed = watch_->settle(signs_.looks) || signs_.crossed;
}

void DiagnosticSet::take(const StateRows& rows) {
  if (signs_.halted) return;
  for (Diagnostic* const one : seeing_) one->see(problem_, rows);
}

void DiagnosticSet::look(StateView x) {
  if (watches_sections()) see_sections(x);
  if (looks_)
    for (Diagnostic* const one : seeing_) one->look(problem_, x);
}
void DiagnosticSet::look_again() {
  for (Diagnostic* const one : seeing_) one->look_again();
}
void DiagnosticSet::resume(StateView x) {
  if (std::exchange(signs_.halted, false)) take(x);
}
void DiagnosticSet::end(StateView x) { take(x); }
void DiagnosticSet::begin_anew(StateView x) {
  signs_ = {};
  problem_.sections(x, signs_.sections.data());
  take(x);
  if (!watch_) return;
  observe(problem_, x, watch_->measures(), observed_.data());
  watch_->look(signs_.looks, observed_.data(), x.t);
}

std::vector<Report> DiagnosticSet::reports(const RunEnd& end) {
  std::vector<Report> all;
  all.reserve(wanted_.size());
  for (const auto& one : wanted_) all.push_back(one->report(end));
  return all;
}

/// Notes whether something may have vanished since the last state that was looked at.
void DiagnosticSet::see_sign(StateView x, bool among_many) {
  if (watches_sections()) see_sections(x);
  if (!watch_) return;
  observe(problem_, x, watch_->measures(), observed_.data());
  note(among_many ? watch_->collect(signs_.looks, observed_.data(), x.t)
                  : watch_->look(signs_.looks, observed_.data(), x.t) != 0);
}
void DiagnosticSet::see_sections(StateView x) {
  SectionValues now{};
  problem_.sections(x, now.data());
  for (std::size_t i = 0; i < problem_.traits.sections; ++i)
    signs_.crossed = signs_.crossed || (now[i] < 0) != (signs_.sections[i] < 0);
  signs_.sections = now;
}
/// Notes whether something that the caller watches may have vanished.
void DiagnosticSet::note(bool passed) {
  signs_.crossed = signs_.crossed || passed;
  signs_.halted = signs_.halted || (passed && watch_->may_end());
}
void DiagnosticSet::take(StateView x) {
  looks_ = false;
  for (Diagnostic* const one : seeing_) {
    one->see(problem_, x);
    looks_ = looks_ || one->looks();
  }
}

}  // namespace least

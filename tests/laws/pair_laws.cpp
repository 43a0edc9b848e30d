// Laws of every pair of problem and scheme in the catalogue, through runs: the schemes that say so keep the form, no
// other does, and no step allocates.
#include <gtest/gtest.h>

#include <cmath>

#include "core/study/study.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

const SchemeCard& scheme_of(const Request& request) { return schemes()[request.scheme]; }

std::string label(const Request& request) {
  std::string text = std::string(runs::card(request).id) + ' ' + std::string(scheme_of(request).id);
  for (const double x : request.settings) text += ' ' + std::to_string(x);
  return text;
}

/// for_each_pair() calls f(request) for every scheme that fits the problem, with every composition, each with every
/// splitting, and every number of stages; the hybrid on the coordinate side of its switch, with each quadrature and
/// order.
template <class F>
void for_each_pair(std::size_t problem, F&& f) {
  for (const std::size_t index : runs::problem_cards()[problem].schemes) {
    const SchemeCard& scheme = schemes()[index];
    std::vector<Request> all{runs::defaults(runs::problem_cards()[problem].id, scheme.id)};
    if (scheme.id == "jacobi_maupertuis") runs::set(all[0], "critical_kinetic_energy", 0.0);
    for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
      const ParameterCard& card = scheme.parameters[i];
      const bool varied = card.name == "composition" || card.name == "splitting" || card.name == "stages" ||
                          card.name == "quadrature" || card.name == "order" || card.name == "monitor";
      if (!varied) continue;
      std::vector<Request> more;
      for (const Request& request : all)
        for (double x = card.choices.empty() ? card.range.low : 0;
             x <= (card.choices.empty() ? card.range.high : static_cast<double>(card.choices.size()) - 1); ++x) {
          more.push_back(request);
          more.back().settings[i] = x;
          if (scheme.conflicts && !scheme.conflicts(more.back().settings, runs::problem_cards()[problem]).empty())
            more.pop_back();
        }
      all = std::move(more);
    }
    for (const Request& request : all) f(request);
  }
}

class Pairs : public testing::TestWithParam<std::size_t> {};

/// MᵀJM = J, or φ*η = λη in a contact scene, for single steps from four points of the default orbit.
TEST_P(Pairs, KeepTheFormThatTheySay) {
  const ProblemCard& problem = runs::problem_cards()[GetParam()];
  if (!problem.keeps_form) return;
  const Request scene = runs::defaults(problem.id, schemes()[problem.schemes[0]].id);
  std::vector<double> times;
  for (const double part : {0.15, 0.25, 0.35, 0.45}) times.push_back(part * problem.span);
  const auto orbit = truth(*scene.scene, times, [] { return true; });
  ASSERT_TRUE(orbit->complete);
  for_each_pair(GetParam(), [&](Request request) {
    runs::ask(request, "structure");
    runs::only_final(request);
    const SchemeCard& scheme = scheme_of(request);
    const bool fixed = !scheme.own_clock, keeps = scheme.structure != "none" && scheme.structure != "volume";
    if (!keeps && fixed)  // so that the defect of such a scheme is seen
      request.settings[0] = std::max(10 * request.settings[0], problem.span / 1000);
    request.until_steps = true;
    request.steps = 1;
    double most = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      runs::scene(request).start = times[k];
      std::ranges::copy(orbit->states[k], runs::scene(request).initial.begin());
      const Solution outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << label(request) << outcome.stop.detail;
      double size = 1;
      for (const double x : orbit->states[k]) size = std::max(size, std::abs(x));
      const double defect = runs::number(outcome.diagnostics, "structure/max_defect");
      if (keeps || fixed) {
        ASSERT_TRUE(std::isfinite(defect)) << label(request) << ": the form it claims could not be measured";
      }
      most = std::fmax(most, defect / size);
    }
    if (keeps) {
      EXPECT_LT(most, 1e-12) << label(request);
    } else if (fixed) {  // schemes that choose their own steps may keep it at times, or have no derivative
      EXPECT_GT(most, 1e-11) << label(request) << " keeps the form but does not say so";
    }
  });
}

/// A run of many steps allocates as often as one of few, with every diagnostic that looks at each step. Odeint's three
/// schemes are left out: they stand behind a pointer, and one of them allocates as it goes.
TEST_P(Pairs, AllocateNothingInTheLoop) {
  for_each_pair(GetParam(), [&](Request request) {
    const bool taylor = scheme_of(request).id == "taylor";
    if (scheme_of(request).parameters[0].name == "tolerance" && !taylor) return;
    for (const auto* diagnostic : {"energy", "momenta", "orbit", "decay", "entropy", "moments"}) {
      const auto& names = runs::card(request).diagnostics;
      if (std::ranges::find(names, diagnostic, &DiagnosticCard::name) != names.end()) runs::ask(request, diagnostic);
    }
    runs::only_final(request);
    request.columns.clear();
    request.until_steps = true;
    std::size_t said = 0;
    const auto allocations = [&](std::int64_t steps) {
      request.steps = steps;
      const std::size_t before = counting::allocations();
      const Solution outcome = runs::go(request).outcome;
      const std::size_t after = counting::allocations();
      EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << label(request) << outcome.stop.detail;
      said = outcome.events.size() + outcome.warnings.size();
      return after - before;
    };
    allocations(4);  // the first run fills what is kept from run to run
    const std::size_t few = allocations(4), many = allocations(taylor ? 8 : 54);  // series soon reach a star's end
    // Each event adds to a list and each warning is a text; so is the name of what the energy's largest error is
    // relative to.
    EXPECT_LE(many, few + 8 * said + 1) << label(request);
  });
}

INSTANTIATE_TEST_SUITE_P(All, Pairs, testing::Range<std::size_t>(0, runs::problem_cards().size()),
                         [](const auto& which) { return std::string(runs::problem_cards()[which.param].id); });

}  // namespace

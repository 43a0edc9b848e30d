// Scenes typed as text against the compiled problems of the catalogue: the same motion by the same schemes.
#include <gtest/gtest.h>

#include <set>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

std::string ids(const std::vector<std::size_t>& schemes) {
  std::string all;
  for (const auto index : schemes) all += least::schemes()[index].id + " ";
  return all;
}

/// of_text() returns the variables of the text from a state, in the order of the card.
std::vector<double> of_text(const ProblemCard& card, const std::vector<double>& state) {
  std::vector<double> shown;
  for (std::size_t i = 0; i < card.variables.size(); ++i)
    if (!card.variables[i].hidden) shown.push_back(state[i]);
  return shown;
}

class AsCompiled : public testing::TestWithParam<Typed> {};

TEST_P(AsCompiled, HasTheSameSchemes) {
  const auto mechanics = mechanics_of(GetParam().definition);
  auto compiled = runs::problem_card(GetParam().id).schemes;
  if (GetParam().definition.kind == Definition::Kind::equations)  // no text says that a flow is a sum of exact flows
    std::erase_if(compiled, [&](std::size_t i) {
      return std::ranges::find(mechanics->card().schemes, i) == mechanics->card().schemes.end();
    });
  auto own = mechanics->card().schemes;
  for (const char* id :
       {"kepler_splitting", "boris", "adaptive_boris", "harmonic_splitting"})  // they are found in texts alone
    std::erase(own, find_scheme(id).value());
  EXPECT_EQ(ids(own), ids(compiled));
}

TEST_P(AsCompiled, LeadsToTheSameStates) {
  const auto mechanics = mechanics_of(GetParam().definition);
  int compared = 0;
  for (const auto index : mechanics->card().schemes) {
    const std::string& id = schemes()[index].id;
    if (!runs::fits(GetParam().id, id)) continue;
    Request compiled = runs::defaults(GetParam().id, id);
    compiled.end = compiled.scene->start + std::min(5.0, compiled.end - compiled.scene->start);
    runs::only_final(compiled);
    // There is no estimate of the local frequency; both have the other monitor.
    if (id == "adaptive_verlet") runs::set(compiled, "monitor", "arclength");
    const Request typed = typed_as(compiled, mechanics);
    const auto a = runs::go(compiled).outcome, b = runs::go(typed).outcome;
    ASSERT_EQ(a.stop.reason, b.stop.reason) << id << " " << b.stop.detail;
    const bool own_clock = schemes()[index].own_clock;
    if (!own_clock) {
      EXPECT_EQ(a.cost.steps, b.cost.steps) << id;
    }
    const auto state = of_text(mechanics->card(), b.final);
    double size = 1;
    for (const double x : a.final)
      if (std::isfinite(x)) size = std::max(size, std::abs(x));
    // Schemes that choose their own steps choose others when rounding differs: they agree to their tolerance.
    const double close = own_clock ? 1e-10 : 1e-12;
    for (std::size_t i = 0; i < state.size(); ++i) {
      if (std::isnan(a.final[i]) && std::isnan(state[i])) continue;
      EXPECT_NEAR(state[i], a.final[i], close * size) << id << " variable " << i;
    }
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

/// tangents_in() returns the diagnostics that are computed from tangents of steps, as far as the problem has them.
std::vector<double> tangents_in(Request request) {
  std::vector<std::string> asked;
  for (const char* path : {"structure/max_defect", "structure/factor", "lyapunov/exponent", "lyapunov/megno"}) {
    const std::string name(path, std::string_view(path).find('/'));
    if (std::ranges::count(runs::card(request).diagnostics, name, &DiagnosticCard::name) == 0) continue;
    if (asked.empty() || !asked.back().starts_with(name)) runs::ask(request, name);
    asked.emplace_back(path);
  }
  const auto reports = runs::go(request).outcome.diagnostics;
  std::vector<double> all;
  for (const std::string& path : asked) all.push_back(runs::number(reports, path));
  return all;
}
TEST_P(AsCompiled, HasTheSameTangents) {
  const auto mechanics = mechanics_of(GetParam().definition);
  for (const auto index : mechanics->card().schemes) {
    const std::string& id = schemes()[index].id;
    if (!runs::fits(GetParam().id, id)) continue;
    Request compiled = runs::defaults(GetParam().id, id);
    compiled.end = compiled.scene->start + std::min(2.0, compiled.end - compiled.scene->start);
    if (id == "adaptive_verlet") runs::set(compiled, "monitor", "arclength");
    Request typed = typed_as(compiled, mechanics);
    compiled.diagnostics.clear();
    const auto known = tangents_in(compiled), found = tangents_in(typed);
    ASSERT_EQ(known.size(), found.size()) << id;
    const bool keeps = schemes()[index].structure != "none" && known.size() == 4;
    if (keeps) {
      EXPECT_LT(found[0], 1e-12) << id;
    }
    // A scheme without tangents uses those of the true motion, which follows another path.
    const bool own_clock = schemes()[index].own_clock, of_motion = own_clock && schemes()[index].structure == "none";
    const double close = of_motion ? 1e-2 : own_clock ? 1e-4 : 1e-6;
    for (std::size_t i = keeps ? 1 : 0; i < known.size(); ++i) {
      ASSERT_EQ(std::isnan(known[i]), std::isnan(found[i])) << id << " " << i;
      if (!std::isnan(known[i])) {
        EXPECT_NEAR(found[i], known[i], close * std::abs(known[i]) + 1e-10) << id << " " << i;
      }
    }
  }
}

// The state of a run as text has room for variables that the scene does not have: they must not contribute.
TEST(AsCompiledTangents, GrowAsThoseOfTheCompiledProblem) {
  const std::set<std::string_view> some{"kepler", "kepler_3d", "pendulum", "damped_oscillator", "van_der_pol"};
  for (const Typed& typed : all()) {
    const std::string_view id = typed.id;
    if (!some.contains(id)) continue;
    const auto mechanics = mechanics_of(typed.definition);
    Request compiled = runs::defaults(id, runs::fits(id, "leapfrog") ? "leapfrog" : "runge_kutta_4");
    compiled.end = compiled.scene->start + 10;
    runs::only_final(compiled);
    Request text = typed_as(compiled, mechanics);
    runs::ask(compiled, "lyapunov");
    runs::ask(text, "lyapunov");
    const auto a = runs::go(compiled).outcome.diagnostics, b = runs::go(text).outcome.diagnostics;
    for (const char* part : {"lyapunov/exponent", "lyapunov/megno"})
      EXPECT_NEAR(runs::number(a, part), runs::number(b, part), 1e-9) << name_of(typed) << " " << part;
    const auto growth_of = [&](const Request& request) {
      return request.scene->mechanics->conditioning(*request.scene, request.end, [] { return true; }).most_growth;
    };
    EXPECT_NEAR(growth_of(text) / growth_of(compiled), 1, 1e-6) << name_of(typed);
  }
}

INSTANTIATE_TEST_SUITE_P(Text, AsCompiled, testing::ValuesIn(all()), [](const auto& of) { return name_of(of.param); });

}  // namespace

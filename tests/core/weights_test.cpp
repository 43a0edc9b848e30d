// Compositions with weights of the caller's own: which are refused, which order they have, and that the weights of a
// named composition give that composition, to the bit, in every scheme that takes one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/composition.hpp"
#include "core/run/stability.hpp"
#include "core/study/error_study.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

std::vector<double> weights_named(Composition::Name name) {
  const auto& weights = Weights<double>::of(name);
  return {weights.gamma.begin(), weights.gamma.begin() + weights.stages};
}

TEST(OwnWeights, HaveTheOrderOfTheNamedOnes) {
  for (std::size_t c = 0; c < compositions::names.size(); ++c) {
    auto weights = weights_named(static_cast<Composition::Name>(c));
    EXPECT_EQ(compositions::objection(weights), "") << compositions::names[c];
    EXPECT_EQ(compositions::order_of(weights), compositions::orders[c]) << compositions::names[c];
    for (double& weight : weights) weight = std::round(weight * 1e15) * 1e-15;  // as in print
    EXPECT_EQ(compositions::order_of(weights), compositions::orders[c]) << compositions::names[c];
    if (weights.size() == 1) continue;
    weights.front() += 1e-9;
    weights.back() += 1e-9;
    weights[weights.size() / 2] -= 2e-9;
    EXPECT_LT(compositions::order_of(weights), compositions::orders[c]) << compositions::names[c] << " spoilt";
  }
  EXPECT_EQ(compositions::order_of(std::vector<double>{0.5, 0.5}), 2);
  EXPECT_EQ(compositions::order_of(std::vector<double>{0.5, -0.1, 0.2, -0.1, 0.5}), 2);
  // Σγ⁵ = 0 but Σγ³ ≠ 0: this takes a scheme of order 4 to order 6, but does not help one of order 2.
  const double outer = 1 / (2 - std::pow(2, 0.2));
  const std::vector<double> of_order_four{outer, 1 - 2 * outer, outer};
  EXPECT_EQ(compositions::order_of(of_order_four), 2);
  EXPECT_EQ(compositions::order_of(of_order_four, 4), 6);
  EXPECT_EQ(compositions::order_of(std::vector<double>{0.5, 0.5}, 4), 4);
}

TEST(OwnWeights, AreRefusedByName) {
  const auto objection = [](const std::vector<double>& weights) { return compositions::objection(weights); };
  EXPECT_EQ(objection({0.5, 0.5}), "");
  EXPECT_EQ(objection(std::vector<double>(35, 1.0 / 35)), "");
  EXPECT_NE(objection({}).find("1 to 35"), std::string::npos);
  EXPECT_NE(objection(std::vector<double>(36, 1.0 / 36)).find("not 36"), std::string::npos);
  EXPECT_NE(objection({0.6, 0.4}).find("symmetric"), std::string::npos);
  EXPECT_NE(objection({0.3, 0.4 + 4e-15, 0.3}).find("add up"), std::string::npos);
  EXPECT_EQ(objection({0.3, 0.4 + 2e-15, 0.3}), "");
  EXPECT_NE(objection({101, -201, 101}).find("beyond"), std::string::npos);
  EXPECT_NE(objection({std::numeric_limits<double>::quiet_NaN()}).find("beyond"), std::string::npos);
}

/// spelt_out() replaces a named composition in the settings by its weights.
std::vector<double> spelt_out(const SchemeCard& scheme, std::vector<double> settings) {
  const std::size_t i = *scheme.find("composition");
  const auto weights = weights_named(static_cast<Composition::Name>(settings[i]));
  settings[i] = static_cast<double>(compositions::names.size());
  settings.insert(settings.end(), weights.begin(), weights.end());
  return settings;
}

TEST(OwnWeights, OfANamedCompositionAreThatOne) {
  std::set<std::string> schemes_seen;
  for (const auto& problem : runs::problem_cards())
    for (const std::size_t index : problem.schemes) {
      const SchemeCard& scheme = schemes()[index];
      if (!scheme.find("composition")) continue;
      schemes_seen.insert(scheme.id);
      for (const char* name : {"kahan_li_6", "sofroniou_spaletta_10"}) {
        Request named = runs::defaults(problem.id, scheme.id);
        runs::set(named, "composition", name);
        named.until_steps = true;
        named.steps = 20;
        runs::show_all(named);
        if (problem.keeps_form) runs::ask(named, "structure");
        Request own = named;
        own.settings = spelt_out(scheme, named.settings);
        const auto a = runs::go(named), b = runs::go(own);
        const std::string what = problem.id + ' ' + scheme.id + ' ' + name;
        EXPECT_EQ(a.outcome.stop.reason, b.outcome.stop.reason) << what;
        EXPECT_EQ(a.outcome.cost.force_evaluations, b.outcome.cost.force_evaluations) << what;
        ASSERT_EQ(a.rows.size(), b.rows.size()) << what;
        for (std::size_t k = 0; k < a.rows.size(); ++k)
          for (std::size_t i = 0; i < a.rows[k].size(); ++i)
            ASSERT_TRUE(a.rows[k][i] == b.rows[k][i] || std::isnan(a.rows[k][i])) << what << ' ' << k;
        if (problem.keeps_form) {
          EXPECT_EQ(runs::number(a.outcome.diagnostics, "structure/max_defect"),
                    runs::number(b.outcome.diagnostics, "structure/max_defect"))
              << what;
        }
        EXPECT_EQ(stability_bound(index, named.settings, 0), stability_bound(index, own.settings, 0)) << what;
        EXPECT_EQ(declared_order(scheme, {index, named.settings}), declared_order(scheme, {index, own.settings}));
      }
    }
  EXPECT_EQ(schemes_seen, (std::set<std::string>{"leapfrog", "variational_midpoint", "galerkin_4", "time_transformed",
                                                 "contact_leapfrog", "contact_variational_midpoint",
                                                 "contact_splitting", "lifted_splitting"}));
}

/// The cache between runs distinguishes two lists of weights of the same length.
TEST(OwnWeights, AreToldApartByWhatIsKept) {
  const std::size_t leapfrog = *find_scheme("leapfrog");
  const double custom = static_cast<double>(compositions::names.size());
  const auto bound = [&](double outer) {
    return stability_bound(leapfrog, std::vector<double>{1, custom, outer, 1 - 2 * outer, outer}, 0);
  };
  EXPECT_NEAR(bound(1.0 / 3), 6, 1e-5);
  EXPECT_LT(bound(0.45), 5);
  EXPECT_EQ(bound(1.0 / 3), bound(1.0 / 3));
}

}  // namespace

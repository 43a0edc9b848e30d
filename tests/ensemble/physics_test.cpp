// What the literature computes with ensembles, reproduced.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;
using test::harvest_of;

TEST(EnsemblePhysics, AThermostatKeepsTheMomentsOfItsDensity) {
  EnsemblePlan plan = test::ensemble_of("thermostat", "contact_splitting", 10);
  test::setting(plan, "step") = 0.05;
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  scene->parameters[1] = 1;  // Q
  plan.request.scene = scene;
  constexpr std::int64_t count = 100'000;
  test::set_members(
      plan, count,
      {{false, 0, Spread::normal, {0, 1}}, {false, 1, Spread::normal, {0, 1}}, {false, 2, Spread::logistic, {0, 1}}});
  plan.final = true;
  const Harvest all = harvest_of(plan, 2);
  ASSERT_EQ(all.ended[0], count);
  // ⟨q²⟩ = ⟨p²⟩ = 1, ⟨p⁴⟩ = 3, ⟨s²⟩ = π²/3, each within four of its standard errors.
  const double pi2 = std::numbers::pi * std::numbers::pi;
  double q2 = 0, p2 = 0, p4 = 0, s2 = 0;
  const std::size_t columns = plan.request.columns.size();
  for (std::size_t i = 0; i < all.final_member.size(); ++i) {
    const double* x = &all.final[i * columns + 1];
    q2 += x[0] * x[0] / count;
    p2 += x[1] * x[1] / count;
    p4 += x[1] * x[1] * x[1] * x[1] / count;
    s2 += x[2] * x[2] / count;
  }
  const double error = 4 / std::sqrt(double(count));
  EXPECT_NEAR(q2, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(p2, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(p4, 3, error * std::sqrt(96.0));
  EXPECT_NEAR(s2, pi2 / 3, error * std::sqrt(7 * pi2 * pi2 / 15 - pi2 * pi2 / 9));
}

/// How far a tiny difference of two starts on the section x = 0 with ẏ = 0 at this energy grows: in a chaotic band
/// exponentially, else as time does.
double henon_heiles_growth(double energy, double y) {
  EnsemblePlan plan = test::ensemble_of("henon_heiles", "leapfrog", 1500);
  test::setting(plan, "composition") = 4;
  test::setting(plan, "step") = 0.1;
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  const double potential = y * y / 2 - y * y * y / 3;
  scene->initial = {0, y, std::sqrt(2 * (energy - potential)), 0};
  plan.request.scene = scene;
  constexpr double apart = 1e-9;
  test::set_members(plan, 2, {{false, 1, Spread::values, {y, y + apart}}});
  test::set_columns(plan, {"x", "y", "px", "py"});
  plan.final = true;
  const Harvest all = harvest_of(plan);
  if (all.ended[0] != 2) return 1e99;
  double most = 0;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, std::abs(all.final[i] - all.final[4 + i]));
  return most / apart;
}
TEST(EnsemblePhysics, ChaosOfHenonHeilesGrowsWithTheEnergy) {
  const auto chaotic = [](double energy) {
    int count = 0;
    for (int i = 0; i < 40; ++i) count += henon_heiles_growth(energy, -0.3 + 0.8 * i / 39) > 1e6;
    return count;
  };
  const int low = chaotic(1 / 12.0), high = chaotic(1 / 8.0);
  EXPECT_LE(low, 4);
  EXPECT_GE(high, 8);
}

TEST(EnsemblePhysics, SectionsOfHenonHeilesLieOnTheEnergySurface) {
  EnsemblePlan plan = test::ensemble_of("henon_heiles", "leapfrog", 500);
  test::setting(plan, "composition") = 4;
  test::setting(plan, "step") = 0.1;
  test::set_members(plan, 30, {{false, 1, Spread::grid, {-0.2, 0.3, 30}}});
  test::set_columns(plan, {"x", "y", "px", "py", "energy"});
  test::set_plane(plan, "x", 1);
  plan.final = true;
  const Harvest all = harvest_of(plan);
  ASSERT_GT(all.section.t.size(), 30 * 50u);
  for (std::size_t i = 0; i < all.section.t.size(); ++i) {
    const double* x = &all.section.values[5 * i];
    EXPECT_NEAR(x[0], 0, 1e-13);
    EXPECT_GT(x[2], 0) << "upwards";
    const auto m = static_cast<std::size_t>(all.section.member[i]);
    EXPECT_NEAR(x[4], all.final[5 * m + 4], 1e-6) << "the energy of its member";
  }
}

/// Orbits that friction slows down from starts all around, by the preset `capture`: the 1:1 resonance catches them (all
/// 4,096 of them when this was written).
TEST(EnsemblePhysics, SpinsAreCapturedIntoTheSynchronousResonance) {
  EnsemblePlan plan = test::ensemble_of("spin_orbit", "contact_splitting", 4000);
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  const auto& card = scene->card();
  const auto preset = std::ranges::find(card.presets, "capture", &PresetCard::name);
  ASSERT_NE(preset, card.presets.end());
  for (const auto& [name, value] : preset->parameters) {
    const auto at = std::ranges::find(card.parameters, name, &ParameterCard::name);
    scene->parameters[static_cast<std::size_t>(at - card.parameters.begin())] = value;
  }
  scene->initial[1] = 3;
  plan.request.scene = scene;
  test::setting(plan, "step") = std::numbers::pi / 10;
  test::setting(plan, "composition") = 4;
  constexpr std::int64_t starts = 4096;
  test::set_members(plan, starts, {{false, 0, Spread::grid, {0, 2 * std::numbers::pi, starts}}});
  test::set_columns(plan, {"p"});
  plan.histograms = {{0, 0.84, 1.16, 1}};
  const Harvest all = harvest_of(plan, 2);
  EXPECT_EQ(all.ended[0], starts);
  const double share = static_cast<double>(all.histograms[0].counts[0]) / starts;
  EXPECT_GT(share, 0.9) << share << " ± " << std::sqrt(share * (1 - share) / starts);
}

}  // namespace

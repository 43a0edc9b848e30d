// Results of the literature that are computed with ensembles, reproduced.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "tests/support/ensembles.hpp"
#include "tests/support/texts.hpp"

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
  test::set_members(plan, count,
                    {{Varied::variable, 0, Spread::normal, {0, 1}},
                     {Varied::variable, 1, Spread::normal, {0, 1}},
                     {Varied::variable, 2, Spread::logistic, {0, 1}}});
  plan.final = true;
  const Harvest all = harvest_of(plan, 2);
  ASSERT_EQ(all.ended[0], count);
  // ⟨q²⟩ = ⟨p²⟩ = 1, ⟨p⁴⟩ = 3, ⟨s²⟩ = π²/3, each within four of its standard errors.
  const double pi2 = std::numbers::pi * std::numbers::pi;
  double q2 = 0, p2 = 0, p4 = 0, s2 = 0, moved = 0;
  const std::size_t columns = plan.request.columns.size();
  for (std::size_t i = 0; i < all.final_member.size(); ++i) {
    const double* x = &all.final[i * columns + 1];
    q2 += x[0] * x[0] / count;
    p2 += x[1] * x[1] / count;
    p4 += x[1] * x[1] * x[1] * x[1] / count;
    s2 += x[2] * x[2] / count;
    const double from = plan.members.of(all.final_member[i])[0];
    moved += (x[0] - from) * (x[0] - from) / count;
  }
  EXPECT_GT(moved, 1) << "they begin with these moments, and must not keep them by standing still";
  const double error = 4 / std::sqrt(double(count));
  EXPECT_NEAR(q2, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(p2, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(p4, 3, error * std::sqrt(96.0));
  EXPECT_NEAR(s2, pi2 / 3, error * std::sqrt(7 * pi2 * pi2 / 15 - pi2 * pi2 / 9));
}

/// henon_heiles_growth() returns how much a tiny difference of two starts on the section x = 0 with ẏ = 0 at this
/// energy grows: exponentially in a chaotic band, else in proportion to time.
double henon_heiles_growth(double energy, double y) {
  EnsemblePlan plan = test::ensemble_of("henon_heiles", "leapfrog", 1500);
  test::setting(plan, "composition") = 4;
  test::setting(plan, "step") = 0.1;
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  const double potential = y * y / 2 - y * y * y / 3;
  scene->initial = {0, y, std::sqrt(2 * (energy - potential)), 0};
  plan.request.scene = scene;
  constexpr double apart = 1e-9;
  test::set_members(plan, 2, {{Varied::variable, 1, Spread::values, {y, y + apart}}});
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
  test::set_members(plan, 30, {{Varied::variable, 1, Spread::grid, {-0.2, 0.3, 30}}});
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

/// spins() plans the spin–orbit problem with the parameters of a preset, some of them replaced by `others`.
EnsemblePlan spins(std::string_view preset, double end, const std::map<std::string_view, double>& others = {}) {
  EnsemblePlan plan = test::ensemble_of("spin_orbit", "contact_splitting", end);
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  const auto& card = scene->card();
  const auto found = std::ranges::find(card.presets, preset, &PresetCard::name);
  if (found == card.presets.end()) throw std::out_of_range(std::string(preset));
  const auto set = [&](std::string_view name, double value) {
    const auto at = std::ranges::find(card.parameters, name, &ParameterCard::name);
    scene->parameters[static_cast<std::size_t>(at - card.parameters.begin())] = value;
  };
  for (const auto& [name, value] : found->parameters) set(name, value);
  for (const auto& [name, value] : others) set(name, value);
  plan.request.scene = scene;
  test::setting(plan, "composition") = 4;
  return plan;
}

/// spreads() returns the spread of θ̇ over the points of each orbit that starts with q = 0 and θ̇ on a grid, sampled
/// once a period: over the first half of its points, and over all of them.
std::vector<std::pair<double, double>> spreads(EnsemblePlan plan, double from, double to, std::int64_t count) {
  constexpr double turn = 2 * std::numbers::pi;
  test::setting(plan, "step") = turn / 32;
  plan.request.end = 1000.5 * turn;
  test::set_members(plan, count, {{Varied::variable, 1, Spread::grid, {from, to, static_cast<double>(count)}}});
  test::set_columns(plan, {"p"});
  plan.request.section = Section{false, turn};
  const SectionPoints points = harvest_of(plan, 2).section;
  std::vector<std::pair<double, double>> all;
  for (std::size_t at = 0; at + 1000 <= points.t.size(); at += 1000) {
    const auto first = points.values.begin() + static_cast<std::ptrdiff_t>(at);
    const auto spread = [&](std::ptrdiff_t n) {
      const auto [low, high] = std::minmax_element(first, first + n);
      return *high - *low;
    };
    all.emplace_back(spread(500), spread(1000));
  }
  return all;
}

/// For a nearly round moon of nearly constant shape the orbits are curves. About the synchronous resonance they are
/// those of a pendulum of half-width √(2εW₂): within it θ̇ oscillates by as much on either side, outside it only
/// ripples.
TEST(EnsemblePhysics, SpinsOfAFirmMoonStayOnCurves) {
  const auto all = spreads(spins("resonant_1", 1), 0.7, 1.3, 25);
  ASSERT_EQ(all.size(), 25u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double off = std::abs(0.7 + 0.6 * static_cast<double>(i) / 24 - 1);
    const auto [half, whole] = all[i];
    EXPECT_NEAR(half, whole, 0.02 * whole) << off << ": a curve is soon drawn";
    if (off < 0.11) {
      EXPECT_NEAR(whole, 2 * off, 0.01) << off;
    } else if (off > 0.14) {
      EXPECT_NEAR(whole, off - std::sqrt(off * off - 2 * 0.0075), 0.1 * whole) << off;
    }
  }
}

/// For a moon far from round on an eccentric orbit the resonances 1:1 and 3:2 overlap, and every orbit of the chaotic
/// band wanders over all of it. The band grows with λ, and the islands move to (1 − λ²)^½/(1 + λ) of their place,
/// because what rotates evenly is the angular momentum Cθ̇.
TEST(EnsemblePhysics, TheChaoticBandOfSpinsGrowsWithTheChangeOfShape) {
  const auto of = [](double lambda) {
    return spreads(spins("resonant_1", 1, {{"eccentricity", 0.06}, {"epsilon", 0.045}, {"lambda", lambda}}), 0.4, 2,
                   65);
  };
  struct Band {
    double least = 9, most = 0;
    int orbits = 0;
  };
  const auto band = [](const std::vector<std::pair<double, double>>& all) {
    Band found;
    for (const auto& [half, whole] : all) {
      if (!(whole > 0.55)) continue;
      found = {std::min(found.least, whole), std::max(found.most, whole), found.orbits + 1};
    }
    return found;
  };
  const auto calmest = [](const std::vector<std::pair<double, double>>& all, double about) {
    std::size_t best = 0;
    const auto place = [](std::size_t i) { return 0.4 + 1.6 * static_cast<double>(i) / 64; };
    for (std::size_t i = 0; i < all.size(); ++i)
      if (std::abs(place(i) - about) < 0.15 &&
          !(all[i].second > all[best].second && std::abs(place(best) - about) < 0.15))
        best = i;
    return place(best);
  };
  const auto firm = of(0.001), soft = of(0.2);
  const Band small = band(firm), large = band(soft);
  EXPECT_GE(small.orbits, 4);
  EXPECT_GE(large.orbits, 8);
  EXPECT_NEAR(small.least, small.most, 0.08) << "one band, and all of it";
  EXPECT_GT(large.most, small.most + 0.1);
  EXPECT_LT(small.orbits + large.orbits, 65) << "and islands within it";
  const double shift = std::sqrt(1 - 0.04) / 1.2;
  EXPECT_NEAR(calmest(firm, 1), 1, 0.03);
  EXPECT_NEAR(calmest(soft, shift), shift, 0.03);
  EXPECT_NEAR(calmest(soft, 1.5 * shift), 1.5 * shift, 0.03) << "3:2";
}

/// Friction slows down orbits from starts all around (the preset `capture`), and the 1:1 resonance captures them (all
/// 4,096 of them when this was written).
TEST(EnsemblePhysics, SpinsAreCapturedIntoTheSynchronousResonance) {
  EnsemblePlan plan = spins("capture", 4000);
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  scene->initial[1] = 3;
  plan.request.scene = scene;
  test::setting(plan, "step") = std::numbers::pi / 10;
  constexpr std::int64_t starts = 4096;
  test::set_members(plan, starts, {{Varied::variable, 0, Spread::grid, {0, 2 * std::numbers::pi, starts}}});
  test::set_columns(plan, {"p"});
  plan.histograms = {{0, 0.84, 1.16, 1}};
  const Harvest all = harvest_of(plan, 2);
  EXPECT_EQ(all.ended[0], starts);
  const double share = static_cast<double>(all.histograms[0].counts[0]) / starts;
  EXPECT_GT(share, 0.9) << share << " ± " << std::sqrt(share * (1 - share) / starts);
}

/// The limit cycle from every start, sampled where x rises through 0. The period, from the last two crossings, is
/// compared with 2π(1 + ε²/16 − 5ε⁴/3072) for small ε (Andersen & Geer, SIAM J. Appl. Math. 42, 678 (1982)), else with
/// METHODS.md, 6.
TEST(EnsemblePhysics, ThePeriodOfVanDerPolGrowsAsIsKnown) {
  EnsemblePlan plan = test::ensemble_of("van_der_pol", "contact_splitting", 260);
  test::setting(plan, "composition") = 7;
  const std::vector<double> strengths{0.1, 0.2, 1, 10};
  const auto small = [](double e) { return 2 * std::numbers::pi * (1 + e * e / 16 - 5 * e * e * e * e / 3072); };
  const std::vector<double> periods{small(0.1), small(0.2), 6.66328685932313, 19.0783695669390};
  test::set_members(plan, 4, {{Varied::parameter, 0, Spread::values, strengths}});
  test::set_plane(plan, "x", 1);
  const SectionPoints points = harvest_of(plan).section;
  for (std::int64_t m = 0; m < 4; ++m) {
    const auto end = std::ranges::upper_bound(points.member, m) - points.member.begin();
    ASSERT_GT(end, 2);
    const double period = points.t[static_cast<std::size_t>(end - 1)] - points.t[static_cast<std::size_t>(end - 2)];
    const double e = strengths[static_cast<std::size_t>(m)], expected = periods[static_cast<std::size_t>(m)];
    EXPECT_NEAR(period, expected, e < 1 ? std::pow(e, 6) : 1e-9) << e;
  }
}

/// ẍ + 0.2 ẋ + sin x = 2 cos t: nearly every start ends in one of two motions that rotate one way or the other, once
/// per period of the drive. Half a period later each is the mirror image of the other, and the boundary of their basins
/// is fractal.
TEST(EnsemblePhysics, BasinsOfTheDrivenPendulumHaveAFractalBoundary) {
  constexpr double turn = 2 * std::numbers::pi;
  constexpr int grid = 512, steps = 48, turns = 40;
  auto typed = texts::of(text::Definition::Kind::potential, {"q"}, {{"a", 2}, {"alpha", 0.2}}, "-cos(q) - a*q*cos(t)");
  const auto pendulum = texts::mechanics_of(texts::damped(std::move(typed), "alpha"));
  EnsemblePlan plan = test::ensemble_of("damped_pendulum", "contact_splitting", 1);
  test::setting(plan, "step") = turn / steps;
  const auto& variables = pendulum->card().variables;  // some variables of scenes as text are hidden
  const std::vector<double> nothing(variables.size(), 0);
  const auto p = static_cast<std::size_t>(std::ranges::find(variables, "p", &VariableCard::name) - variables.begin());
  plan.request.scene = std::make_shared<const Scene>(Scene{pendulum, {2, 0.2}, nothing, 0});
  plan.request.until_steps = true;
  plan.final = true;
  test::set_columns(plan, {"p"});
  // θ̇ at the end, from starts that lie `aside` to the right of those of the grid.
  const auto ends = [&](double aside, int more_steps) {
    plan.request.steps = turns * steps + more_steps;
    test::set_members(plan, grid * grid,
                      {{Varied::variable, 0, Spread::grid, {aside - turn / 2, aside + turn / 2, grid}},
                       {Varied::variable, p, Spread::grid, {-2, 4, grid}}});
    const Harvest all = harvest_of(plan, 2);
    EXPECT_EQ(all.ended[0], grid * grid);
    return all.final;
  };
  const auto here = ends(0, 0), later = ends(0, steps / 2);
  ASSERT_EQ(here.size(), std::size_t{grid * grid});
  std::vector<double> sorted = here;
  std::ranges::sort(sorted);
  const double left = sorted[sorted.size() / 5], right = sorted[sorted.size() * 4 / 5];
  EXPECT_NEAR(left, -0.607, 0.01);
  EXPECT_NEAR(right, 2.04, 0.01);
  const auto side = [&](double x) { return std::abs(x - left) < 0.02 ? -1 : std::abs(x - right) < 0.02 ? 1 : 0; };
  int settled = 0, opposite = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (side(here[i]) == 0) continue;
    ++settled;
    opposite += std::abs(later[i] + (side(here[i]) < 0 ? right : left)) < 0.1;
  }
  EXPECT_GT(settled, 0.95 * grid * grid);
  EXPECT_GT(opposite, 0.999 * settled) << "half a turn later; the others pass by on their way";
  // The number of starts with a neighbour at this distance that ends in the other motion is proportional to a power of
  // the distance, which is 1 for a smooth boundary.
  const auto uncertain = [&](double distance) {
    const auto there = ends(distance, 0);
    int count = 0;
    for (std::size_t i = 0; i < here.size(); ++i) count += side(here[i]) * side(there[i]) < 0;
    return static_cast<double>(count) / settled;
  };
  const double wide = uncertain(1e-1), narrow = uncertain(1e-3);
  EXPECT_NEAR(std::log10(wide / narrow) / 2, 0.335, 0.01) << wide << ", " << narrow;
}

}  // namespace

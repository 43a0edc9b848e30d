// Scenes as text in lanes: a step that is compiled for lanes has the bits of the scheme from which it was recorded.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/ensemble/lane_task.hpp"
#include "tests/support/ensembles.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;
using test::alone, test::in_lanes;
using text::Definition;

constexpr auto typed_l = Definition::Kind::lagrangian, typed_h = Definition::Kind::hamiltonian,
               typed_v = Definition::Kind::potential;

/// plan_of() plans a scene from a start, in the order of the text's variables, by a scheme; `steps` need not be a whole
/// number.
EnsemblePlan plan_of(const Definition& definition, std::string_view scheme, const std::vector<double>& start,
                     double step, double steps) {
  const auto mechanics = texts::mechanics_of(definition);
  const ProblemCard& card = mechanics->card();
  Scene scene{mechanics, {}, {}, 0.5};
  for (const auto& parameter : card.parameters) scene.parameters.push_back(parameter.value);
  std::size_t next = 0;
  for (const auto& variable : card.variables)
    scene.initial.push_back(variable.hidden || next == start.size() ? 0 : start[next++]);
  EnsemblePlan plan;
  plan.request.scene = std::make_shared<const Scene>(scene);
  plan.request.scheme = *find_scheme(scheme);
  for (const auto& parameter : schemes()[plan.request.scheme].parameters)
    plan.request.settings.push_back(parameter.value);
  for (std::size_t i = 0; i < card.columns.size(); ++i)
    if (card.columns[i].by_default) plan.request.columns.push_back(i);
  test::setting(plan, "step") = step;
  plan.request.end = scene.start + steps * step;
  return plan;
}
/// vary_starts() spreads the members' starts about that of the scene.
void vary_starts(EnsemblePlan& plan, std::int64_t count) {
  std::vector<Variation> vary;
  const auto& variables = plan.request.scene->card().variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const double x = plan.request.scene->initial[i];
    if (!variables[i].hidden) vary.push_back({Varied::variable, i, Spread::uniform, {x - 0.01, x + 0.02}});
  }
  test::set_members(plan, count, vary);
}

struct TextInLanes {
  const char* name;
  Definition definition;
  std::vector<double> start;
  bool exact;  ///< no functions with other bits in the C library
};
/// forms_in_lanes() returns one scene of each form.
std::vector<TextInLanes> forms_in_lanes() {
  using texts::of;
  return {
      {"separable", of(typed_l, {"x", "y"}, {{"mu", 1}}, "(vx^2 + vy^2)/2 + mu/sqrt(x^2 + y^2)"), {1, 0, 0, 1.1}, true},
      {"oscillator", of(typed_h, {"q"}, {{"k", 1}}, "p^2/2 + k*q^2/2"), {1, 0.2}, true},
      {"timed separable", of(typed_v, {"x"}, {{"a", 0.3}}, "x^4/4 - a*x*cos(t)"), {1, 0}, false},
      {"masses", of(typed_h, {"x", "y"}, {{"m", 3}}, "px^2/(2*m) + py^2/0.4 + (x - y)^4"), {1, 0, 0.3, 0.1}, true},
      {"full mass",
       of(typed_h, {"x", "y"}, {{"m", 3}}, "px^2 + py^2 - px*py/m + (x - y)^4 + x^2"),
       {1, 0, 0.3, 0.1},
       true},
      {"damped full mass",
       of(typed_l, {"x", "y"}, {{"m", 3}}, "vx^2 + vy^2 - vx*vy/m - (x - y)^4 - x^2 - 0.1*s"),
       {1, 0, 0.3, 0.1, 0.2},
       false},
      {"damped", of(typed_l, {"q"}, {{"alpha", 0.1}}, "v^2/2 - q^2/2 - q^4/4 - alpha*s"), {1, 0.3, 0.1}, false},
      {"strongly damped", of(typed_l, {"q"}, {{"alpha", 9}}, "v^2/2 - q^2/2 - alpha*s"), {1, 0.3, 0.1}, false},
      {"driven", of(typed_l, {"q"}, {{"w", 1.1}}, "v^2/2 - q^2/2 + cos(w*t)*q - 0.1*s"), {1, 0, 0}, false},
      {"timed damping",
       of(typed_l, {"x", "y"}, {{"a", 0.4}}, "(vx^2 + vy^2)/2 + 1/sqrt(x^2 + y^2) - a*sin(pi*t)*s"),
       {1, 0, 0, 1.1, 0.2},
       false},
      {"rational damping", of(typed_l, {"x"}, {{"a", 0.4}}, "vx^2/2 - x^4 - a/t*s"), {1, 0, 0.2}, false},
      {"quadratic", of(typed_l, {"q"}, {{"g", 1}}, "v^2/2 - q^2/2 - g*s^2/2 + 1"), {0.5, 0.3, -0.4}, false},
      {"metric",
       of(typed_l, {"a", "b"}, {{"m", 1}}, "va^2 + m*vb^2/2 + cos(a - b)*va*vb + 2*cos(a) + cos(b)"),
       {1, 0.5, 0, 0.2},
       false},
      {"magnetic", of(typed_h, {"x", "y"}, {{"b", 0.7}}, "((px + b*y/2)^2 + (py - b*x/2)^2)/2"), {1, 0, 0, 1}, true},
      {"acting", of(typed_h, {"q"}, {{"b", 0.7}}, "p^2/2 + q^2/2 + b*q*s"), {1, 0, 0.3}, true},
      {"flow",
       texts::flow({"x", "v"}, {{"e", 1}}, {{"x", "v"}, {"v", "e*(1 - x^2)*v - x + (x - v)/9*(v - x)"}}),
       {1, 0.5},
       true},
      {"functions",
       texts::flow({"x", "y"}, {},
                   {{"x", "tan(y/9) + asin(x/9) - acos(x/9)/9 + x^0.3 + exp(-y) - x"},
                    {"y", "sinh(x/9) + cosh(y/9) - tanh(x) + atan(y) + log(x) + sin(y) - y"}}),
       {1, 0.5},
       false},
  };
}
/// for_each_text_in_lanes() calls f(plan, name, exact) for every form by every scheme of lanes that fits, with
/// compositions; `exact` as in TextInLanes.
template <class F>
void for_each_text_in_lanes(F&& f) {
  for (const TextInLanes& text : forms_in_lanes()) {
    for (const std::string_view scheme : lane_schemes) {
      EnsemblePlan plan = plan_of(text.definition, scheme, text.start, 0.02, 60.4);
      const auto& fit = plan.request.scene->card().schemes;
      if (std::ranges::find(fit, plan.request.scheme) == fit.end()) continue;
      vary_starts(plan, 70);
      const auto composition = schemes()[plan.request.scheme].find("composition");
      for (const double kind : composition ? std::vector<double>{0, 4} : std::vector<double>{0}) {
        if (composition) plan.request.settings[*composition] = kind;
        f(EnsemblePlan(plan), std::string(text.name) + " by " + std::string(scheme) + ", " + std::to_string(kind),
          text.exact);
      }
    }
  }
}
void expect_same_harvest(const Harvest& lanes, const Harvest& lone, bool exact, const std::string& name) {
  EXPECT_EQ(lanes.ended, lone.ended) << name;
  EXPECT_EQ(lanes.final_member, lone.final_member) << name;
  EXPECT_EQ(lanes.cost.steps, lone.cost.steps) << name;
  EXPECT_EQ(lanes.cost.force_evaluations, lone.cost.force_evaluations) << name;
  EXPECT_EQ(lanes.section.member, lone.section.member) << name;
  EXPECT_EQ(lanes.section.crossing, lone.section.crossing) << name;
  if (exact) {
    EXPECT_EQ(lanes.final, lone.final) << name;
    EXPECT_EQ(lanes.section.t, lone.section.t) << name;
    EXPECT_EQ(lanes.section.values, lone.section.values) << name;
  }
  const auto near = [&](const std::vector<double>& a, const std::vector<double>& b) {
    ASSERT_EQ(a.size(), b.size()) << name;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-10 * (1 + std::abs(b[i]))) << name;
  };
  near(lanes.final, lone.final);
  near(lanes.section.values, lone.section.values);
}

TEST(TextLanes, HaveTheBitsOfLoneRuns) {
  int exact_ones = 0;
  for_each_text_in_lanes([&](EnsemblePlan plan, const std::string& name, bool exact) {
    const auto first = in_lanes(plan, lane_units().front());
    ASSERT_TRUE(first) << name;
    EXPECT_EQ(first->ended[0], 70) << name;
    for (const LaneUnit& unit : lane_units()) EXPECT_EQ(in_lanes(plan, unit)->final, first->final) << name;
    plan.first = 66;  // in other lanes of a register
    plan.last = 69;
    const Harvest few = in_lanes(plan, lane_units().front()).value();
    const auto columns = static_cast<std::ptrdiff_t>(plan.request.columns.size());
    EXPECT_EQ(few.final, std::vector<double>(first->final.begin() + 66 * columns, first->final.begin() + 69 * columns))
        << name;
    expect_same_harvest(few, alone(plan), exact, name);
    exact_ones += exact;
  });
  EXPECT_GE(exact_ones, 30);
}

TEST(TextLanes, HaveStatisticsOfLoneRunsAndColumnsOfTheirStates) {
  for (const TextInLanes& text : forms_in_lanes()) {
    Definition definition = text.definition;
    definition.invariants = {
        {"sum", definition.kind == Definition::Kind::equations
                    ? definition.variables[0] + "^2"
                    : definition.variables[0] + "*" + text::momentum_name(definition.variables[0])}};
    EnsemblePlan plan = plan_of(definition, "runge_kutta_4", text.start, 0.02, 30);
    vary_starts(plan, 20);
    const auto& columns = plan.request.scene->card().columns;
    plan.request.columns.clear();
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (is_of_state(columns[i]) && !columns[i].hidden) plan.request.columns.push_back(i);
    const Harvest lanes = test::harvest_of(plan, 2), lone = alone(plan);
    const std::size_t width = plan.request.columns.size();
    EXPECT_GE(width, 4u);
    for (std::size_t k = 0; k < width; ++k) {
      std::vector<double> values;
      for (std::size_t i = k; i < lone.final.size(); i += width) values.push_back(lone.final[i]);
      const Moments expected = Moments::of(values);
      const std::string& name = columns[plan.request.columns[k]].name;
      EXPECT_EQ(lanes.columns[k].count, 20) << text.name << " " << name;
      if (text.exact) {
        EXPECT_EQ(lanes.columns[k].mean, expected.mean) << text.name << " " << name;
        EXPECT_EQ(lanes.columns[k].squares, expected.squares) << text.name << " " << name;
      }
      EXPECT_NEAR(lanes.columns[k].mean, expected.mean, 1e-10) << text.name << " " << name;
      EXPECT_NEAR(lanes.columns[k].maximum, expected.maximum, 1e-10) << text.name << " " << name;
    }
  }
}

/// The members include values of parameters at which the recorded formula has another shape.
TEST(TextLanes, HaveParametersOfTheirOwn) {
  const auto power = texts::of(typed_v, {"x", "y"}, {{"n", 3}, {"m", 1}, {"a", 0}}, "x^n/m + m*y^2 + a*x*y + y^4");
  for (const char* scheme : {"leapfrog", "runge_kutta_4"}) {
    EnsemblePlan plan = plan_of(power, scheme, {1, 0.3, 0.1, 0.2}, 0.02, 60.4);
    vary_starts(plan, 3 * 4 * 3);
    plan.members.vary.resize(2);
    plan.members.vary.push_back({Varied::parameter, 0, Spread::values, {2, 3, 4}});
    plan.members.vary.push_back({Varied::parameter, 1, Spread::values, {0.5, 1, 1.7, 2.1}});
    plan.members.vary.push_back({Varied::parameter, 2, Spread::values, {0, 1, 0.2}});
    const Harvest lone = alone(plan);
    EXPECT_EQ(lone.ended[0], 36);
    for (const LaneUnit& unit : lane_units()) {
      const auto lanes = in_lanes(plan, unit);
      ASSERT_TRUE(lanes);
      expect_same_harvest(*lanes, lone, true, scheme);
    }
  }
  for (const TextInLanes& text : forms_in_lanes()) {
    if (text.definition.parameters.empty()) continue;
    const char* scheme = text.definition.kind == Definition::Kind::equations ? "runge_kutta_4" : "explicit_midpoint";
    for (const char* other : {"leapfrog", "contact_leapfrog", "contact_splitting"}) {
      const auto mechanics = texts::mechanics_of(text.definition);
      const auto& fit = mechanics->card().schemes;
      if (std::ranges::find(fit, *find_scheme(other)) != fit.end()) scheme = other;
    }
    EnsemblePlan plan = plan_of(text.definition, scheme, text.start, 0.02, 30.4);
    const double value = text.definition.parameters[0].second;
    test::set_members(plan, 1100, {{Varied::parameter, 0, Spread::uniform, {value, 1.01 * value + 0.01}}});
    plan.first = 1000;
    const Harvest lanes = in_lanes(plan, lane_units().front()).value();
    EXPECT_EQ(lanes.ended[0], 100) << text.name;
    plan.last = 1005;
    expect_same_harvest(in_lanes(plan, lane_units().back()).value(), alone(plan), text.exact, text.name);
    EXPECT_TRUE(
        std::equal(lanes.final.begin(), lanes.final.begin() + 5, in_lanes(plan, lane_units().back())->final.begin()))
        << text.name;
  }
}

/// Where hardly two members have the same operations, nothing can be shared between lanes.
TEST(TextLanes, AreLeftWhereMembersAreNotAlike) {
  const auto powers = texts::of(typed_v, {"x", "y"}, {{"n", 3}, {"m", 3}}, "x^2/2 + y^2 + x^n + y^m");
  EnsemblePlan plan = plan_of(powers, "leapfrog", {0.3, 0.2, 0.1, 0}, 0.02, 1);
  const std::vector<double> exponents{2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  test::set_members(
      plan, 100,
      {{Varied::parameter, 0, Spread::values, exponents}, {Varied::parameter, 1, Spread::values, exponents}});
  EXPECT_FALSE(in_lanes(plan, lane_units().front()));
  EXPECT_EQ(alone(plan).ended[0], 100);
}

TEST(TextLanes, MeetSectionsAsAlone) {
  const auto well = texts::of(typed_v, {"x", "y"}, {{"k", 1}}, "(x^2 + y^2)/2 + k*(x^2*y - y^3/3)");
  const auto damped = texts::of(typed_l, {"q"}, {{"a", 0.1}}, "v^2/2 - 2*q^2 - a*s");
  for (const auto& [definition, scheme, plane, exact] : {std::tuple{well, "leapfrog", "x", true},
                                                         {well, "ruth_3", "x*px + y*py - 0.001", true},
                                                         {well, "runge_kutta_4", "", true},
                                                         {well, "leapfrog", "", true},
                                                         {damped, "contact_leapfrog", "q - 0.01", true},
                                                         {damped, "contact_splitting", "s - 0.01", false},
                                                         {damped, "contact_leapfrog", "", true}}) {
    EnsemblePlan plan = plan_of(definition, scheme, {0.1, 0.2, 0.05, 0.3}, 0.05, 700.4);
    if (schemes()[plan.request.scheme].find("composition")) test::setting(plan, "composition") = 1;
    vary_starts(plan, 21);
    if (std::string_view(plane).empty()) {
      plan.request.section = Section{false, 1.53, 0.25};
    } else {
      test::set_plane(plan, plane, 0);
    }
    const Harvest lone = alone(plan);
    ASSERT_GT(lone.section.t.size(), 60u) << plane;
    for (const LaneUnit& unit : lane_units()) {
      const auto lanes = in_lanes(plan, unit);
      ASSERT_TRUE(lanes) << scheme << " " << plane;
      expect_same_harvest(*lanes, lone, exact, std::string(scheme) + " " + plane);
    }
  }
  EnsemblePlan plan = plan_of(well, "leapfrog", {0.1, 0.2, 0.05, 0.3}, 0.05, 700.4);
  test::set_members(
      plan, 20,
      {{Varied::parameter, 0, Spread::values, {0, 1, 1.1, 0.9}}, {Varied::variable, 0, Spread::grid, {0, 0.1, 5}}});
  plan.request.section = Section{false, 1.53, 0.25};
  plan.request.limits.samples = 300;
  const Harvest lone = alone(plan), lanes = in_lanes(plan, lane_units().front()).value();
  EXPECT_TRUE(lanes.truncated);
  EXPECT_EQ(lanes.section.member, lone.section.member) << "members of several shapes come in their order";
  EXPECT_EQ(lanes.section.values, lone.section.values);
}

/// Members that end for different reasons at different times, beside others that go on.
TEST(TextLanes, EndEachForItself) {
  const auto expect = [](const EnsemblePlan& plan, ReturnCode reason, const char* name) {
    const Harvest lone = alone(plan);
    EXPECT_GT(lone.ended[0], 0) << name;
    EXPECT_GT(lone.ended[static_cast<std::size_t>(reason)], 0) << name;
    for (const LaneUnit& unit : lane_units()) {
      const Harvest lanes = in_lanes(plan, unit).value();
      EXPECT_EQ(lanes.ended, lone.ended) << name;
      EXPECT_EQ(lanes.final_member, lone.final_member) << name;
      EXPECT_EQ(lanes.cost.steps, lone.cost.steps) << name;
    }
  };
  const auto saddle = texts::of(typed_v, {"x", "y"}, {{"m", 1}}, "m*(x^2/2 - x^4/4) + y^2/2");
  EnsemblePlan plan = plan_of(saddle, "leapfrog", {0.1, 0, 0, 0}, 0.05, 400.4);
  test::set_members(plan, 90, {{Varied::variable, 0, Spread::grid, {0.5, 1.5, 90}}});
  expect(plan, ReturnCode::not_finite, "escapes");
  plan.request.limits.steps = 10;
  EXPECT_EQ(in_lanes(plan, lane_units().front())->ended[static_cast<std::size_t>(ReturnCode::step_limit)], 90);
  const auto quadratic = texts::quadratic(texts::of(typed_v, {"q"}, {{"g", 1}}, "q^2/2"), "g", "1");
  for (const char* scheme : {"contact_splitting", "contact_leapfrog"}) {  // in a run alone their diagnosis is expensive
    plan = plan_of(quadratic, scheme, {0.5, 0.3, 0}, 0.05, 100.4);
    const auto s = plan.request.scene->card().variables.size() - 1;
    test::set_members(plan, 8, {{Varied::variable, s, Spread::grid, {-50, 0, 8}}});
    expect(plan, ReturnCode::singular, scheme);
  }
  const auto massive = texts::of(typed_l, {"x"}, {{"m", 1}}, "m*vx^2/2 + log(1 - x)");
  plan = plan_of(massive, "leapfrog", {0.1, 0}, 0.05, 40.4);
  test::set_members(
      plan, 40, {{Varied::parameter, 0, Spread::grid, {-1, 1, 8}}, {Varied::variable, 0, Spread::grid, {0.1, 1.4, 5}}});
  const Harvest lanes = in_lanes(plan, lane_units().front()).value(), lone = alone(plan);
  EXPECT_EQ(lanes.ended, lone.ended) << "where a mass is none, or the start lies at a singularity";
  EXPECT_GT(lanes.ended[0], 0);
}

// The second operand of an `and` whose first is false, or of an `or` whose first is true, may be undefined: it is not
// evaluated.
TEST(TextLanes, GoOnWhereNoNumberIsAskedFor) {
  for (const char* text : {"if(x > 0.1 and log(x) < 9 + x, x, 2*x)", "if(x < 0.1 or x*log(x) < 9, x, 2*x)"}) {
    EnsemblePlan plan = plan_of(texts::of(typed_v, {"x"}, {}, text), "leapfrog", {0.5, 0}, 0.01, 300);
    vary_starts(plan, 40);
    const Harvest lone = alone(plan), lanes = in_lanes(plan, lane_units().front()).value();
    EXPECT_EQ(lanes.ended[0], 40) << text;
    EXPECT_EQ(lanes.ended, lone.ended) << text;
    EXPECT_EQ(lanes.final, lone.final) << text;
  }
}

// A choice by an undefined value ends a member as it ends a run: x falls from 1/2 through 0.
TEST(TextLanes, StopWhereAChoiceIsByNoNumber) {
  for (const char* text :
       {"if(log(x) < 9, x, x^2)", "x*min(1, 9 - log(x))", "if(2*sqrt(x) < 9, x, x^2)", "if(log(x) < 9 + x, x, x^2)",
        "if(x < 9 and x*log(x) < 9, x, x^2)", "if(x > 9 or log(x) < 9 + x, x, x^2)"}) {
    for (const char* scheme : {"leapfrog", "runge_kutta_4"}) {
      EnsemblePlan plan = plan_of(texts::of(typed_v, {"x"}, {}, text), scheme, {0.5, 0}, 0.01, 300);
      vary_starts(plan, 40);
      for (const LaneUnit& unit : lane_units()) {
        const auto lanes = in_lanes(plan, unit);
        ASSERT_TRUE(lanes) << text;
        EXPECT_EQ(lanes->ended[static_cast<std::size_t>(ReturnCode::completed)], 0) << text << ' ' << scheme;
        EXPECT_EQ(lanes->ended, alone(plan).ended) << text << ' ' << scheme;
      }
    }
  }
}

}  // namespace

// Properties of the derivatives of every problem of the catalogue, over HTTP.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class SensitivityLaws : public Asking {
 protected:
  /// of_whole_start() requests derivatives of the motion by the whole start, of second order over a span in which
  /// differences are accurate.
  static Json of_whole_start(const ProblemCard& card, int order, double most = 1) {
    const double start = card.id == "lane_emden" ? 0.5 : 0;
    Json request{{"problem", card.id},
                 {"initial", {{"t", start}}},
                 {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                 {"until", start + std::min(most, 0.1 * card.span)},
                 {"record", {{"every", 0}}},
                 {"sensitivities", {{"by", "initial"}, {"of", "motion"}, {"order", order}}}};
    if (card.id == "lane_emden") request["initial"].update({{"q", 0.95}, {"p", -0.04}});
    return request;
  }
  static double largest(const Json& rows) {
    double most = 1;
    for (const auto& row : rows)
      for (const double slope : row) most = std::max(most, std::abs(slope));
    return most;
  }
  /// expect_differences_of_first() compares second derivatives by the numbers at these places of a request with
  /// differences of first derivatives.
  static void expect_differences_of_first(Json request, const std::vector<std::string>& places) {
    request["sensitivities"]["order"] = 2;
    const Json found = answer(request)["sensitivities"];
    ASSERT_TRUE(found["second"]["final"].is_array()) << found;
    request["sensitivities"]["order"] = 1;
    const double h = 1e-4;
    for (std::size_t pair = 0; pair < found["second"]["pairs"].size(); ++pair) {
      const std::size_t a = found["second"]["pairs"][pair][0], b = found["second"]["pairs"][pair][1];
      const auto moved = [&](double by) {
        Json other = request;
        Json& number = other[Json::json_pointer(places[b])];
        number = number.get<double>() + by;
        return answer(other)["sensitivities"]["final"];
      };
      const Json far_up = moved(2 * h), up = moved(h), down = moved(-h), far_down = moved(-2 * h);
      for (std::size_t i = 0; i < found["rows"].size(); ++i) {
        const auto at = [&](const Json& final) { return final[i][a].get<double>(); };
        const double slope = (8 * (at(up) - at(down)) - (at(far_up) - at(far_down))) / (12 * h);
        EXPECT_NEAR(found["second"]["final"][i][pair], slope, 1e-8 * std::max(1.0, std::abs(slope)))
            << request["until"] << " " << i << found["second"]["pairs"][pair];
      }
    }
  }
};

TEST_F(SensitivityLaws, TheWholeMapKeepsItsStructure) {
  for (const auto& problem : problem_list()) {
    SCOPED_TRACE(problem->card().id);
    const Json found = answer(of_whole_start(problem->card(), 1, 5))["sensitivities"];
    const Json& structure = found["structure"];
    if (structure["kind"] == "none") continue;
    EXPECT_LT(structure["max_defect"], 1e-12 * largest(found["final"])) << structure;
  }
}

TEST_F(SensitivityLaws, SecondDerivativesAreDifferencesOfTheFirst) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (card.id == "lane_emden") continue;  // its equations have switches
    SCOPED_TRACE(card.id);
    const Json made = answer(of_whole_start(card, 2));
    const Json& found = made["sensitivities"];
    const double size = largest(found["second"]["final"]);
    for (std::size_t b = 0; b < found["by"].size(); ++b) {
      const Json::json_pointer place(found["by"][b].get<std::string>());
      const double value = made[place], step = 2e-4 * std::max(0.1, std::abs(value));
      const auto moved = [&](double by) {
        Json request = of_whole_start(card, 1);
        request[place] = value + by;
        return answer(request)["sensitivities"]["final"];
      };
      const Json up = moved(step), down = moved(-step), far_up = moved(2 * step), far_down = moved(-2 * step);
      for (std::size_t pair = 0; pair < found["second"]["pairs"].size(); ++pair) {
        const auto& two = found["second"]["pairs"][pair];
        if (two[1] != b) continue;
        const std::size_t a = two[0];
        for (std::size_t i = 0; i < found["rows"].size(); ++i) {
          const auto at = [&](const Json& final) { return final[i][a].get<double>(); };
          const double slope = (8 * (at(up) - at(down)) - (at(far_up) - at(far_down))) / (12 * step);
          EXPECT_NEAR(found["second"]["final"][i][pair], slope, 1e-6 * size) << found["rows"][i] << " " << two;
        }
      }
    }
  }
}

// `uncertainty` is about the largest error, whether that is from the tolerance or from rounding.
TEST_F(SensitivityLaws, UncertaintyIsAboutTheLargestError) {
  const auto error = [](const Json& rows, const Json& truth) {
    double most = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t k = 0; k < rows[i].size(); ++k)
        most = std::max(most, std::abs(rows[i][k].get<double>() - truth[i][k].get<double>()));
    return most / largest(truth);
  };
  const auto expect_about = [](const Json& found, double size, double within) {
    EXPECT_GT(found["uncertainty"].get<double>(), size / within) << found["by"];
    EXPECT_LT(found["uncertainty"].get<double>(), size * within) << found["by"];
  };
  const auto asked = [](const Json& problem, const Json& by, double tolerance, double until) {
    return answer({{"problem", problem},
                   {"scheme", {{"id", "taylor"}, {"tolerance", tolerance}}},
                   {"until", until},
                   {"record", {{"every", 0}}},
                   {"sensitivities", {{"by", by}}}})["sensitivities"];
  };
  const std::pair<const char*, Json> cases[] = {
      {"kepler", {"/initial/x", "/problem/mu"}},
      {"kepler", {"/problem/mu"}},
      {"double_pendulum", {"/initial/theta1", "/initial/theta2", "/initial/p1", "/problem/l1", "/problem/gravity"}},
      {"lorenz", {"/problem/rho", "/problem/sigma", "/initial/z"}},
      {"duffing", {"/initial/x", "/problem/delta"}}};
  for (const char* compiled : {"kepler", "double_pendulum", "lorenz"}) runs::problem_called(compiled);
  for (const auto& [problem, by] : cases) {
    SCOPED_TRACE(problem);
    const Json truth = asked(problem, by, 1e-15, 5)["final"];
    for (const double tolerance : {1e-4, 1e-7}) {
      const Json found = asked(problem, by, tolerance, 5);
      expect_about(found, error(found["final"], truth), 20);
    }
  }
  // In chaos rounding errors of the motion dominate those of its derivatives: the same equations in another order show
  // them.
  const Json other = custom(R"~({"variables":["x","y","z"],"parameters":{"sigma":10,"rho":28,"beta":"8/3"},
      "equations":{"x":"sigma*y - sigma*x","y":"rho*x - y - z*x","z":"y*x - z*beta"}})~");
  for (const Json& by : {Json{"/initial/x"}, Json{"/problem/rho", "/problem/beta", "/problem/sigma", "/initial/y"}}) {
    Json request{{"problem", "lorenz"}, {"until", 20}, {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}}};
    request["record"] = {{"every", 0}};
    request["initial"] = {{"x", 1}, {"y", 1}, {"z", 1}};
    request["sensitivities"] = {{"by", by}};
    const Json found = answer(request)["sensitivities"];
    request["problem"] = other;
    const double size = error(found["final"], answer(request)["sensitivities"]["final"]);
    EXPECT_GT(size, 1e-12);
    expect_about(found, size, 30);
  }
}

// A ball on a swinging floor: second derivatives are differences of first ones, and for one bounce on a floor at rest
// those of x = r√(2H)(t − t₁) − (t − t₁)²/2.
TEST_F(SensitivityLaws, OfSecondOrderGoThroughEventsThatAct) {
  const double height = 1, r = 0.8, first = std::sqrt(2 * height), t = 2.5;
  Json request{
      {"problem", custom(R"~({"variables":["x"],"parameters":{"r":0.8,"swing":0,"drag":0},"potential":"x",
                             "damping":"drag"})~")},
      {"initial", {{"x", height}}},
      {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
      {"until", t},
      {"events",
       {{{"name", "floor"},
         {"expression", "x - swing*sin(3*t)"},
         {"direction", "down"},
         {"set", {{"vx", "-r*vx + 2*r*swing*cos(3*t) + swing*t^2"}, {"x", "x + 0.1*swing*vx^2*(1+r)"}}}}}},
      {"sensitivities", {{"by", {"/initial/x", "/problem/r", "/problem/swing", "/problem/drag"}}, {"order", 2}}}};
  Json found = answer(request)["sensitivities"];
  ASSERT_TRUE(found["second"]["final"].is_array()) << found;
  const Json& exact = found["second"]["final"][0];  // for the pairs xx, xr, …, rr
  EXPECT_NEAR(exact[0], -(1 + r) * t / (first * first * first), 1e-11);
  EXPECT_NEAR(exact[1], t / first - 2, 1e-11);
  EXPECT_NEAR(exact[4], 0, 1e-11);
  EXPECT_LT(found["uncertainty"], 1e-11);
  request["problem"]["parameters"].update({{"swing", 0.05}, {"drag", 0.1}});
  for (const double until : {1.9, 5.0}) {
    request["until"] = until;
    expect_differences_of_first(
        request, {"/initial/x", "/problem/parameters/r", "/problem/parameters/swing", "/problem/parameters/drag"});
  }
}

// Derivatives are those of the motion with its own bounces, also where the bounces of the run are elsewhere; where the
// run has others the answer has no derivatives.
TEST_F(SensitivityLaws, OfTheMotionAreItsOwnHoweverCoarseTheRun) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"parameters":{"r":0.9},
      "potential":"x + x^2/8"},"initial":{"x":1},"scheme":"taylor","until":12,"record":{"every":0},
      "events":[{"name":"floor","expression":"x","direction":"down","set":{"vx":"-r*vx"}}],
      "sensitivities":{"by":["/initial/x","/initial/vx","/problem/r"],"of":"motion"}})~");
  const Json truth = answer(request);
  const double most = largest(truth["sensitivities"]["final"]);
  std::size_t same = 0, others = 0;
  for (const double step : {0.001, 0.002, 0.004, 0.008, 0.016, 0.03}) {
    request["scheme"] = {{"id", "explicit_euler"}, {"step", step}};
    const Json made = answer(request);
    const Json& found = made["sensitivities"];
    if (made["events"].size() != truth["events"].size()) {
      ++others;
      EXPECT_TRUE(found["final"].is_null()) << step;
      EXPECT_TRUE(found.contains("reason")) << step;
      continue;
    }
    ++same;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(found["final"][i][k], truth["sensitivities"]["final"][i][k], 1e-9 * most) << step << i << k;
    for (std::size_t i = 0; i < found["events"].size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(found["events"][i]["t"][k], truth["sensitivities"]["events"][i]["t"][k], 1e-9 * most) << step << i;
  }
  EXPECT_GE(same, 3U);
  EXPECT_GE(others, 1U);
}

// A ball that falls to a height c, where its run ends: its velocity there is −√(v² + 2g(x − c)). And one that arrives
// there with drag, after a bounce on a swinging floor.
TEST_F(SensitivityLaws, OfSecondOrderStandWhereAnEventEndsTheRun) {
  const double g = 1.5, c = 0.25, x = 1, v = 0.4, end = std::sqrt(v * v + 2 * g * (x - c));
  Json request{{"problem", custom(R"~({"variables":["x"],"parameters":{"g":1.5,"c":0.25,"swing":0,"drag":0},
                             "potential":"g*x","damping":"drag"})~")},
               {"initial", {{"x", x}, {"vx", v}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 20},
               {"events", {{{"name", "there"}, {"expression", "x - c"}, {"direction", "down"}, {"stop", true}}}},
               {"sensitivities", {{"by", {"/initial/x", "/initial/vx", "/problem/g", "/problem/c"}}, {"order", 2}}}};
  const Json found = answer(request)["sensitivities"];
  ASSERT_TRUE(found["second"]["final"].is_array()) << found;
  EXPECT_LT(found["uncertainty"], 1e-12);
  const double cube = end * end * end;
  const double exact[] = {g * g / cube,                   // ∂²/∂x²
                          g * v / cube,                   // ∂²/∂x∂v
                          -1 / end + g * (x - c) / cube,  // ∂²/∂x∂g
                          -g * g / cube,                  // ∂²/∂x∂c
                          -1 / end + v * v / cube,        // ∂²/∂v²
                          v * (x - c) / cube,
                          -g * v / cube,              // ∂²/∂v∂g, ∂²/∂v∂c
                          (x - c) * (x - c) / cube};  // ∂²/∂g²
  for (std::size_t pair = 0; pair < std::size(exact); ++pair) {
    EXPECT_NEAR(found["second"]["final"][0][pair], 0, 1e-12) << "x is c there";
    EXPECT_NEAR(found["second"]["final"][1][pair], exact[pair], 1e-12) << found["second"]["pairs"][pair];
  }
  request["problem"]["parameters"].update({{"swing", 0.05}, {"drag", 0.1}});
  request["events"] = {{{"name", "floor"},
                        {"expression", "x - swing*sin(3*t)"},
                        {"direction", "down"},
                        {"set", {{"vx", "-0.9*vx + 2*swing*cos(3*t)"}}}},
                       {{"name", "there"}, {"expression", "x - c*(1+swing*t)"}, {"direction", "up"}, {"stop", true}}};
  request["sensitivities"]["by"] = {"/initial/x", "/problem/swing", "/problem/drag", "/problem/c"};
  expect_differences_of_first(
      request, {"/initial/x", "/problem/parameters/swing", "/problem/parameters/drag", "/problem/parameters/c"});
}

// An event that acts may end the run, too: then the derivatives are those of the state that it makes, at its time.
TEST_F(SensitivityLaws, OfSecondOrderStandWhereAnActEndsTheRun) {
  Json request{{"problem", custom(R"~({"variables":["x","y"],"parameters":{"g":1},"potential":"g*y+0.1*x^2"})~")},
               {"initial", {{"x", 0.2}, {"y", 1}, {"vx", 0.3}, {"vy", 0.1}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 20},
               {"events", {{{"name", "hit"}, {"expression", "y"}, {"direction", "down"}, {"most", 1}}}},
               {"sensitivities", {{"by", {"/initial/x", "/initial/y", "/problem/g"}}}}};
  for (const char* set :
       {R"({"y":"1+x^2","vy":"-0.5*vy"})", R"({"y":"x","vy":"0.2*vx"})", R"({"vy":"0"})", R"({"vy":"-0.9*vy"})"}) {
    request["events"][0]["set"] = Json::parse(set);
    expect_differences_of_first(request, {"/initial/x", "/initial/y", "/problem/parameters/g"});
  }
}

// From the centre of a star, where the equations are singular: derivatives by the index, of the regular motion. For any
// n, q = 1 − t²/6 + n t⁴/120 − (8n² − 5n) t⁶/15120 + ….
TEST_F(SensitivityLaws, FromASingularStart) {
  Json request{{"problem", {{"id", "lane_emden"}, {"n", 1.5}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 3},
               {"record", {{"samples", 31}}},
               {"sensitivities", {{"by", {"/problem/n"}}}}};
  request["sensitivities"]["at"] = "samples";
  const Json made = answer(request);
  const Json& found = made["sensitivities"];
  ASSERT_TRUE(found["final"].is_array()) << found;
  EXPECT_LT(found["uncertainty"], 1e-8);
  ASSERT_EQ(found["samples"].size(), made["trajectory"]["t"].size());
  EXPECT_EQ(found["samples"][0], Json::parse("[[0.0],[0.0]]"));
  const double t = made["trajectory"]["t"][1];
  EXPECT_NEAR(t, 0.1, 1e-12);
  EXPECT_NEAR(found["samples"][1][0][0], std::pow(t, 4) / 120 - (16 * 1.5 - 5) * std::pow(t, 6) / 15120, 1e-11);
  request["record"] = {{"every", 0}};
  request["sensitivities"].erase("at");
  const auto moved = [&](double by) {
    Json other = request;
    other["problem"]["n"] = 1.5 + by;
    return answer(other)["final"]["q"].get<double>();
  };
  const double h = 1e-2, slope = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
  EXPECT_NEAR(found["final"][0][0], slope, 1e-9);
  request["sensitivities"]["by"] = {"/problem/n", "/initial/q"};
  const Json none = answer(request)["sensitivities"];
  EXPECT_TRUE(none["final"].is_null());
  EXPECT_NE(none["reason"].get<std::string>().find("parameters alone"), std::string::npos) << none;
}

// Second derivatives of a body too fast to be followed end where neighbouring times are the same double: halving the
// step, which once went on for ever, ends at two neighbouring numbers.
TEST_F(SensitivityLaws, AStepIsHalvedNoFurtherThanTimesCanTell) {
  runs::problem_called("kepler");
  const Json found = answer(Json::parse(R"({"problem":"kepler","until":{"t":1},"record":{"every":0},
      "initial":{"x":1,"y":0,"px":0,"py":9007199254740992},"scheme":{"id":"runge_kutta_4","step":0.1},
      "sensitivities":{"by":["/initial/px"],"of":"motion","order":2}})"))["sensitivities"];
  EXPECT_TRUE(found["second"]["final"].is_null()) << found;
  EXPECT_TRUE(found.contains("reason")) << found;
}

// A start given by its time alone depends on that time and on the parameters, along the one regular motion: the end
// does not depend on where the run begins.
TEST_F(SensitivityLaws, ARegularStartGoesAlong) {
  Json request = {{"problem", {{"id", "lane_emden"}, {"n", 3}}},
                  {"scheme", "taylor"},
                  {"until", 3},
                  {"record", {{"every", 0}}},
                  {"sensitivities", {{"by", {"/problem/n", "/initial/t"}}}}};
  const auto slopes_from = [&](double t) {
    request["initial"] = {{"t", t}};
    return answer(request)["sensitivities"]["final"];
  };
  const Json early = slopes_from(1e-4), late = slopes_from(0.3);
  for (const std::size_t row : {0, 1}) {
    EXPECT_NEAR(late[row][0], early[row][0].get<double>(), 1e-10);
    EXPECT_EQ(late[row][1], 0);
  }
}

}  // namespace
}  // namespace least::server::test

// A start changed by very little has the defaults of the unchanged one.
#include <cmath>

#include "core/run/suggestions.hpp"
#include "server/decode/scene_files.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

std::vector<std::shared_ptr<const Mechanics>> catalogue() {
  std::vector<std::shared_ptr<const Mechanics>> all(problem_list().begin(), problem_list().end());
  for (const TextProblem& one : text_problems()) all.push_back(one.mechanics);
  return all;
}

/// Of the scene of the card.
Scene scene_of(const std::shared_ptr<const Mechanics>& mechanics) {
  Scene scene{mechanics, {}, {}, 0};
  for (const auto& parameter : mechanics->card().parameters) scene.parameters.push_back(parameter.value);
  for (const auto& variable : mechanics->card().variables) scene.initial.push_back(variable.value);
  return scene;
}

/// The places of what a start may change, and what a small change of each is measured by: the value itself, or where
/// that is 0 the largest of its kind.
std::vector<std::pair<std::size_t, double>> changeable(const Scene& scene) {
  const auto& variables = scene.card().variables;
  const auto kind = [&](std::size_t i) { return variables[i].name.substr(0, variables[i].name.find('[')); };
  std::vector<std::pair<std::size_t, double>> all;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (variables[i].hidden || !std::isfinite(variables[i].value)) continue;
    double size = std::abs(scene.initial[i]);
    for (std::size_t k = 0; k < variables.size() && size == 0; ++k)
      if (kind(k) == kind(i)) size = std::abs(scene.initial[k]);
    all.emplace_back(i, size > 0 ? size : 1);
  }
  return all;
}

/// The first scheme whose step a card suggests.
const SchemeCard* with_step(const ProblemCard& card) {
  for (const std::size_t scheme : card.schemes)
    if (schemes()[scheme].parameters.front().suggested == "step") return &schemes()[scheme];
  return nullptr;
}

void expect_the_same(const Scene& scene, const SchemeCard& scheme, const std::string& where) {
  const ProblemCard& card = scene.card();
  const double step = suggested_settings(scene, scheme).front() / plain_settings(&card, scheme, nullptr).front();
  const double span = suggested_span(scene, nullptr) / card.span;
  EXPECT_TRUE(step >= 0.5 && step <= 2) << where << ": step " << step;
  EXPECT_TRUE(span >= 0.5 && span <= 2) << where << ": until " << span;
}

TEST(NeighbouringStarts, HaveTheDefaultsOfTheCards) {
  constexpr std::size_t most_alone = 12;
  for (const auto& mechanics : catalogue()) {
    const Scene scene = scene_of(mechanics);
    const SchemeCard* scheme = with_step(scene.card());
    if (scheme == nullptr) continue;
    const std::string id(scene.card().id);
    const auto places = changeable(scene);
    for (const double share : {1e-14, 1e-11, 1e-8}) {
      for (std::size_t k = 0; k < std::min(places.size(), most_alone); ++k)
        for (const double sign : {-1.0, 1.0}) {
          Scene other = scene;
          const auto [i, size] = places[k];
          other.initial[i] += sign * share * size;
          if (scene.card().variables[i].range.contains(other.initial[i]))
            expect_the_same(other, *scheme,
                            id + " " + scene.card().variables[i].name + " " + std::to_string(std::log10(share)));
        }
      Scene all = scene;
      double sign = share;
      for (const auto& [i, size] : places)
        if (const double x = all.initial[i] + (sign = -sign) * size; scene.card().variables[i].range.contains(x))
          all.initial[i] = x;
      expect_the_same(all, *scheme, id + " all " + std::to_string(std::log10(share)));
    }
  }
}

class NeighbouringStartsHttp : public Asking {
 protected:
  /// The default step of leapfrog and the default end.
  static std::pair<double, double> defaults(const Json& problem, const Json& initial) {
    const Json made = answer({{"problem", problem},
                              {"initial", initial},
                              {"scheme", problem.contains("equations") ? "runge_kutta_4" : "leapfrog"},
                              {"limits", {{"steps", 1}}},
                              {"record", {{"every", 0}}}});
    return {made["scheme"]["step"].get<double>(), made["until"]["t"].get<double>()};
  }
};

TEST_F(NeighbouringStartsHttp, OfTypedScenesHaveTheirDefaults) {
  const Json coupled = custom(R"({"variables":["x","y"],"potential":"x^2/2+y^2/2+x^2*y/10"})");
  const Json chain = custom(
      R"~({"variables":["x[6]"],
           "potential":"x[1]^2/2 + x[6]^2/2 + sum(i=1..5, (x[i+1]-x[i])^2/2 + (x[i+1]-x[i])^4/4)"})~");
  const Json driven = custom(R"~({"variables":["x"],"potential":"x^2/2 - x*sin(t)"})~");
  const Json flow = custom(R"~({"variables":["a[6]"],"equations":{"a[i]":"if(i == 1, 0, a[i-1]) - a[i]"}})~");
  const std::pair usual(0.01, 20.0);
  for (const Json& start : {R"({"x":0.5,"y":-0.025})"_json, R"({"x":0.5,"y":-0.02500001})"_json,
                            R"({"x":1e-8,"vx":0.5})"_json, R"({"x":1e-300,"vx":0.5})"_json})
    EXPECT_EQ(defaults(coupled, start), usual) << start;
  for (const Json& start : {R"([0.5,0,0,0,0,0])"_json, R"([0.5,1e-9,0,0,0,0])"_json, R"([0.5,0,0,1e-9,0,0])"_json,
                            R"([0.5,1e-5,1e-10,1e-20,1e-30,1e-60])"_json, R"([0.5,1e-9,-1e-9,1e-9,-1e-9,1e-9])"_json}) {
    EXPECT_EQ(defaults(chain, {{"x", start}}), usual) << start;
    EXPECT_EQ(defaults(flow, {{"a", start}}), usual) << start;
  }
  for (const Json& start : {R"({"x":0})"_json, R"({"x":1e-8})"_json, R"({"vx":1e-8})"_json})
    EXPECT_EQ(defaults(driven, start), usual) << start;
}

// In polar coordinates the radius of a circle rests, but for rounding: the unit of time is the orbit's all the same.
TEST_F(NeighbouringStartsHttp, OfACircleKnowItsPeriod) {
  const Json polar =
      custom(R"~({"variables":["r","phi"],"parameters":{"mu":1.327e20},"lagrangian":"(vr^2 + r^2*vphi^2)/2 + mu/r"})~");
  const double r = 1.5e11, rate = std::sqrt(1.327e20 / (r * r * r));
  for (const double apart : {1e-14, 1e-10, 1e-6, 1e-2}) {
    const auto made = answer({{"problem", polar},
                              {"initial", {{"r", r * (1 + apart)}, {"vphi", rate}}},
                              {"scheme", "variational_midpoint"},
                              {"limits", {{"steps", 1}}},
                              {"record", {{"every", 0}}}});
    const double natural = 0.01 / 0.6 / rate;  // as if the time were 1/ω
    EXPECT_GT(made["scheme"]["step"], natural / 2) << apart;
    EXPECT_LT(made["scheme"]["step"], 3 * natural) << apart;
  }
}

// From an ellipse to a hyperbola. A change of the speed by a thousandth near the escape changes the period most: by 5.4
// percent where it reaches its bound.
TEST(NeighbouringStarts, OfOrbitsDoNotNoticeTheEscape) {
  for (const char* id : {"kepler", "damped_kepler", "perturbed_kepler"}) {
    const auto mechanics = runs::problem_called(id);
    double before = 0;
    for (double v = 0.9; v < 3; v *= 1.001) {
      Scene scene = scene_of(mechanics);
      double r = 0;
      for (std::size_t i = 0; i < 2; ++i) r = std::hypot(r, scene.initial[i]);
      scene.initial = {r, 0, 0, v * std::sqrt(2 / r)};
      scene.initial.resize(mechanics->card().variables.size());
      const Scales scales = mechanics->scales(scene);
      ASSERT_GT(scales.time, 0) << id << v;
      ASSERT_GT(scales.energy, 0) << id << v;
      if (before > 0) {
        EXPECT_NEAR(std::log(scales.time / before), 0, 0.06) << id << " at " << v << " of the escape's";
      }
      before = scales.time;
    }
  }
}

}  // namespace
}  // namespace least::server::test

// Derivatives of the states of a run, over HTTP.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Sensitivities : public Asking {
 protected:
  static Json by(const Json& pointers) { return {{"by", pointers}, {"of", "motion"}}; }

  /// differences() returns central differences of runs with two lengths, combined so that the error is of fourth order.
  static std::vector<double> differences(Json request, const Json& made, const std::string& pointer) {
    const Json::json_pointer place(pointer);
    Json base = request;
    base.erase("sensitivities");
    base["diagnostics"] = Json::array();
    base["record"] = {{"every", 0}};
    if (base["problem"].is_string()) base["problem"] = {{"id", base["problem"]}};
    const bool start = pointer.starts_with("/initial");
    const double value = base.contains(place) ? base[place].get<double>() : made[place].get<double>();
    const double range = std::max(0.1, std::abs(value));
    const auto moved = [&](double by) {
      base[start ? place : Json::json_pointer("/problem/" + place.back())] = value + by;
      return answer(base)["final"];
    };
    const double h = 2e-4 * range;
    const Json far_up = moved(2 * h), up = moved(h), down = moved(-h), far_down = moved(-2 * h);
    std::vector<double> slopes;
    for (const auto& row : made["sensitivities"]["rows"]) {
      const auto at = [&](const Json& final) { return final[row.get<std::string>()].get<double>(); };
      slopes.push_back((8 * (at(up) - at(down)) - (at(far_up) - at(far_down))) / (12 * h));
    }
    return slopes;
  }
  /// expect_differences() compares every derivative by a pointer with differences.
  static void expect_differences(Json request, double within) {
    const Json made = answer(request);
    const Json& found = made["sensitivities"];
    ASSERT_TRUE(found["final"].is_array()) << found;
    EXPECT_LT(found["uncertainty"], 1e-9) << found;
    for (std::size_t k = 0; k < found["by"].size(); ++k) {
      const std::vector<double> slopes = differences(request, made, found["by"][k]);
      double size = 1;
      for (const double slope : slopes) size = std::max(size, std::abs(slope));
      for (std::size_t i = 0; i < slopes.size(); ++i)
        EXPECT_NEAR(found["final"][i][k], slopes[i], within * size) << found["rows"][i] << " by " << found["by"][k];
    }
  }
  /// Lorenz's equations over the period of a periodic orbit, from a point on it. The true values are Barrio's
  /// derivatives.
  static Json lorenz(Json sensitivities) {
    return {{"problem", custom(R"~({"variables":["x","y","z"],"parameters":{"sigma":10,"rho":28,"beta":"8/3"},
                 "equations":{"x":"sigma*(y-x)","y":"x*(rho-z)-y","z":"x*y-beta*z"}})~")},
            {"initial", {{"x", -13.7636106821342}, {"y", -19.5787519424518}, {"z", 27}}},
            {"until", 1.5586522107161747},
            {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
            {"sensitivities", std::move(sensitivities)}};
  }
};

TEST_F(Sensitivities, OfLorenzAreThoseThatArePublished) {
  const Json made = answer(lorenz(by({"/problem/sigma", "/problem/beta"})));
  const Json& found = made["sensitivities"];
  EXPECT_EQ(found["rows"], Json({"x", "y", "z"}));
  const double truth[3][2] = {{-.912802195703595, -28.2268059307864},
                              {-.130905810340090, 18.1841834628624},
                              {1.67609907947195, 116.876988007583}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(found["final"][i][k], truth[i][k], 2e-10) << i << k;
  EXPECT_LT(found["uncertainty"], 1e-11);
}

TEST_F(Sensitivities, OfSecondOrderOfLorenzAreThoseThatArePublished) {
  const Json made = answer(lorenz({{"by", {"/problem/sigma", "/problem/beta"}}, {"order", 2}}));
  const Json& second = made["sensitivities"]["second"];
  EXPECT_EQ(second["pairs"], Json::parse("[[0,0],[0,1],[1,1]]"));
  const double truth[3][3] = {{.19614393652649, -2.45466501786646, 608.714526721829},
                              {.361143595741667, 14.0187669688223, 847.488020397782},
                              {-.119613270510496, 22.5897033575196, -1250.71254195741}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(second["final"][i][k], truth[i][k], 1e-11 * std::max(1.0, std::abs(truth[i][k]))) << i << k;
  EXPECT_LT(made["sensitivities"]["uncertainty"], 1e-11);
}

// Where the start is in velocities the momenta have second derivatives, too.
TEST_F(Sensitivities, OfSecondOrderAreDifferencesOfTheFirst) {
  const Json problem = custom(R"~({"variables":["a"],"parameters":{"c":2},"lagrangian":"va^2/2*(c^2+cos(a)) - a^2"})~");
  Json request{{"problem", problem},
               {"initial", {{"a", 0.5}, {"va", 0.4}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 2},
               {"sensitivities", {{"by", {"/initial/a", "/initial/va", "/problem/c"}}, {"order", 2}}}};
  const Json found = answer(request)["sensitivities"];
  request["sensitivities"]["order"] = 1;
  constexpr double h = 1e-4;
  for (std::size_t pair = 0; pair < found["second"]["pairs"].size(); ++pair) {
    const std::size_t a = found["second"]["pairs"][pair][0], b = found["second"]["pairs"][pair][1];
    const std::string pointer = found["by"][b];
    Json up = request, down = request;
    const Json::json_pointer place(pointer);
    const double value = b == 2 ? 2 : request[place].get<double>();
    up[place] = value + h;
    down[place] = value - h;
    const Json above = answer(up)["sensitivities"]["final"], below = answer(down)["sensitivities"]["final"];
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(found["second"]["final"][i][pair], (above[i][a].get<double>() - below[i][a].get<double>()) / (2 * h),
                  1e-6)
          << i << pair;
  }
}

// A ball from the height H that keeps the part r of its speed: after the first bounce at t₁ = √(2H), x = r√(2H)(t − t₁)
// − (t − t₁)²/2.
TEST_F(Sensitivities, GoThroughEventsThatAct) {
  const double height = 1, r = 0.8, first = std::sqrt(2 * height), t = 2.5, later = t - first;
  Json request{
      {"problem", custom(R"~({"variables":["x"],"parameters":{"r":0.8,"floor":0},"potential":"x"})~")},
      {"initial", {{"x", height}}},
      {"scheme", "taylor"},
      {"until", t},
      {"events", {{{"name", "floor"}, {"expression", "x - floor"}, {"direction", "down"}, {"set", {{"vx", "-r*vx"}}}}}},
      {"sensitivities", by({"/initial/x", "/problem/r", "/problem/floor"})}};
  for (const char* scheme : {"taylor", "dormand_prince_5", "leapfrog"}) {
    request["scheme"] = scheme;
    const Json found = answer(request)["sensitivities"];
    ASSERT_TRUE(found["final"].is_array()) << found;
    const double by_height = (r * later - r * first + later) / first;
    EXPECT_NEAR(found["final"][0][0], by_height, 1e-12) << scheme;
    EXPECT_NEAR(found["final"][0][1], first * later, 1e-12) << scheme;
    EXPECT_NEAR(found["final"][0][2], 1 - by_height, 1e-12) << scheme << ": as if all were lower";
    EXPECT_NEAR(found["events"][0]["t"][0], 1 / first, 1e-12) << scheme;
  }
  // Many bounces, against differences of runs; also where the last act ends the run.
  request["scheme"] = {{"id", "taylor"}, {"tolerance", 1e-15}};
  request["until"] = 9;
  expect_differences(request, 1e-7);
  request["events"][0]["most"] = 3;
  expect_differences(request, 1e-7);
}

// Every problem of the catalogue, by the whole start and by every parameter.
TEST_F(Sensitivities, OfEveryProblemAreDifferencesOfRuns) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    SCOPED_TRACE(card.id);
    const double start = card.id == "lane_emden" ? 0.5 : 0;
    Json request{{"problem", card.id},
                 {"initial", {{"t", start}}},
                 {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                 {"until", start + std::min(1.0, 0.1 * card.span)},
                 {"record", {{"every", 0}}},
                 {"sensitivities", by("initial")}};
    if (card.id == "lane_emden") request["initial"].update({{"q", 0.95}, {"p", -0.04}});
    expect_differences(request, 1e-7);
    Json pointers = Json::array();
    for (const ParameterCard& parameter : card.parameters)
      if (parameter.kind == Kind::number && parameter.value > parameter.range.low &&
          parameter.value < parameter.range.high)
        pointers.push_back("/problem/" + parameter.name);
    if (pointers.empty()) continue;
    request["sensitivities"] = by(pointers);
    expect_differences(request, 1e-7);
  }
}

TEST_F(Sensitivities, OfEveryFormAsText) {
  for (
      const char* scene :
      {R"~({"variables":["x"],"parameters":{"c":0.2,"m":1.5},"potential":"x^4/4","masses":{"x":"m"},"damping":"c/(1+t^2)"})~",
       R"~({"variables":["x"],"parameters":{"c":0.3},"potential":"x^2/2","action_curvature":"c","offset":"0.1"})~",
       R"~({"variables":["x"],"parameters":{"c":0.2},"hamiltonian":"px^2/2 + x^2/2 + 0.1*x*px + c*s*x"})~",
       R"~({"variables":["a","b"],"parameters":{"c":2},"lagrangian":"va^2/2*(c+cos(b)) + vb^2/2 - a^2 - b^2/3"})~",
       R"~({"variables":["a"],"parameters":{"c":0.2},"lagrangian":"va^2/2 + c*va*a^2*sin(t) - a^2/2 - 0.1*s*a"})~",
       R"~({"variables":["x"],"parameters":{"c":0.2},"potential":"x^4/4","forces":{"x":"sin(t) - c*vx^3"}})~",
       R"~({"variables":["x"],"parameters":{"c":0.2},"hamiltonian":"px^2/3 + x^2/2","forces":{"x":"-c*px*x^2"}})~",
       R"~({"variables":["a","b"],"parameters":{"c":0.2},"dissipation":"c*(vb-va)^2/2",
             "lagrangian":"va^2/2*(2+cos(b)) + vb^2/2 - a^2 - b^2/3","forces":{"a":"-0.1*va*vb^2"}})~",
       R"~({"variables":["x","y"],"parameters":{"c":0.2},"equations":{"x":"y - 0.1*x","y":"-x + c*sin(t)"}})~",
       R"~({"variables":["q[24]"],"parameters":{"c":0.5},
             "hamiltonian":"sum(i=1..24, p[i]^2/2 + q[i]^4/4) + c*sum(i=1..23, (q[i+1]-q[i])^2)"})~"}) {
    SCOPED_TRACE(scene);
    const Json problem = custom(scene);
    const std::string first = problem["variables"][0], name = first == "q[24]" ? "q[1]" : first;
    for (const double end : {2.0, -2.0}) {
      Json request{{"problem", problem},
                   {"initial", {{name, 0.8}, {"t", 0.1}}},
                   {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                   {"until", end},
                   {"sensitivities", by({"/initial/" + name, "/problem/c", "/initial/t"})}};
      expect_differences(request, 1e-8);
      if (!problem.contains("lagrangian")) continue;
      request["initial"]["va"] = 0.7;
      request["sensitivities"] = by({"/initial/a", "/initial/va", "/problem/c"});
      expect_differences(request, 1e-8);
    }
  }
}

// The map of a conservative scene is symplectic; with damping α it scales the form by e^{−αt}; in a contact scene it is
// a contact map.
TEST_F(Sensitivities, OfTheWholeStartKeepTheStructure) {
  Json request{{"problem", "double_pendulum"}, {"scheme", "taylor"}, {"until", 20}, {"sensitivities", by("initial")}};
  Json found = answer(request)["sensitivities"];
  EXPECT_EQ(found["by"], Json({"/initial/theta1", "/initial/theta2", "/initial/p1", "/initial/p2"}));
  EXPECT_EQ(found["structure"]["kind"], "symplectic");
  double growth = 1;
  for (const auto& row : found["final"])
    for (const double slope : row) growth = std::max(growth, std::abs(slope));
  EXPECT_LT(found["structure"]["max_defect"], 1e-12 * growth * growth);

  request["problem"] = custom(R"~({"variables":["x"],"potential":"1-cos(x)","damping":0.1})~");
  found = answer(request)["sensitivities"];
  EXPECT_EQ(found["structure"]["kind"], "contact");
  EXPECT_NEAR(found["structure"]["factor"], std::exp(-2.0), 1e-11);

  request["problem"] = custom(R"~({"variables":["x"],"hamiltonian":"px^2/2 + 1 - cos(x) + 0.1*s + 0.05*s*x*px"})~");
  request["initial"] = {{"x", 1}};
  found = answer(request)["sensitivities"];
  EXPECT_EQ(found["rows"], Json({"x", "px", "s"}));
  EXPECT_EQ(found["structure"]["kind"], "contact");
  EXPECT_LT(found["structure"]["max_defect"], 1e-10);

  request["problem"] = custom(R"~({"variables":["x"],"potential":"1-cos(x)","forces":{"x":"-0.1*vx"}})~");
  found = answer(request)["sensitivities"];
  EXPECT_EQ(found["structure"]["kind"], "none") << "forces keep no form, as far as is known";
  EXPECT_NEAR(found["structure"]["factor"], std::exp(-2.0), 1e-11);
}

// The period of a pendulum by its amplitude, as the time of an event: dT/dA of 4 K(sin A/2)/ω.
TEST_F(Sensitivities, OfTimesOfEvents) {
  const double amplitude = 1.2, k = std::sin(amplitude / 2);
  const Json problem = custom(R"~({"variables":["phi"],"parameters":{"g":1},"lagrangian":"vphi^2/2 + g*cos(phi)"})~");
  Json request{{"problem", problem},
               {"initial", {{"phi", amplitude}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 20},
               {"events", {{{"name", "down"}, {"expression", "phi - 0*g"}, {"direction", "down"}, {"stop", false}}}},
               {"sensitivities", by({"/initial/phi", "/problem/g"})}};
  const Json made = answer(request);
  const Json& events = made["sensitivities"]["events"];
  ASSERT_EQ(events.size(), made["events"].size());
  ASSERT_GE(events.size(), 2U);
  const double quarter = std::comp_ellint_1(k);
  EXPECT_NEAR(made["events"][0]["t"], quarter, 1e-12);
  // dK/dk = E/(k (1 − k²)) − K/k
  const double by_amplitude = (std::comp_ellint_2(k) / (k * (1 - k * k)) - quarter / k) * std::cos(amplitude / 2) / 2;
  EXPECT_NEAR(events[0]["t"][0], by_amplitude, 1e-11);
  EXPECT_NEAR(events[0]["t"][1], -quarter / 2, 1e-11) << "T ~ g^(−1/2)";
  EXPECT_NEAR(events[1]["t"][0], 5 * by_amplitude, 1e-10);
  // Where an event ends the run the end moves with the event.
  request["events"][0]["stop"] = true;
  request["events"][0]["expression"] = "phi - 0.3*g";
  expect_differences(request, 1e-8);
  EXPECT_NEAR(answer(request)["sensitivities"]["final"][0][1], 0.3, 1e-12);
}

TEST_F(Sensitivities, AtSamplesInEveryForm) {
  Json request{
      {"problem", "kepler"},   {"scheme", "taylor"},         {"until", 5},
      {"columns", {"x", "y"}}, {"record", {{"samples", 4}}}, {"sensitivities", by({"/initial/x", "/problem/mu"})}};
  Json plain = request;
  plain.erase("sensitivities");
  request["sensitivities"]["at"] = "samples";
  for (const char* record : {R"({"samples":4})", R"({"times":[0,1,2.5]})", R"({"every":3})", R"({"curve":5})"}) {
    request["record"] = plain["record"] = Json::parse(record);
    const Json made = answer(request), without = answer(plain);
    EXPECT_EQ(made["trajectory"], without["trajectory"]) << record << ": not by a bit";
    EXPECT_EQ(made["final"], without["final"]);
    const Json& found = made["sensitivities"];
    ASSERT_EQ(found["samples"].size(), made["trajectory"]["x"].size()) << record;
    EXPECT_EQ(found["samples"][0], Json::parse("[[1.0,0.0],[0.0,0.0],[0.0,0.0],[0.0,0.0]]"));
  }
  request["record"] = {{"samples", 4}};
  const Json found = answer(request)["sensitivities"];
  EXPECT_EQ(found["samples"][3], found["final"]);

  request["limits"] = {{"samples", 30}};
  EXPECT_TRUE(answer(request)["sensitivities"]["final"].is_null()) << "4 samples of 4 by 2 numbers";
  request.erase("limits");

  const Reply table = ask(port(), post("/v1/simulate", request.dump(), "Accept: text/csv\r\n"));
  std::istringstream lines(table.body);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,d(x)/d(x),d(x)/d(mu),d(y)/d(x),d(y)/d(mu),d(px)/d(x),d(px)/d(mu),d(py)/d(x),d(py)/d(mu)");
  for (std::size_t row = 0; row < 4; ++row) {
    std::getline(lines, line);
    std::istringstream cells(line);
    std::string cell;
    for (int k = 0; k < 2; ++k) std::getline(cells, cell, ',');
    for (std::size_t k = 0; k < 8; ++k) {
      std::getline(cells, cell, ',');
      EXPECT_EQ(std::stod(cell), found["samples"][row][k / 2][k % 2].get<double>());
    }
  }
  const Reply packed = ask(port(), post("/v1/simulate", request.dump(), "Accept: application/cbor\r\n"));
  EXPECT_EQ(Json::from_cbor(packed.body, true, true, Json::cbor_tag_handler_t::ignore)["sensitivities"], found);
  const Reply streamed = ask(port(), post("/v1/simulate", request.dump(), "Accept: application/x-ndjson\r\n"));
  std::istringstream all(streamed.body);
  Json first, last;
  while (std::getline(all, line)) (first.is_null() ? first : last) = Json::parse(line);
  EXPECT_EQ(last["sensitivities"], found);
  EXPECT_EQ(first["sensitivities"]["by"], request["sensitivities"]["by"]) << "what was asked for is echoed";
}

// Velocities are held fixed where the start has velocities, momenta where it has momenta; an echo says which.
TEST_F(Sensitivities, HoldWhatTheStartSays) {
  const Json problem = custom(R"~({"variables":["x"],"parameters":{"m":2},"lagrangian":"m*vx^2/2 - x^2/2"})~");
  Json request{{"problem", problem},
               {"initial", {{"x", 1}, {"vx", 1}}},
               {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
               {"until", 3},
               {"sensitivities", by({"/problem/parameters/m"})}};
  const double w = std::sqrt(0.5), t = 3;  // x = cos wt + (v/w) sin wt
  const double by_w = -t * std::sin(w * t) + t * std::cos(w * t) / w - std::sin(w * t) / (w * w);
  Json found = answer(request)["sensitivities"];
  EXPECT_EQ(found["holds"], "velocities");
  EXPECT_EQ(found["by"], Json({"/problem/m"}));
  EXPECT_NEAR(found["final"][0][0], -w / 4 * by_w, 1e-13);
  request["initial"] = {{"x", 1}, {"px", 2}};
  found = answer(request)["sensitivities"];
  EXPECT_EQ(found["holds"], "momenta");
  EXPECT_NEAR(found["final"][0][0], -w / 4 * by_w - std::sin(w * t) / w / 2, 1e-13) << "v = p/m";
  request["sensitivities"]["holds"] = "velocities";
  EXPECT_NEAR(answer(request)["sensitivities"]["final"][0][0], -w / 4 * by_w, 1e-13);
}

TEST_F(Sensitivities, OfListsAreNamedFromZeroOrByTheirElements) {
  const Json problem = custom(R"~({"variables":["x[3]"],"parameters":{"k":[1,2,3]},
      "potential":"sum(i=1..3, k[i]*x[i]^2/2)"})~");
  const Json found =
      answer({{"problem", problem},
              {"initial", {{"x", {1, 1, 1}}}},
              {"scheme", "taylor"},
              {"until", 2},
              {"sensitivities", by({"/problem/k/2", "/initial/x/1", "/initial/x[3]"})}})["sensitivities"];
  EXPECT_EQ(found["by"], Json({"/problem/k[3]", "/initial/x[2]", "/initial/x[3]"}));
  const double w = std::sqrt(3.0);
  EXPECT_NEAR(found["final"][2][0], -2 * std::sin(2 * w) / (2 * w), 1e-11);
  EXPECT_NEAR(found["final"][1][1], std::cos(2 * std::sqrt(2.0)), 1e-11);
  EXPECT_NEAR(found["final"][2][2], std::cos(2 * w), 1e-11);
}

TEST_F(Sensitivities, RefuseWhatTheyCannotSay) {
  Json request{{"problem", "kepler"}, {"scheme", "taylor"}, {"until", 1}};
  const auto refused = [&](const Json& asked, const std::string& pointer, std::string_view words) {
    request["sensitivities"] = asked;
    const Json fault = fault_of(request);
    EXPECT_EQ(fault["pointer"], pointer) << fault;
    EXPECT_TRUE(says(fault, words)) << fault;
  };
  refused({{"by", {"/problem/nu"}}}, "/sensitivities/by/0", "did you mean");
  refused({{"by", {"x"}}}, "/sensitivities/by/0", "did you mean \"/initial/x\"?");
  refused({{"by", {"/scheme/tolerance"}}}, "/sensitivities/by/0", "setting of the scheme");
  refused({{"by", {"/initial/x", "/initial/x"}}}, "/sensitivities/by/1", "twice");
  refused({{"by", {3}}}, "/sensitivities/by/0", "JSON pointer");
  refused({{"by", Json::array()}}, "/sensitivities/by", "list");
  refused({{"by", std::vector<std::string>(65, "/initial/x")}}, "/sensitivities/by", "65");
  refused(Json::object(), "/sensitivities/by", "required");
  refused({{"by", "initial"}, {"order", 3}}, "/sensitivities/order", "");
  refused({{"by", "initial"}, {"of", "map"}}, "/sensitivities/of", "");
  refused({{"by", "initial"}, {"holds", "velocities"}}, "/sensitivities/holds", "");
  refused({{"by", "initial"}, {"until", 1}}, "/sensitivities/until", "");
  request["record"] = {{"every", 0}};
  refused({{"by", "initial"}, {"at", "samples"}}, "/sensitivities/at", "no samples");
  request = {{"problem", "scalar_field_cosmology"}, {"scheme", "taylor"}, {"until", 1}};
  for (const auto& problem : problem_list())
    for (const ParameterCard& parameter : problem->card().parameters) {
      if (parameter.kind == Kind::number) continue;
      request["problem"] = problem->card().id;
      refused({{"by", {"/problem/" + parameter.name}}}, "/sensitivities/by/0", "there is no derivative by it");
    }
  request = {{"problem", custom(R"~({"variables":["x"],"lagrangian":"vx^2/2 - x^2/2"})~")},
             {"initial", {{"vx", 1}}},
             {"scheme", "taylor"},
             {"until", 1}};
  refused({{"by", {"/initial/px"}}}, "/sensitivities/by/0", "velocities are held");
  Json forced = {{"problem", custom(R"~({"variables":["x"],"potential":"x^2/2","forces":{"x":"-vx^3"}})~")},
                 {"scheme", "leapfrog"},
                 {"until", 1},
                 {"sensitivities", {{"by", "initial"}, {"of", "scheme"}}}};
  EXPECT_TRUE(says(fault_of(forced), "map of leapfrog on this scene there is no derivative"));
  refused({{"by", {"/initial/t"}}, {"order", 2}}, "/sensitivities/by/0", "second");
  request["events"] = {{{"name", "e"}, {"expression", "x"}, {"set", {{"vx", "-vx"}}}}};
  request["scheme"] = "leapfrog";
  refused({{"by", "initial"}, {"of", "scheme"}}, "/sensitivities", "events that act");
}

}  // namespace
}  // namespace least::server::test

// Sections of single runs: zeros of an expression, or times of a period, in every form of an answer.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

constexpr double turn = 2 * std::numbers::pi;

class Sections : public Asking {
 protected:
  static Json fault(const Json& request) {
    const Reply made = reply(request);
    EXPECT_EQ(made.status, 422) << made.body;
    return Json::parse(made.body)["errors"][0];
  }
};

Json oscillation(const char* scheme) {
  return {{"problem", "harmonic_oscillator"}, {"scheme", scheme},
          {"initial", {{"q", 1}, {"p", 0}}},  {"until", 40},
          {"record", {{"every", 0}}},         {"section", {{"expression", "q"}, {"direction", "up"}}}};
}

TEST_F(Sections, AreWhereTheMotionPasses) {
  const Json made = answer(oscillation("taylor"));
  const Json& points = made["section"];
  EXPECT_EQ(made["trajectory"]["q"], Json::array());
  EXPECT_EQ(points["expression"], "q");
  EXPECT_EQ(points["crossing"], Json({0, 1, 2, 3, 4, 5}));
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(points["t"][k], (0.75 + static_cast<double>(k)) * turn, 1e-12);
    EXPECT_NEAR(points["q"][k], 0, 1e-13);
    EXPECT_NEAR(points["p"][k], 1, 1e-13);
  }
  EXPECT_EQ(points.size(), 6u) << "expression, direction, crossing, t, q, p";
  EXPECT_TRUE(made["events"].empty());
  EXPECT_FALSE(made.contains("events_asked"));
}

// With every kind of steps a run with a section equals the run without it, and the points are those of an event.
TEST_F(Sections, ChangeNothing) {
  for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5", "runge_kutta_4", "time_transformed"}) {
    Json request = {{"problem", "kepler"},
                    {"scheme", scheme},
                    {"until", 30},
                    {"columns", {"x", "energy", "step_size"}},
                    {"record", {{"samples", 7}}},
                    {"diagnostics", {"energy"}}};
    Json watched = request, looked = request;
    const Json plain = answer(request);
    watched["events"] = {{{"name", "apsis"}, {"expression", "x*px + y*py"}, {"direction", "down"}}};
    looked["section"] = {{"expression", "x*px + y*py"}, {"direction", "down"}};
    const Json events = answer(watched)["events"], seen = answer(looked);
    for (const char* part : {"trajectory", "final", "diagnostics"}) EXPECT_EQ(seen[part], plain[part]) << scheme;
    EXPECT_EQ(seen["cost"]["force_evaluations"], plain["cost"]["force_evaluations"]) << scheme;
    const Json& points = seen["section"];
    ASSERT_EQ(points["t"].size(), events.size()) << scheme;
    ASSERT_GE(events.size(), 1u) << scheme;
    for (std::size_t k = 0; k < events.size(); ++k) {
      EXPECT_EQ(points["t"][k], events[k]["t"]) << scheme;
      EXPECT_EQ(points["x"][k], events[k]["state"]["x"]) << scheme;
      EXPECT_NEAR(points["energy"][k], plain["trajectory"]["energy"][0], 1e-2) << scheme;
    }
  }
}

// A section beside events: its plane may be that of an event that acts, or ends the run.
TEST_F(Sections, StandBesideEvents) {
  Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", "x"}}},
                  {"initial", {{"x", 1}}},
                  {"until", 8},
                  {"columns", {"x", "px"}},
                  {"section", {{"expression", "x"}}}};
  request["events"] = {
      {{"name", "floor"}, {"expression", "x"}, {"direction", "down"}, {"set", {{"vx", "-vx"}}}, {"most", 2}}};
  for (const char* scheme : {"taylor", "leapfrog"}) {
    request["scheme"] = scheme;
    const Json made = answer(request);
    EXPECT_EQ(made["end"]["event"], "floor");
    EXPECT_EQ(made["events_asked"].size(), 1u);
    ASSERT_EQ(made["section"]["t"].size(), 2u) << made["section"];
    EXPECT_NEAR(made["section"]["t"][1], 3 * std::sqrt(2), 1e-12);
    EXPECT_NEAR(made["section"]["px"][1], -std::sqrt(2), 1e-12) << "before the act";
    Json again;
    for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "section", "limits", "norm"})
      again[key] = made[key];
    again["events"] = made["events_asked"];
    EXPECT_EQ(answer(again)["section"], made["section"]) << "the answer's members are a request for it";
  }

  Json many = oscillation("leapfrog");
  many["events"] = Json::array();
  for (int i = 0; i < 16; ++i)
    many["events"].push_back({{"name", "e" + std::to_string(i)}, {"expression", "p - 0.01*" + std::to_string(i)}});
  const Json all = answer(many);
  EXPECT_EQ(all["section"]["t"].size(), 6u) << "as many events as without it";
  EXPECT_NE(all["events"].dump().find("\"e15\""), std::string::npos);
}

// Stroboscopic points are the states of a run that asks for these times.
TEST_F(Sections, AreStroboscopic) {
  for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5"}) {
    Json request = oscillation(scheme);
    request["section"] = {{"period", 2.5}, {"phase", 11}};
    request["record"] = {{"samples", 9}};
    const Json points = answer(request)["section"];
    request.erase("section");
    request["record"] = {{"times", points["t"]}};
    const Json asked = answer(request)["trajectory"];
    EXPECT_EQ(points["t"][0], 1.0);
    EXPECT_EQ(points["t"].size(), 16u);
    EXPECT_EQ(points["t"], asked["t"]) << scheme;
    EXPECT_EQ(points["q"], asked["q"]) << scheme;
    EXPECT_EQ(points["p"], asked["p"]) << scheme;
  }
  Json request = oscillation("leapfrog");
  request["until"] = {{"steps", 100}};
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.125}};
  request["section"] = {{"period", 12.5}};
  EXPECT_EQ(answer(request)["section"]["t"], Json::array({12.5})) << "the end is looked at, the start is not";
}

TEST_F(Sections, KnowEveryColumn) {
  Json request = oscillation("dormand_prince_5");
  request["columns"] = {"t", "error", "step_size", {{"name", "r"}, {"expression", "sqrt(q^2 + p^2)"}}};
  const Json made = answer(request);
  ASSERT_EQ(made["section"]["error"].size(), 6u);
  for (const Json& error : made["section"]["error"]) EXPECT_LT(error, 1e-4);
  for (const Json& r : made["section"]["r"]) EXPECT_NEAR(r, 1, 1e-4);
  EXPECT_GT(made["section"]["step_size"][0], 0);
  request["scheme"] = {{"id", "auto"}, {"accuracy", 1e-9}};
  EXPECT_NEAR(answer(request)["section"]["t"][5], 5.75 * turn, 1e-7);
}

TEST_F(Sections, GoBackward) {
  Json request = oscillation("taylor");
  request["initial"] = {{"q", 0.6}, {"p", 0.8}};
  request["until"] = -20;
  const Json made = answer(request);  // along the run q rises where p < 0
  const double first = -std::atan2(0.6, 0.8) - turn / 2;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(made["section"]["t"][k], first - static_cast<double>(k) * turn, 1e-12);
    EXPECT_NEAR(made["section"]["p"][k], -1, 1e-12);
  }
  request["section"] = {{"period", 4}, {"phase", 1}};
  request["columns"] = {"p", {{"name", "now"}, {"expression", "t"}}};
  const Json times = answer(request)["section"];
  EXPECT_EQ(times["phase"], 1);
  EXPECT_EQ(times["t"], Json({-3, -7, -11, -15, -19}));
  EXPECT_EQ(times["now"], times["t"]);
  EXPECT_NEAR(times["p"][0], 0.8 * std::cos(3) + 0.6 * std::sin(3), 1e-12);
  request["section"] = times;
  EXPECT_EQ(answer(request)["section"], times);
}

TEST_F(Sections, StandInEveryForm) {
  for (const bool beside : {false, true}) {
    Json request = oscillation("leapfrog");
    request["until"] = 4000;
    request["scheme"] = {{"id", "leapfrog"}, {"step", 0.01}};
    if (beside) request["record"] = {{"samples", 3}};
    const Json whole = answer(request);
    const Json& points = whole["section"];
    ASSERT_EQ(points["t"].size(), 636u);

    Json joined = {{"crossing", Json::array()}, {"t", Json::array()}, {"q", Json::array()}, {"p", Json::array()}};
    std::istringstream stream(reply(request, "/v1/simulate", "application/x-ndjson").body);
    for (std::string text; std::getline(stream, text);) {
      const Json line = Json::parse(text);
      if (line["kind"] == "head") {
        EXPECT_EQ(line["section"], request["section"]);
      }
      if (line["kind"] != "section") continue;
      for (auto& [name, list] : joined.items())
        for (const Json& value : line["section"][name]) list.push_back(value);
    }
    for (const auto& [name, list] : joined.items()) EXPECT_EQ(list, points[name]) << name;

    Json binary = Json::from_cbor(reply(request, "/v1/simulate", "application/cbor").body, true, true,
                                  Json::cbor_tag_handler_t::store)["section"];
    EXPECT_EQ(binary["crossing"], points["crossing"]);
    for (const char* column : {"t", "q", "p"}) {
      const auto& bytes = binary[column].get_binary();
      std::vector<double> numbers(bytes.size() / sizeof(double));
      std::memcpy(numbers.data(), bytes.data(), bytes.size());
      EXPECT_EQ(Json(numbers), points[column]) << column;
    }

    const Reply table = reply(request, "/v1/simulate", "text/csv");
    std::istringstream rows(table.body);
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, beside ? "t,q,p" : "crossing,t,q,p");
    if (!beside) {
      std::getline(rows, row);
      std::getline(rows, row);
      EXPECT_EQ(row, "1," + points["t"][1].dump() + "," + points["q"][1].dump() + "," + points["p"][1].dump());
      continue;
    }
    EXPECT_EQ(table.fields.at("leastaction-section"), R"({"omitted":true})");
    EXPECT_EQ(table.body.find('#'), std::string::npos);
  }
}

// A large section is sent in slices.
TEST_F(Sections, MayBeLong) {
  Json request = oscillation("leapfrog");
  request["section"] = {{"period", 0.001}};
  const Json points = answer(request)["section"];
  ASSERT_EQ(points["t"].size(), 40000u);
  for (std::size_t k = 0; k < 40000; k += 37) {
    ASSERT_EQ(points["crossing"][k], k);
    ASSERT_NEAR(points["t"][k], 0.001 * static_cast<double>(k + 1), 1e-12);
  }
  request["limits"] = {{"samples", 300}};
  const Json cut = answer(request);
  EXPECT_EQ(cut["section"]["q"].size(), 100u) << "times t, q and p";
  EXPECT_EQ(cut["section"]["q"][99], points["q"][99]);
  EXPECT_NE(cut["warnings"].dump().find("section_truncated"), std::string::npos);
}

// Points of a step that is undone are removed.
TEST_F(Sections, EndWhereTheRunEnds) {
  Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"equations", {{"x", "x^2"}}}}},
                  {"initial", {{"x", 1}}},
                  {"scheme", "taylor"},
                  {"until", 3},
                  {"section", {{"period", 0.3}}}};
  const Json made = answer(request);  // x = 1/(1 − t)
  EXPECT_EQ(made["status"], "stopped");
  EXPECT_EQ(made["section"]["t"], Json({0.3, 0.6, 0.8999999999999999}));
  request["section"] = {{"expression", "x - 2"}};
  EXPECT_NEAR(answer(request)["section"]["t"][0], 0.5, 1e-12);
  request["events"] = {{{"name", "half"}, {"expression", "x - 1.5"}, {"stop", true}}};
  EXPECT_EQ(answer(request)["section"]["t"], Json::array());
}

// The same points as in an ensemble of one member.
TEST_F(Sections, AreThoseOfAnEnsemble) {
  for (const Json& section : {Json{{"expression", "x*px + y*py"}, {"direction", "up"}}, Json{{"period", 1.25}}}) {
    Json request = {{"problem", "kepler"}, {"scheme", "leapfrog"}, {"until", 40}, {"section", section}};
    request["columns"] = {"x", "py"};
    const Json alone = answer(request)["section"];
    request["members"] = {{"count", 1}};
    request["keep"] = {"section"};
    const Json together = answer(request, "/v1/ensemble")["section"];
    ASSERT_GE(alone["t"].size(), 1u);
    for (const char* list : {"crossing", "t", "x", "py"}) EXPECT_EQ(alone[list], together[list]) << section;
  }
}

TEST_F(Sections, AreRefusedByName) {
  const auto with = [](const char* section) {
    Json request = oscillation("leapfrog");
    request["section"] = Json::parse(section);
    return request;
  };
  EXPECT_EQ(fault(with(R"({})"))["pointer"], "/section");
  EXPECT_EQ(fault(with(R"({"period":1,"expression":"q"})"))["detail"], "must hold either period or expression");
  EXPECT_EQ(fault(with(R"({"period":-1})"))["pointer"], "/section/period");
  EXPECT_EQ(fault(with(R"({"period":1e-12})"))["pointer"], "/section/period");
  EXPECT_EQ(fault(with(R"({"period":1,"direction":"up"})"))["pointer"], "/section/direction");
  EXPECT_EQ(fault(with(R"({"expression":"q*"})"))["pointer"], "/section/expression");
  EXPECT_EQ(fault(with(R"({"expression":"qq"})"))["detail"], "unknown name qq");
  EXPECT_EQ(fault(with(R"({"expression":"q","directon":"up"})"))["pointer"], "/section/directon");
  Json named = with(R"({"period":1})");
  named["columns"] = {{{"name", "crossing"}, {"expression", "q"}}};
  EXPECT_EQ(fault(named)["pointer"], "/section");
}

}  // namespace
}  // namespace least::server::test

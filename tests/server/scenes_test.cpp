// The problems of the catalogue that are files in core/scenes.
#include <cmath>
#include <complex>
#include <fstream>
#include <set>
#include <sstream>

#include "server/decode/scene_files.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Scenes : public Asking {
 protected:
  static std::vector<Json> cards() {
    std::vector<Json> all;
    for (const TextProblem& one : text_problems()) all.push_back(card_of(one.mechanics->card().id));
    return all;
  }
  static Json card_of(const std::string& id) {
    return Json::parse(ask(port(), "GET /v1/problems/" + id + " HTTP/1.1\r\nHost: localhost\r\n\r\n").body);
  }
  static bool has(const std::string& id) {
    return std::ranges::any_of(text_problems(), [&](const auto& one) { return one.mechanics->card().id == id; });
  }
  static Json named(const std::string& id, const Json& preset = {}) {
    Json problem{{"id", id}};
    if (!preset.is_null()) problem["preset"] = preset["name"];
    return problem;
  }
  /// until_of() returns the end of the preset that a problem names, or that of the card.
  static Json until_of(const Json& card, const Json& problem) {
    for (const Json& preset : card["presets"])
      if (preset["name"] == problem.value("preset", "")) return preset["until"];
    return card["until"];
  }
  /// problems_of() returns the problem without a preset, and with each of its presets.
  static std::vector<Json> problems_of(const Json& card) {
    std::vector<Json> all{named(card["id"])};
    for (const Json& preset : card["presets"]) all.push_back(named(card["id"], preset));
    return all;
  }
};

#define NEEDS_SCENE(id) \
  if (!has(id)) GTEST_SKIP() << "this build leaves the form of " << (id) << " out"

TEST_F(Scenes, AreWholeCards) {
  const bool all_forms = std::string_view(LEAST_LEFT_OUT).find_first_not_of(' ') == std::string_view::npos;
  EXPECT_GE(text_problems().size(), all_forms ? scene_files().size() : 5);
  std::set<std::string> ids;
  const Json list = Json::parse(ask(port(), "GET /v1/problems HTTP/1.1\r\nHost: localhost\r\n\r\n").body);
  for (const Json& link : list["problems"])
    EXPECT_TRUE(ids.insert(link["id"]).second) << link["id"] << " is there twice";
  for (const Json& card : cards()) {
    const std::string id = card["id"];
    EXPECT_TRUE(ids.contains(id)) << id;
    for (const char* key : {"title", "summary", "formula"}) EXPECT_FALSE(card[key].get<std::string>().empty()) << id;
    EXPECT_FALSE(card["references"].empty()) << id;
    EXPECT_GT(card["until"]["t"], 0) << id;
    EXPECT_GT(card["suggested"]["step"], 0) << id;
    EXPECT_GE(card["schemes"].size(), 6U) << id;
    for (const Json& variable : card["variables"])
      EXPECT_NE(variable["doc"], "coordinate") << id << ": `about` says nothing of " << variable["name"];
    for (const Json& parameter : card["parameters"])
      EXPECT_NE(parameter["doc"], "parameter") << id << ": `about` says nothing of " << parameter["name"];
    for (const Json& preset : card["presets"]) EXPECT_FALSE(preset["doc"].get<std::string>().empty()) << id;
  }
}

TEST_F(Scenes, KeepWhatTheirCardsSay) {
  std::size_t kept = 0;
  for (const Json& card : cards())
    for (const Json& problem : problems_of(card)) {
      Json request{{"problem", problem}, {"scheme", "taylor"}, {"record", {{"every", 0}}}};
      request["diagnostics"] = Json::array();
      for (const Json& one : card["diagnostics"])
        if (one == "energy" || one == "momenta") request["diagnostics"].push_back(one);
      const Json run = answer(request);
      EXPECT_EQ(run["status"], "completed") << problem;
      EXPECT_EQ(run["until"], until_of(card, problem)) << problem;
      for (const Json& invariant : card["invariants"]) {
        const std::string name = invariant["name"];
        const bool acts = !run["events"].empty();
        if (acts && problem.value("preset", "") != "elastic") continue;  // a bounce takes energy
        const Json report = name == "energy" ? run["diagnostics"]["energy"] : run["diagnostics"]["momenta"][name];
        const double size = std::max(1e-30, std::abs(report["initial"].get<double>()));
        const double error = report["max_abs_error"];
        EXPECT_LT(error, 3e-10 * std::max(size, name == "energy" ? 0.0 : 1.0)) << problem << ' ' << name;
        ++kept;
      }
    }
  EXPECT_GT(kept, text_problems().size());
}

TEST_F(Scenes, RunByEveryScheme) {
  std::size_t pairs = 0;
  for (const Json& card : cards())
    for (const Json& scheme : card["schemes"]) {
      if (scheme == "auto") continue;
      // The steps follow the change of the force, and a constant force has none.
      if (scheme == "adaptive_verlet" && card["id"] == "bouncing_ball") continue;
      const Json run = answer({{"problem", card["id"]}, {"scheme", scheme}, {"until", {{"steps", 20}}}});
      EXPECT_EQ(run["status"], "completed") << card["id"] << ' ' << scheme << run["stop"];
      EXPECT_GE(run["trajectory"]["t"].size(), 20U) << card["id"] << scheme;
      ++pairs;
    }
  EXPECT_GE(pairs, 6 * text_problems().size());
}

TEST_F(Scenes, ClosedOrbitsClose) {
  const std::pair<const char*, double> scenes[] = {{"figure_eight", 2e-3}, {"restricted_three_body", 1e-8}};
  for (const auto& [id, most] : scenes) {
    if (!has(id)) continue;
    for (const Json& problem : problems_of(card_of(id))) {
      const Json run = answer(
          {{"problem", problem}, {"scheme", {{"id", "taylor"}, {"tolerance", 1e-14}}}, {"record", {{"every", 0}}}});
      for (const auto& [name, value] : run["final"].items()) {
        if (name == "t") continue;
        EXPECT_NEAR(value, run["initial"][name], most) << problem << name;
      }
    }
  }
}

// z = x + iy with z″ = −2iΩ′z′ − (g/l) z, Ω′ = Ω sin φ: two circular motions with w² = g/l + Ω′² in a frame that
// rotates backward.
TEST_F(Scenes, TurnThePlaneOfFoucaultsPendulum) {
  NEEDS_SCENE("foucault");
  for (const char* preset : {"", "paris", "equator"}) {
    Json problem{{"id", "foucault"}};
    if (*preset) problem["preset"] = preset;
    for (const Json& scheme :
         {Json{{"id", "taylor"}}, Json{{"id", "lifted_splitting"}, {"composition", "kahan_li_8"}}}) {
      const Json run = answer({{"problem", problem}, {"scheme", scheme}, {"until", {{"t", 300}}}});
      const Json& set = run["problem"];
      const double turn = set["omega"].get<double>() * std::sin(set["lat"].get<double>());
      const double w = std::sqrt(set["g"].get<double>() / set["l"].get<double>() + turn * turn), t = 300;
      const std::complex<double> i(0, 1),
          z = 3.0 * std::exp(-i * turn * t) * (std::cos(w * t) + i * turn / w * std::sin(w * t));
      EXPECT_NEAR(run["final"]["x"], z.real(), 1e-7) << preset << scheme;
      EXPECT_NEAR(run["final"]["y"], z.imag(), 1e-7) << preset << scheme;
    }
  }
}

// For weak friction cycles are circles with a/2 + 3 b r²/8 + 5 c r⁴/16 = 0: r = 1, which repels, and r = 2.
TEST_F(Scenes, SwingLienardsOscillatorOntoItsOuterCycle) {
  NEEDS_SCENE("lienard");
  const auto radius_from = [](double x) {
    const Json run =
        answer({{"problem", {{"id", "lienard"}, {"preset", "weak"}}}, {"initial", {{"x", x}}}, {"scheme", "taylor"}});
    return std::hypot(run["final"]["x"].get<double>(), run["final"]["y"].get<double>());
  };
  EXPECT_NEAR(radius_from(1.3), 2, 0.02);
  EXPECT_NEAR(radius_from(2.4), 2, 0.02);
  EXPECT_LT(radius_from(0.9), 0.2);
}

TEST_F(Scenes, EchoARequestThatGivesTheSameRun) {
  for (const Json& card : cards()) {
    const std::string scheme = card["schemes"].front();
    Json run = answer({{"problem", problems_of(card).back()}, {"scheme", scheme}, {"until", {{"steps", 7}}}});
    Json again{{"scheme", run["scheme"]}};
    for (const char* key : {"problem", "initial", "until", "record", "columns"}) again[key] = run[key];
    EXPECT_FALSE(run["problem"].contains("variables")) << card["id"];
    EXPECT_EQ(answer(again)["trajectory"], run["trajectory"]) << card["id"];
  }
}

// A user who wants to change more than parameters begins with the text in the card.
TEST_F(Scenes, SayTheTextThatTheyAre) {
  for (const Json& card : cards()) {
    const Json text = card["text"], scheme = card["schemes"].front();
    ASSERT_EQ(text.value("id", ""), "custom") << card["id"];
    const Json run = answer({{"problem", card["id"]}, {"scheme", scheme}, {"until", {{"steps", 7}}}});
    const Json same =
        answer({{"problem", text}, {"initial", run["initial"]}, {"scheme", run["scheme"]}, {"until", run["until"]}});
    EXPECT_EQ(same["final"], run["final"]) << card["id"] << same;
    EXPECT_EQ(text.value("views", Json()), card.value("views", Json())) << card["id"];
  }
}

TEST_F(Scenes, StartInVelocitiesBesideTheDefault) {
  NEEDS_SCENE("figure_eight");
  const Json request{{"problem", {{"id", "figure_eight"}, {"m", {1, 2, 3}}}},
                     {"initial", {{"vx[2]", 0.5}}},
                     {"scheme", "leapfrog"},
                     {"until", {{"steps", 1}}}};
  const Json plain = answer({{"problem", "figure_eight"}, {"scheme", "leapfrog"}, {"until", {{"steps", 1}}}});
  const Json run = answer(request);
  EXPECT_EQ(run["problem"]["m[2]"], 2);
  EXPECT_EQ(run["initial"]["px[2]"], 1);
  EXPECT_EQ(run["initial"]["x[1]"], plain["initial"]["x[1]"]);
  // The file states velocities: these keep their default, whatever the masses are.
  EXPECT_NEAR(run["initial"]["py[3]"], 3 * plain["initial"]["py[3]"].get<double>(), 1e-15);
  EXPECT_NEAR(run["initial"]["px[1]"], plain["initial"]["px[1]"], 1e-15);
  Json both = request;
  both["initial"]["py[1]"] = 0.25;  // of each coordinate the one or the other
  EXPECT_EQ(answer(both)["initial"]["py[1]"], 0.25);
  both["initial"]["px[2]"] = 0;
  EXPECT_EQ(fault_of(both)["pointer"], "/initial/vx[2]");
}

TEST_F(Scenes, RefuseWhatTheyDoNotHave) {
  NEEDS_SCENE("figure_eight");
  const auto pointer = [&](const Json& problem) {
    return fault_of({{"problem", problem}, {"scheme", "leapfrog"}})["pointer"].get<std::string>();
  };
  EXPECT_EQ(pointer({{"id", "figure_eight"}, {"m", {1, 2}}}), "/problem/m");
  EXPECT_EQ(pointer({{"id", "figure_eight"}, {"m", {1, 2, "x"}}}), "/problem/m/2");
  EXPECT_EQ(pointer({{"id", "figure_eight"}, {"variables", {"x"}}}), "/problem/variables");
  EXPECT_EQ(pointer({{"id", "figure_eight"}, {"preset", "mouth"}}), "/problem/preset");
  EXPECT_EQ(pointer({{"id", "figure_eigth"}}), "/problem/id");
}

TEST_F(Scenes, BringTheirEvents) {
  NEEDS_SCENE("bouncing_ball");
  const Json fall{{"problem", "bouncing_ball"}, {"scheme", "leapfrog"}};
  const Json run = answer(fall);
  EXPECT_EQ(run["acts"][0]["name"], "bounce");
  EXPECT_GT(run["final"]["x"], 0);
  Json back = fall;
  back["until"] = -5;
  EXPECT_GT(answer(back)["final"]["x"], 0);
  EXPECT_EQ(fault_of({{"problem", "bouncing_ball"}, {"period", 2}}, "/v1/periodic")["pointer"], "/problem");
  Json watched = fall;
  watched["events"] = {{{"name", "apex"}, {"expression", "px"}, {"direction", "down"}}};
  const Json beside = answer(watched);
  EXPECT_EQ(beside["final"], run["final"]) << "what is watched changes no motion";
  EXPECT_EQ(beside["acts"], run["acts"]);
  EXPECT_EQ(std::ranges::count_if(beside["events"], [](const Json& event) { return event["name"] == "apex"; }), 6);
  watched["events"] = {{{"name", "floor"}, {"expression", "x"}, {"direction", "down"}, {"set", {{"vx", "-e*vx"}}}}};
  EXPECT_EQ(answer(watched)["final"], run["final"]) << "what acts stands in its place";
  Json through = fall;
  through["events"] = Json::array();
  EXPECT_LT(answer(through)["final"]["x"], -10);
  const Json members{{"count", 3}, {"vary", {{"/initial/x", {{"uniform", {1, 2}}}}}}};
  EXPECT_EQ(
      fault_of({{"problem", "bouncing_ball"}, {"scheme", "leapfrog"}, {"members", members}}, "/v1/ensemble")["pointer"],
      "/problem");
  EXPECT_EQ(fault_of({{"problem", "bouncing_ball"}, {"schemes", {"leapfrog"}}}, "/v1/work-precision")["pointer"],
            "/problem");
}

// The limit of events includes those of the scene and the plane of a section.
TEST_F(Scenes, BringEventsThatCount) {
  NEEDS_SCENE("bouncing_ball");
  Json request{{"problem", "bouncing_ball"},
               {"scheme", "leapfrog"},
               {"until", 3},
               {"record", {{"every", 0}}},
               {"section", {{"expression", "px"}, {"direction", "down"}}},
               {"events", Json::array()}};
  for (int i = 1; i <= 15; ++i)
    request["events"].push_back({{"name", "e" + std::to_string(i)}, {"expression", "x-" + std::to_string(0.05 * i)}});
  EXPECT_EQ(answer(request)["acts"][0]["name"], "bounce");
  request["events"].push_back({{"name", "last"}, {"expression", "x-0.9"}});
  EXPECT_EQ(fault_of(request, "/v1/simulate")["allowed"], "15 at most");
}

TEST_F(Scenes, AreDifferentiatedAndRunBackward) {
  NEEDS_SCENE("restricted_three_body");
  const Json run = answer({{"problem", "restricted_three_body"},
                           {"scheme", "taylor"},
                           {"until", {{"t", -1}}},
                           {"record", {{"every", 0}}},
                           {"sensitivities", {{"by", {"/problem/mu", "/initial/z"}}}}});
  EXPECT_EQ(run["status"], "completed");
  EXPECT_EQ(run["problem"]["id"], "restricted_three_body");
  EXPECT_LT(run["sensitivities"]["uncertainty"], 1e-8);
  EXPECT_EQ(run["sensitivities"]["rows"].size(), 6U);
}

TEST_F(Scenes, ShowSumsAsSums) {
  NEEDS_SCENE("pleiades");
  const std::string formula = card_of("pleiades")["formula"];
  EXPECT_NE(formula.find("<munderover><mo>∑</mo><mrow><mi>j</mi><mo>=</mo><mi>i</mi><mo>+</mo><mn>1</mn></mrow>"),
            formula.npos)
      << formula;
  EXPECT_EQ(formula.find("<mn>3</mn></mrow></msub>"), formula.npos) << "an element of its own";
  const auto formula_of = [&](const char* potential) {
    Json problem = custom(R"({"variables": ["x[3]"], "parameters": {"k": 2}})");
    problem["potential"] = potential;
    const Json card = answer({{"problem", problem}}, "/v1/problems");
    return card["formula"].get<std::string>();
  };
  // A sum as a left factor needs brackets; as a right factor it does not.
  EXPECT_NE(formula_of("sum(i=1..3, x[i]^2)*k").find("<mo>(</mo><mrow><munderover>"), std::string::npos);
  EXPECT_EQ(formula_of("k*sum(i=1..3, x[i]^2)").find("<mo>(</mo>"), std::string::npos);
  EXPECT_NE(formula_of("sum(i=1..3, x[i]^2 + k)").find("<mo>(</mo>"), std::string::npos);
  EXPECT_NE(formula_of("sum(i=1..3, x[i])^2").find("<msup><mrow><mrow><mo>(</mo>"), std::string::npos);
  EXPECT_NE(formula_of("sum(i=1..3, if(i == 1, 1e-3, k)*x[i]^2)").find("<mi>i</mi><mo>=</mo><mn>1</mn>"),
            std::string::npos);
}

// Faults of a file are reported with its name and the place in it.
TEST(SceneFiles, SayWhatIsWrong) {
  const auto fault = [](const std::string& body) -> std::string {
    try {
      read_scene_file("/wrong.json", body);
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(fault("{"), "core/scenes/wrong.json: not JSON at byte 1");
  EXPECT_NE(fault(R"({"scene": {"variables": ["x"], "potential": "y"}})").find("wrong.json: /scene/potential"),
            std::string::npos);
  EXPECT_NE(fault(R"({"titel": ""})").find("/titel"), std::string::npos);
  const std::string well = R"("scene": {"variables": ["x"], "parameters": {"k": 1}, "potential": "k*x^2/2"})";
  EXPECT_NE(fault("{" + well + R"(, "initial": {"y": 1}})").find("/initial/y"), std::string::npos);
  EXPECT_NE(fault("{" + well + R"(, "presets": [{"name": "a", "initial": {"z": 1}}]})").find("/initial/z"),
            std::string::npos);
  EXPECT_NE(fault("{" + well + R"(, "about": {"z": {"doc": "no such"}}})").find("/about/z"), std::string::npos);
  EXPECT_NE(fault("{" + well + R"(, "until": "20"})").find("core/scenes/wrong.json: "), std::string::npos);
  EXPECT_EQ(fault("{" + well + "}"), "");
}

TEST(SceneFiles, OfTheReadmeIsAProblem) {
  std::ifstream readme(std::string(LEAST_SOURCE_DIR) + "/README.md");
  std::stringstream text;
  text << readme.rdbuf();
  const std::string all = text.str();
  const auto from = all.rfind("```json\n", all.find("Double well")), to = all.find("```", from + 8);
  ASSERT_NE(to, std::string::npos);
  const TextProblem problem = read_scene_file("/double_well.json", all.substr(from + 8, to - from - 8));
  const ProblemCard& card = problem.mechanics->card();
  EXPECT_EQ(card.id, "double_well");
  EXPECT_EQ(card.variables.front().value, 1.5);
  EXPECT_EQ(card.parameters.front().doc, "height of the hill between the wells");
  EXPECT_EQ(card.presets.size(), 1U);
  EXPECT_GE(card.schemes.size(), 10U);
}

// Where a text is not from the request, the fault names the number of the request that causes it.
TEST_F(Scenes, TellFaultsAtWhatTheRequestSays) {
  const struct {
    const char *id, *numbers, *initial, *pointer, *says;
  } rows[] = {
      {"elastic_pendulum", R"("m":0)", "", "/problem/m", "the mass of x is not positive"},
      {"figure_eight", R"("m":[0,1,1])", "", "/problem/m/0", "the mass of x[1] is not positive"},
      {"figure_eight", R"("m":[0,1,0])", "", "/problem/m", "not positive"},
      {"figure_eight", R"("m[1]":0)", "", "/problem/m[1]", "not positive"},
      {"kapitza", R"("l":0)", "", "/problem/l", "the mass of q is not positive"},
      {"rigid_body", R"("I":[0,1,2])", "", "/problem/I/0", "not finite at the start"},
      {"spherical_pendulum", R"("l":1)", R"("theta":0)", "/initial", "the Lagrangian is not regular"},
      {"pleiades", "", R"("x[1]":3,"y[1]":3,"x[2]":3,"y[2]":3)", "/initial", "the potential is not finite"},
  };
  for (const auto& row : rows) {
    if (!has(row.id)) continue;
    const std::string numbers = *row.numbers ? std::string(",") + row.numbers : "";
    const Json fault =
        only_fault(ask(port(), post("/v1/simulate", std::string(R"({"problem":{"id":")") + row.id + "\"" + numbers +
                                                        R"(},"initial":{)" + row.initial + R"(},"scheme":"taylor"})")));
    EXPECT_EQ(fault["pointer"], row.pointer) << fault;
    EXPECT_TRUE(says(fault, row.says)) << fault;
    EXPECT_FALSE(fault["allowed"].get<std::string>().empty()) << fault;
  }
}

// The card of a problem with events that act offers nothing that is refused beside them.
TEST_F(Scenes, ThatMoveByActsStandWithWhatKnowsThem) {
  NEEDS_SCENE("bouncing_ball");
  const Json card = card_of("bouncing_ball");
  for (const char* name : {"error", "lyapunov"})
    EXPECT_EQ(std::ranges::count(card["diagnostics"], Json(name)), 0) << name;
  EXPECT_EQ(std::ranges::count(card["columns"], Json("error")), 0);
  for (const Json& diagnostic : card["diagnostics"]) {
    const Json request = {{"problem", "bouncing_ball"}, {"scheme", "leapfrog"}, {"diagnostics", {diagnostic}}};
    EXPECT_EQ(reply(request).status, 200) << diagnostic;
  }
}

}  // namespace
}  // namespace least::server::test

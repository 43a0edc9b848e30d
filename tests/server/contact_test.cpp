// Requests and answers of the dissipative problems: presets, variables that are carried only when asked for, initial
// values that follow from others, and unknown numbers. Against the catalogue itself, over real sockets.
#include <gtest/gtest.h>

#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

using ContactHttp = Serving;

Reply simulate(int port, const Json& request, std::string_view fields = "") {
  return ask(port, post("/v1/simulate", request.dump(), fields));
}
Json answer(int port, const Json& request) {
  const Reply reply = simulate(port, request);
  EXPECT_EQ(reply.status, 200) << request << reply.body;
  return reply.status == 200 ? Json::parse(reply.body) : Json::object();
}
/// fault() returns the only fault of a request.
Json fault(int port, const Json& request) { return only_fault(simulate(port, request)); }
std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back(key);
  return names;
}
/// echo() returns the members of an answer that make a complete request.
Json echo(const Json& whole) {
  Json request;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    request[key] = whole.at(key);
  return request;
}
/// timeless() returns an answer without its cost, which depends on the clock.
std::string timeless(std::string body) {
  const auto from = body.find(R"(,"cost":)"), to = body.find(R"(,"events":)");
  EXPECT_LT(from, to);
  EXPECT_NE(to, std::string::npos);
  return body.erase(from, to - from);
}

// ── presets ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST_F(ContactHttp, APresetFillsInEverythingItNames) {
  const Json run = answer(port(), {{"problem", {{"id", "van_der_pol"}, {"preset", "relaxation_100"}}},
                                   {"scheme", "contact_splitting"},
                                   {"record", {{"every", 0}}}});
  EXPECT_EQ(run["problem"], (Json{{"id", "van_der_pol"}, {"epsilon", 100}, {"amplitude", 0}, {"frequency", 1}}));
  EXPECT_EQ(run["scheme"]["step"], 0.001);
  EXPECT_EQ(run["until"]["t"], 350);
  const Json forced = answer(port(), {{"problem", {{"id", "van_der_pol"}, {"preset", "forced"}}},
                                      {"scheme", "contact_splitting"},
                                      {"record", {{"every", 0}}}});
  EXPECT_EQ(forced["initial"]["v"], 2);
  EXPECT_EQ(forced["scheme"]["step"], 0.01) << "the problem's own suggestion";
  EXPECT_EQ(forced["until"]["t"], 30) << "the problem's own span";
}

TEST_F(ContactHttp, ExplicitKeysWinOverAPreset) {
  const Json run = answer(port(), {{"problem", {{"id", "van_der_pol"}, {"preset", "relaxation_100"}, {"epsilon", 50}}},
                                   {"initial", {{"x", 1.5}, {"t", 2}}},
                                   {"scheme", {{"id", "contact_splitting"}, {"step", 0.002}}},
                                   {"until", {{"t", 3}}}});
  EXPECT_EQ(run["problem"]["epsilon"], 50);
  EXPECT_EQ(run["initial"]["x"], 1.5);
  EXPECT_EQ(run["initial"]["t"], 2);
  EXPECT_EQ(run["scheme"]["step"], 0.002);
  EXPECT_EQ(run["until"]["t"], 3);
  const Json late = answer(port(), {{"problem", {{"id", "van_der_pol"}, {"preset", "relaxation_100"}}},
                                    {"initial", {{"t", 7}}},
                                    {"scheme", {{"id", "contact_splitting"}, {"step", 0.002}}},
                                    {"record", {{"every", 0}}}});
  EXPECT_EQ(late["until"]["t"], 357) << "the span counts from the start";
}

TEST_F(ContactHttp, EveryPresetOfTheCatalogueRunsAndStandsInTheEchoAsItsKeys) {
  for (const auto& mechanics : problem_list()) {
    const ProblemCard& problem = mechanics->card();
    for (const PresetCard& preset : problem.presets) {
      const bool split = std::ranges::count(problem.schemes, find_scheme("contact_splitting").value()) > 0;
      const std::string scheme = split ? "contact_splitting" : "leapfrog";
      const Json run = answer(port(), {{"problem", {{"id", problem.id}, {"preset", preset.name}}},
                                       {"scheme", scheme},
                                       {"record", {{"every", 0}}},
                                       {"until", {{"steps", 10}}},
                                       {"diagnostics", Json::array()}});
      EXPECT_EQ(run["status"], "completed") << problem.id << ' ' << preset.name << run["stop"];
      EXPECT_FALSE(run["problem"].contains("preset"));
      for (const auto& [name, value] : preset.parameters) EXPECT_EQ(run["problem"][std::string(name)], value) << name;
      for (const auto& [name, value] : preset.initial) EXPECT_EQ(run["initial"][std::string(name)], value) << name;
      for (const auto& [name, value] : preset.suggested) EXPECT_EQ(run["scheme"][std::string(name)], value) << name;
    }
  }
}

TEST_F(ContactHttp, AnUnknownPresetIsAFaultWithTheNamesThatAreAllowed) {
  const Json unknown = fault(port(), {{"problem", {{"id", "cosmological_oscillator"}, {"preset", "blowup"}}},
                                      {"scheme", "contact_splitting"}});
  EXPECT_EQ(unknown["pointer"], "/problem/preset");
  EXPECT_TRUE(says(unknown, "did you mean \"blow_up\"?")) << unknown;
  EXPECT_EQ(unknown["allowed"], "zero_energy, blow_up");
  EXPECT_TRUE(
      says(fault(port(), {{"problem", {{"id", "harmonic_oscillator"}, {"preset", "x"}}}, {"scheme", "leapfrog"}}),
           "harmonic_oscillator has no presets"));
  EXPECT_EQ(fault(port(), {{"problem", {{"id", "cosmological_oscillator"}, {"preset", 1}}},
                           {"scheme", "contact_splitting"}})["allowed"],
            "zero_energy, blow_up");
}

// ── variables that are carried where they are asked for ─────────────────────────────────────────────────────────────

TEST_F(ContactHttp, TheActionIsCarriedWhereItIsAskedFor) {
  Json request{{"problem", "damped_oscillator"}, {"initial", {{"s", 0.5}}}, {"scheme", "contact_splitting"}};
  const Json plain = answer(port(), request);
  EXPECT_EQ(plain["columns"], (Json{"t", "q", "p"}));
  EXPECT_EQ(keys(plain["final"]), (std::vector<std::string>{"t", "q", "p"}));
  EXPECT_EQ(plain["initial"]["s"], 0.5);
  request["columns"] = {"q", "s"};
  const Json with = answer(port(), request);
  EXPECT_EQ(keys(with["final"]), (std::vector<std::string>{"t", "q", "p", "s"}));
  EXPECT_EQ(with["trajectory"]["s"][0], 0.5);
  EXPECT_EQ(with["trajectory"]["s"].back(), with["final"]["s"]);
  EXPECT_EQ(with["trajectory"]["q"], plain["trajectory"]["q"]) << "to the bit";
  // Where the motion depends on s it is a variable like the others.
  const Json cosmos = answer(port(), {{"problem", "cosmological_oscillator"}, {"scheme", "contact_splitting"}});
  EXPECT_EQ(cosmos["columns"], (Json{"t", "q", "p", "s"}));
  EXPECT_TRUE(cosmos["final"].contains("s"));
}

TEST_F(ContactHttp, TheEchoSentBackGivesTheSameBytesForEveryProblem) {
  for (const auto& mechanics : problem_list()) {
    const ProblemCard& problem = mechanics->card();
    for (const std::size_t scheme : problem.schemes) {
      Json request{{"problem", problem.id},
                   {"scheme", schemes()[scheme].id},
                   {"until", {{"steps", 40}}},
                   {"record", {{"samples", 7}}},
                   {"columns", Json::array()}};
      if (schemes()[scheme].own_clock) request["record"] = {{"every", 6}};  // when 40 of its steps end is not known
      for (const ColumnCard& column : problem.columns)
        if (column.name != "energy" || problem.id != "lane_emden") request["columns"].push_back(column.name);
      const std::string first = simulate(port(), request).body;
      Json again = echo(Json::parse(first));
      EXPECT_EQ(timeless(simulate(port(), again).body), timeless(first)) << problem.id << ' ' << schemes()[scheme].id;
      EXPECT_EQ(keys(again["initial"]).size(), problem.variables.size() + 1) << "the start is whole";
    }
  }
}

// ── starts that follow from others ──────────────────────────────────────────────────────────────────────────────────

TEST_F(ContactHttp, ASlopeThatIsNotGivenIsThatOfTheFlow) {
  Json request{{"problem", "van_der_pol"},
               {"initial", {{"x", 1}, {"v", 2}}},
               {"scheme", "contact_splitting"},
               {"columns", {"t", "slope"}},
               {"until", {{"steps", 5}}}};
  const Json own = answer(port(), request);
  EXPECT_TRUE(own["initial"]["slope"].is_null());
  EXPECT_NEAR(own["trajectory"]["slope"][0].get<double>(), -0.5, 1e-15);  // (ε(1 − x²)v − x)/v
  request["initial"]["slope"] = nullptr;
  EXPECT_EQ(answer(port(), request)["trajectory"], own["trajectory"]);
  request["initial"]["slope"] = 0.25;
  const Json given = answer(port(), request);
  EXPECT_EQ(given["initial"]["slope"], 0.25);
  EXPECT_EQ(given["trajectory"]["slope"][0], 0.25);
  request["initial"] = {{"x", nullptr}};
  EXPECT_EQ(fault(port(), request)["pointer"], "/initial/x");
}

TEST_F(ContactHttp, AStartNearASingularTimeIsFilledInWhereNoStateIsGiven) {
  const Json request{{"problem", {{"id", "lane_emden"}, {"n", 5}}},
                     {"initial", {{"t", 0.05}}},
                     {"scheme", "contact_splitting"},
                     {"until", {{"steps", 3}}}};
  const Json run = answer(port(), request);
  EXPECT_EQ(run["initial"]["t"], 0.05);
  EXPECT_NEAR(run["initial"]["q"].get<double>(), 1 / std::sqrt(1 + 0.0025 / 3), 1e-15);
  EXPECT_NEAR(run["initial"]["p"].get<double>(), -0.05 / 3 * std::pow(1 + 0.0025 / 3, -1.5), 1e-15);
  EXPECT_NEAR(run["initial"]["s"].get<double>(), -0.05 / 18, 1e-5);  // −t/3(n + 1) + …
  EXPECT_EQ(run["trajectory"]["q"][0], run["initial"]["q"]);
  Json other = request;
  other["initial"]["q"] = 0.75;  // a state is given: the rest of it takes its defaults
  EXPECT_EQ(answer(port(), other)["initial"], (Json{{"t", 0.05}, {"q", 0.75}, {"p", 0}, {"s", 0}}));
  other["initial"] = {{"t", 0.5}};
  EXPECT_EQ(answer(port(), other)["initial"]["q"], 1 / std::sqrt(1 + 0.25 / 3)) << "beyond the reach of the series";
  for (const double t : {-0.5, 4.0}) {
    other["problem"]["n"] = 1;  // whose surface is at π
    other["initial"]["t"] = t;
    const Json refused = fault(port(), other);
    EXPECT_EQ(refused["pointer"], "/initial/t");
    EXPECT_TRUE(says(refused, "the state must be given"));
    EXPECT_EQ(refused["allowed"], "q, p, s");
  }
}

// ── choices and whole numbers ───────────────────────────────────────────────────────────────────────────────────────

TEST_F(ContactHttp, AChoiceOfAProblemIsAName) {
  const Json card = Json::parse(ask(port(), get("/v1/problems/lane_emden")).body);
  const Json& after = card["parameters"][1];
  EXPECT_EQ(after["name"], "after_zero");
  EXPECT_EQ(after["type"], "choice");
  EXPECT_EQ(after["default"], "stop");
  EXPECT_EQ(after["choices"], (Json{"stop", "continue", "signed", "clamp"}));
  EXPECT_FALSE(after.contains("minimum"));
  for (const auto& name : after["choices"]) {
    const Json run = answer(port(), {{"problem", {{"id", "lane_emden"}, {"after_zero", name}}},
                                     {"scheme", "contact_splitting"},
                                     {"record", {{"every", 0}}}});
    EXPECT_EQ(run["problem"]["after_zero"], name);
    EXPECT_EQ(run["status"], name == "stop" ? "stopped" : "completed") << name;
  }
  for (const Json& wrong : {Json(0), Json("Stop"), Json(true), Json(nullptr)}) {
    const Json found =
        fault(port(), {{"problem", {{"id", "lane_emden"}, {"after_zero", wrong}}}, {"scheme", "contact_splitting"}});
    EXPECT_EQ(found["pointer"], "/problem/after_zero");
    EXPECT_EQ(found["allowed"], "stop, continue, signed, clamp");
  }
}

TEST_F(ContactHttp, SettingsOfTheContactSchemes) {
  const auto echoed = [&](const Json& scheme) {
    return answer(port(), {{"problem", "damped_oscillator"}, {"scheme", scheme}, {"until", {{"steps", 1}}}})["scheme"];
  };
  EXPECT_EQ(echoed("contact_splitting"),
            (Json{{"id", "contact_splitting"}, {"step", 0.1}, {"composition", "none"}, {"splitting", "automatic"}}));
  for (const char* splitting : {"automatic", "plain", "merged", "saba_2", "saba_4", "aba_864", "aba_1064"})
    EXPECT_EQ(echoed({{"id", "contact_splitting"}, {"splitting", splitting}})["splitting"], splitting);
  EXPECT_EQ(echoed("contact_gauss"), (Json{{"id", "contact_gauss"}, {"step", 0.1}, {"stages", 2}}));
  EXPECT_EQ(echoed({{"id", "contact_gauss"}, {"stages", 3.0}})["stages"].dump(), "3");
  EXPECT_EQ(echoed("contact_galerkin_4"), (Json{{"id", "contact_galerkin_4"}, {"step", 0.1}}));

  const auto refused = [&](const Json& scheme) {
    return fault(port(), {{"problem", "damped_oscillator"}, {"scheme", scheme}});
  };
  for (const Json& stages : {Json(0), Json(4), Json(1.5), Json("two"), Json(nullptr)}) {
    const Json found = refused({{"id", "contact_gauss"}, {"stages", stages}});
    EXPECT_EQ(found["pointer"], "/scheme/stages") << stages;
    EXPECT_EQ(found["allowed"], "[1, 3]") << stages;
  }
  EXPECT_EQ(refused({{"id", "contact_splitting"}, {"splitting", "mergd"}})["allowed"],
            "automatic, plain, merged, saba_2, saba_4, aba_864, aba_1064");
  EXPECT_EQ(refused({{"id", "contact_leapfrog"}, {"splitting", "plain"}})["pointer"], "/scheme/splitting");
  EXPECT_EQ(refused({{"id", "contact_galerkin_4"}, {"composition", "none"}})["pointer"], "/scheme/composition");

  // A splitting for weak perturbations has its own sequence of parts: it is not composed, and needs drifts and the rest
  // as two flows.
  const Json composed = refused({{"id", "contact_splitting"}, {"splitting", "aba_864"}, {"composition", "kahan_li_6"}});
  EXPECT_EQ(composed["pointer"], "/scheme/composition");
  EXPECT_EQ(composed["allowed"], "none");
  for (const char* problem : {"cosmological_oscillator", "van_der_pol"}) {
    const Json found =
        fault(port(), {{"problem", problem}, {"scheme", {{"id", "contact_splitting"}, {"splitting", "saba_2"}}}});
    EXPECT_EQ(found["pointer"], "/scheme/splitting") << problem;
    EXPECT_EQ(found["allowed"], "automatic, plain, merged") << problem;
  }
}

TEST_F(ContactHttp, ImpossiblePairsNameBothSides) {
  struct Row {
    const char *problem, *scheme, *needs, *offers;
  };
  for (const auto& [problem, scheme, needs, offers] :
       {Row{"damped_oscillator", "leapfrog", "a separable Hamiltonian", "a contact Hamiltonian linear in s"},
        Row{"cosmological_oscillator", "galerkin_4", "a Lagrangian", "a contact Hamiltonian quadratic in s"},
        Row{"kepler", "contact_leapfrog", "a contact Hamiltonian", "a separable Hamiltonian"},
        Row{"generic_oscillator", "contact_leapfrog", "a contact Hamiltonian",
            "a vector field that is a sum of exact flows"},
        Row{"van_der_pol", "contact_gauss", "a contact Hamiltonian", "a vector field that is a sum of exact flows"}}) {
    const Json found = fault(port(), {{"problem", problem}, {"scheme", scheme}});
    EXPECT_EQ(found["pointer"], "/scheme");
    for (const char* part : {problem, scheme, needs, offers}) EXPECT_TRUE(says(found, part)) << found << part;
    EXPECT_NE(found["allowed"].get<std::string>().find("runge_kutta_4"), std::string::npos);
  }
}

// ── numbers that are unknown ────────────────────────────────────────────────────────────────────────────────────────

TEST_F(ContactHttp, ASlopeAtItsPoleIsNullAndInCsvAnEmptyCell) {
  const Json request{{"problem", "van_der_pol"},
                     {"scheme", "contact_splitting"},
                     {"columns", {"t", "slope", "x"}},
                     {"until", {{"steps", 2}}},
                     {"diagnostics", {"poles", "cycle"}}};
  const Reply json = simulate(port(), request);
  EXPECT_NE(json.body.find(R"("slope":[null,)"), std::string::npos) << json.body;
  for (const char* forbidden : {"NaN", "nan,", "Infinity", "inf"})
    EXPECT_EQ(json.body.find(forbidden), std::string::npos) << forbidden;
  const Json run = Json::parse(json.body);
  EXPECT_EQ(run["status"], "completed");
  EXPECT_EQ(run["diagnostics"]["poles"], (Json{0}));
  EXPECT_TRUE(run["diagnostics"]["cycle"]["period"].is_null());
  EXPECT_EQ(run["diagnostics"]["cycle"]["cycles"], 0);
  const Reply csv = simulate(port(), request, "Accept: text/csv\r\n");
  EXPECT_EQ(csv.body.substr(0, csv.body.find('\n', 14)), "t,slope,x\n0,,2") << csv.body;
  // At rest there is no slope anywhere, not even at the end.
  Json rest = request;
  rest["initial"] = {{"x", 0}, {"v", 0}};
  const Json still = answer(port(), rest);
  EXPECT_EQ(still["trajectory"]["slope"], (Json{nullptr, nullptr, nullptr}));
  EXPECT_EQ(keys(still["final"]), (std::vector<std::string>{"t", "x", "v"}));
}

TEST_F(ContactHttp, NoAnswerHoldsANumberThatIsNone) {
  for (const Json& request :
       {Json{{"problem", "generic_oscillator"}, {"initial", {{"U", 1e-300}}}, {"diagnostics", {"entropy", "energy"}}},
        Json{{"problem", "lane_emden"}, {"diagnostics", {"energy", "decay", "volume", "structure"}}},
        Json{{"problem", "cosmological_oscillator"}, {"initial", {{"s", -2}, {"q", 0}, {"p", 0}}}},
        Json{{"problem", {{"id", "thermostat"}, {"scale", 0.001}, {"kappa", 0.5}}}, {"diagnostics", {"moments"}}},
        Json{{"problem", "van_der_pol"}, {"initial", {{"v", 1e70}}}, {"columns", {"t", "slope"}}},
        Json{{"problem", {{"id", "damped_oscillator"}, {"damping", -1000}}}, {"diagnostics", {"decay", "volume"}}}}) {
    Json whole = request;
    whole["scheme"] = "contact_splitting";
    for (const char* accept : {"application/json", "text/csv"}) {
      const Reply reply = simulate(port(), whole, "Accept: " + std::string(accept) + "\r\n");
      EXPECT_EQ(reply.status, 200) << whole << reply.body;
      std::string text = reply.body;
      for (const auto& [name, value] : reply.fields) text += value;
      for (const char* forbidden : {"NaN", "nan,", "nan}", "nan]", "Infinity", "inf,", "inf}", "inf]", "-inf"})
        EXPECT_EQ(text.find(forbidden), std::string::npos) << whole << forbidden;
      EXPECT_TRUE(accept[0] == 't' || Json::accept(reply.body));
    }
  }
}

TEST_F(ContactHttp, AVariableHasItsRange) {
  for (const char* id : {"generic_oscillator", "pendulum"}) runs::problem_called(id);
  for (const double u : {0.0, -1.0}) {
    const Json found =
        fault(port(), {{"problem", "generic_oscillator"}, {"initial", {{"U", u}}}, {"scheme", "contact_splitting"}});
    EXPECT_EQ(found["pointer"], "/initial/U");
    EXPECT_TRUE(says(found, "must be greater than 0")) << found;
  }
  const auto variables = [&](const char* id) {
    return Json::parse(ask(port(), get("/v1/problems/" + std::string(id))).body)["variables"];
  };
  const Json heat = variables("generic_oscillator"), swing = variables("pendulum");
  EXPECT_EQ(heat[2]["minimum"], 0);
  EXPECT_EQ(heat[2]["exclusive_minimum"], true);
  EXPECT_TRUE(heat[2]["maximum"].is_null() && heat[0]["minimum"].is_null());
  EXPECT_EQ(swing[0]["angle"], true);
  EXPECT_EQ(swing[1]["angle"], false);
}

// In the absolute norm q₀ = 1e-6 has the accuracy 1e-6 before a step is taken.
TEST_F(ContactHttp, TheNormOfErrorsIsARequest) {
  Json request{
      {"problem", "harmonic_oscillator"}, {"initial", {{"q", 1e-6}}},  {"scheme", {{"id", "auto"}, {"accuracy", 1e-6}}},
      {"record", {{"samples", 3}}},       {"columns", {"t", "error"}}, {"diagnostics", {"error"}}};
  const Json absolute = answer(port(), request);
  EXPECT_EQ(absolute["norm"], "absolute");
  EXPECT_LT(absolute["diagnostics"]["error"]["max"], 1e-6);
  request["norm"] = "relative";
  const Json relative = answer(port(), request);
  EXPECT_EQ(relative["norm"], "relative");
  EXPECT_TRUE(relative["choice"]["met"].get<bool>());
  EXPECT_LE(relative["choice"]["estimated_error"], 1e-6);
  const double most = relative["diagnostics"]["error"]["max"];
  EXPECT_LT(most, 1.1e-6);
  EXPECT_GT(most, 1e-8) << "no more digits than were asked for";
  EXPECT_EQ(relative["trajectory"]["error"].size(), 3U);
  EXPECT_EQ(relative["trajectory"]["error"][0], 0);
  Json again = echo(relative);
  again["diagnostics"] = {"error"};
  EXPECT_EQ(answer(port(), again)["diagnostics"]["error"]["max"], most) << "the echo has the norm";
  request["norm"] = "max";
  EXPECT_EQ(fault(port(), request)["allowed"], "absolute, relative");
}

TEST_F(ContactHttp, ABlowUpIsAnAnswerWithItsTime) {
  const Json run = answer(port(), {{"problem", "cosmological_oscillator"},
                                   {"initial", {{"q", 0}, {"p", 0}, {"s", -2}}},
                                   {"scheme", "contact_splitting"}});
  EXPECT_EQ(run["status"], "stopped");
  EXPECT_EQ(run["stop"]["reason"], "singular");
  EXPECT_NEAR(run["stop"]["singular_at"].get<double>(), 1.24645048028, 1e-10);
  EXPECT_EQ(run["trajectory"]["t"].size(), run["stop"]["step"].get<std::size_t>() + 1);
}

}  // namespace
}  // namespace least::server::test

// The OpenAPI document: consistent in itself, in agreement with the catalogue, and with examples that are answered.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

// Validator checks values against the document's schemas. It knows only those words of JSON Schema that they use;
// another word is an error.
class Validator {
 public:
  explicit Validator(const Json& document) : schemas_(document.at("components").at("schemas")) {}

  /// fault() returns why the value does not fit; empty where it does.
  std::string fault(const Json& schema, const Json& value, const std::string& at = "") const {
    for (const auto& [word, means] : schema.items()) {
      const std::string why = check(schema, word, means, value, at);
      if (!why.empty()) return why;
    }
    return {};
  }

 private:
  std::string check(const Json& schema, const std::string& word, const Json& means, const Json& value,
                    const std::string& at) const {
    const std::string wrong = at + ": " + word;
    if (word == "$ref") {
      const std::string name = means.get<std::string>().substr(std::string("#/components/schemas/").size());
      return schemas_.contains(name) ? fault(schemas_.at(name), value, at) : at + ": no schema " + name;
    }
    if (word == "anyOf" || word == "oneOf") {
      std::size_t fitting = 0;
      for (const Json& one : means) fitting += fault(one, value, at).empty();
      return fitting == 1 || (fitting > 1 && word == "anyOf") ? "" : wrong;
    }
    if (word == "type") {
      const Json types = means.is_array() ? means : Json::array({means});
      for (const Json& type : types)
        if (is(type, value)) return {};
      return wrong;
    }
    if (word == "const") return value == means ? "" : wrong;
    if (word == "enum") return std::find(means.begin(), means.end(), value) != means.end() ? "" : wrong;
    if (word == "required") {
      for (const Json& key : means)
        if (!value.contains(key.get<std::string>())) return wrong + " " + key.dump();
      return {};
    }
    if (word == "properties") {
      for (const auto& [key, part] : value.items()) {
        if (!means.contains(key)) continue;
        if (auto why = fault(means.at(key), part, at + "/" + key); !why.empty()) return why;
      }
      return {};
    }
    if (word == "additionalProperties") {
      for (const auto& [key, part] : value.items()) {
        if (schema.contains("properties") && schema["properties"].contains(key)) continue;
        if (means.is_boolean() && !means) return wrong + " " + key;
        if (means.is_object())
          if (auto why = fault(means, part, at + "/" + key); !why.empty()) return why;
      }
      return {};
    }
    if (word == "items") {
      for (const Json& part : value)
        if (auto why = fault(means, part, at + "/-"); !why.empty()) return why;
      return {};
    }
    if (word == "uniqueItems") return std::set<Json>(value.begin(), value.end()).size() == value.size() ? "" : wrong;
    if (word == "minItems") return value.size() >= means ? "" : wrong;
    if (word == "maxItems") return value.size() <= means ? "" : wrong;
    if (word == "pattern")
      return !value.is_string() || std::regex_search(value.get<std::string>(), std::regex(means.get<std::string>()))
                 ? ""
                 : wrong;
    if ((word.ends_with("inimum") || word.ends_with("aximum")) && !value.is_number()) return {};
    if (word == "minimum") return !(value < means) ? "" : wrong;
    if (word == "maximum") return !(means < value) ? "" : wrong;
    if (word == "exclusiveMinimum") return means < value ? "" : wrong;
    if (word == "exclusiveMaximum") return value < means ? "" : wrong;
    const std::set<std::string> notes{"description", "default", "title", "x-unit", "x-suggested"};
    return notes.contains(word) ? "" : at + ": a word that is not known here: " + word;
  }
  static bool is(const std::string& type, const Json& value) {
    return type == "object"    ? value.is_object()
           : type == "array"   ? value.is_array()
           : type == "string"  ? value.is_string()
           : type == "number"  ? value.is_number()
           : type == "integer" ? value.is_number() && std::floor(value.get<double>()) == value.get<double>()
           : type == "boolean" ? value.is_boolean()
                               : type == "null" && value.is_null();
  }
  const Json& schemas_;
};

class OpenApi : public Serving {
 protected:
  static const Json& document() {
    static const Json all = Json::parse(ask(port(), get("/v1/openapi.json")).body);
    return all;
  }
  static const Json& schema(const std::string& name) { return document()["components"]["schemas"].at(name); }
  static std::string fault(const std::string& name, const std::string& request) {
    return Validator(document()).fault(schema(name), Json::parse(request));
  }
};

// expect_references_lead() checks that every reference has a target.
void expect_references_lead(const Json& part, const Json& document) {
  if (!part.is_structured()) return;
  if (part.is_object() && part.contains("$ref")) {
    const std::string target = part["$ref"];
    EXPECT_EQ(target.find("#/components/"), 0u) << target;
    EXPECT_TRUE(document.contains(Json::json_pointer(target.substr(1)))) << target;
  }
  for (const Json& child : part) expect_references_lead(child, document);
}

TEST_F(OpenApi, IsSoundInItself) {
  EXPECT_EQ(document()["openapi"], "3.1.0");
  for (const char* key : {"title", "version"}) EXPECT_TRUE(document()["info"][key].is_string());
  expect_references_lead(document(), document());
  std::set<std::string> ids;
  for (const auto& [path, methods] : document()["paths"].items()) {
    EXPECT_EQ(path.front(), '/');
    for (const auto& [method, operation] : methods.items()) {
      EXPECT_TRUE(method == "get" || method == "post");
      EXPECT_TRUE(ids.insert(operation.at("operationId")).second) << operation["operationId"];
      EXPECT_TRUE(operation["responses"].contains("200")) << path;
      for (const auto& [status, response] : operation["responses"].items()) {
        const Json& told = status == "200" ? response : document()["components"]["responses"][status];
        EXPECT_TRUE(told.at("description").is_string()) << path << status;
      }
      EXPECT_EQ(operation.contains("requestBody"), method == "post");
      EXPECT_EQ(path.find("{id}") != path.npos, operation.contains("parameters")) << path;
    }
  }
}

TEST_F(OpenApi, HoldsEveryEndpointAndNoOther) {
  std::set<std::string> told, listed;
  for (const auto& [path, methods] : document()["paths"].items()) told.insert(path);
  const Json index = Json::parse(ask(port(), get("/v1")).body);
  for (const Json& endpoint : index["endpoints"]) {
    listed.insert(endpoint["href"]);
  }
  EXPECT_EQ(told, listed);
  for (std::string path : told) {
    const bool posts = document()["paths"][path].contains("post");
    const Json operation = document()["paths"][path][posts ? "post" : "get"];
    if (const auto hole = path.find("{id}"); hole != path.npos) {
      for (const Json& id : operation["parameters"][0]["schema"]["enum"]) {
        std::string one = path;
        EXPECT_EQ(ask(port(), get(one.replace(hole, 4, id.get<std::string>()))).status, 200) << one;
      }
    } else if (!posts) {
      EXPECT_EQ(ask(port(), get(path)).status, 200) << path;
    }
  }
}

// The rule about slow readers stands wherever lines are offered, with the numbers that the service uses.
TEST_F(OpenApi, SaysWhatBecomesOfThoseWhoReadLinesSlowly) {
  int offered = 0;
  for (const auto& [path, operations] : document().at("paths").items()) {
    if (!operations.contains("post")) continue;
    const Json& answer = operations.at("post").at("responses").at("200");
    const std::string said = answer.at("description");
    const bool lines = answer.at("content").contains("application/x-ndjson");
    offered += lines ? 1 : 0;
    for (const char* part : {"holds no place", "nothing for 5 s", "less than 65536 bytes a second", "32 computations"})
      EXPECT_EQ(said.find(part) != said.npos, lines) << path << ": " << part;
  }
  EXPECT_GE(offered, 4);
}

TEST_F(OpenApi, EveryExampleFitsItsSchemaAndIsAnswered) {
  std::size_t sent = 0;
  for (const auto& [path, methods] : document()["paths"].items()) {
    if (!methods.contains("post")) continue;
    const Json& body = methods["post"]["requestBody"]["content"]["application/json"];
    EXPECT_FALSE(body["examples"].empty()) << path;
    for (const auto& [name, example] : body["examples"].items()) {
      EXPECT_EQ(Validator(document()).fault(body["schema"], example["value"]), "") << path << " " << name;
      const Reply reply = ask(port(), post(path, example["value"].dump()));
      EXPECT_EQ(reply.status, 200) << path << " " << name << reply.body;
      const Json& answer = methods["post"]["responses"]["200"]["content"]["application/json"]["schema"];
      EXPECT_EQ(Validator(document()).fault(answer, Json::parse(reply.body)), "") << path << " " << name;
      ++sent;
    }
  }
  EXPECT_GE(sent, Json::parse(ask(port(), get("/v1/problems")).body)["problems"].size() + 2);
}

// Every parameter of every card, with its range, default, unit and description.
TEST_F(OpenApi, SaysWhatTheCardsSay) {
  const Json catalogue = Json::parse(ask(port(), get("/v1/catalogue")).body);
  const auto compare = [&](const Json& told, const Json& card, const std::string& where) {
    EXPECT_EQ(told["default"], card["default"]) << where;
    EXPECT_EQ(told.value("description", ""), card["doc"].get<std::string>()) << where;
    EXPECT_EQ(told.value("x-unit", ""), card.value("unit", "")) << where;
    const Json& range = told.contains("anyOf") && card["nullable"] ? told["anyOf"][0] : told;
    if (card["type"] == "number" || card["type"] == "integer") {
      const auto bound = [&](const char* open, const char* closed) {
        return range.value(open, range.value(closed, Json()));
      };
      EXPECT_EQ(bound("exclusiveMinimum", "minimum"), card["minimum"]) << where;
      EXPECT_EQ(bound("exclusiveMaximum", "maximum"), card["maximum"]) << where;
      EXPECT_EQ(range.contains("exclusiveMinimum"), card["exclusive_minimum"] && !card["minimum"].is_null()) << where;
    }
  };
  std::size_t compared = 0;
  for (const auto& [kind, prefix] : {std::pair{"problems", "Problem."}, {"schemes", "Scheme."}}) {
    for (const Json& card : catalogue[kind]) {
      const Json& properties = schema(prefix + card["id"].get<std::string>())["properties"];
      for (const Json& parameter : card["parameters"]) {
        const std::string name = parameter["name"];
        ASSERT_TRUE(properties.contains(name)) << card["id"] << name;
        if (parameter["type"] == "list") continue;
        compare(properties[name], parameter, card["id"].get<std::string>() + " " + name);
        ++compared;
      }
      EXPECT_EQ(properties.contains("preset"), !card["presets"].empty());
    }
  }
  EXPECT_GT(compared, 50u);
}

// The schema refuses what the decoder refuses.
TEST_F(OpenApi, TheSchemaRefusesWhatTheServiceRefuses) {
  const char* const good = R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0.1,"composition":"none"},
    "initial":{"x":1,"t":0},"until":{"steps":5},"record":{"every":1},"columns":["t","x"],"norm":"relative"})";
  EXPECT_EQ(fault("SimulateRequest", good), "");
  EXPECT_EQ(ask(port(), post("/v1/simulate", good)).status, 200);
  for (const char* bad :
       {R"({"problem":"kepler"})", R"({"problem":"keplr","scheme":"leapfrog"})",
        R"({"problem":"kepler","scheme":{"step":1}})", R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0}})",
        R"({"problem":"kepler","scheme":{"id":"leapfrog","step":"a"}})",
        R"({"problem":"kepler","scheme":{"id":"leapfrog","steps":1}})",
        R"({"problem":"kepler","scheme":{"id":"leapfrog","composition":"nonsense"}})",
        R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1,"steps":2}})",
        R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":0}})",
        R"({"problem":"kepler","scheme":"leapfrog","record":{"samples":1}})",
        R"({"problem":"kepler","scheme":"leapfrog","columns":["t","t"]})",
        R"({"problem":"kepler","scheme":"leapfrog","columns":["nonsense"]})",
        R"({"problem":"kepler","scheme":"leapfrog","limits":{"seconds":1e9}})",
        R"({"problem":"kepler","scheme":"leapfrog","colums":[]})",
        R"({"problem":{"id":"kepler","mu":-1},"scheme":"leapfrog"})",
        R"({"problem":"kepler","scheme":{"id":"auto","keep":["nonsense"],"accuracy":1}})"}) {
    EXPECT_NE(fault("SimulateRequest", bad), "") << bad;
    EXPECT_EQ(ask(port(), post("/v1/simulate", bad)).status, 422) << bad;
  }
  const Reply refused = ask(port(), post("/v1/simulate", "{}"));
  EXPECT_EQ(Validator(document()).fault(schema("ProblemDocument"), Json::parse(refused.body)), "");
}

// Constants as text are allowed wherever numbers are.
TEST_F(OpenApi, TheSchemaTakesWhatTheServiceTakes) {
  const struct {
    const char *schema, *path, *request;
  } rows[] = {
      {"SimulateRequest", "/v1/simulate",
       R"({"problem":{"id":"kepler","mu":"2/2"},"scheme":{"id":"leapfrog","step":"1/100","composition":
           {"weights":["1/4","1/2","1/4"]}},"initial":{"x":"1","t":"0*pi"},"until":{"t":"pi"},
           "limits":{"seconds":"5","steps":"10^5","samples":"1000"},"record":{"times":["pi/4","pi/2"]},
           "section":{"period":"pi/3","phase":"1/2"},"sensitivities":{"by":["/initial/x"],"order":"1"},
           "events":[{"name":"a","expression":"x","stop":true}]})"},
      {"SimulateRequest", "/v1/simulate",
       R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":"2*5"},"record":{"samples":"3"},
           "events":[{"name":"a","expression":"x","set":{"px":"1"},"most":"3"}]})"},
      {"SimulateRequest", "/v1/simulate",
       R"({"problem":"figure_eight","scheme":"leapfrog","until":0.01,"columns":["t","x[*]"]})"},
      {"EnsembleRequest", "/v1/ensemble",
       R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":"10"},"range":["0","2"],"members":{"count":"4",
           "seed":"7","vary":{"/initial/x":{"uniform":["-1/8","1/8"]},"/problem/mu":{"grid":["1","2","4"]}}},
           "keep":["statistics"],"histograms":{"x":{"range":["-2*pi","2*pi"],"bins":"10"}}})"},
      {"StabilityRequest", "/v1/stability",
       R"({"problem":"harmonic_oscillator","schemes":["leapfrog"],"budget_seconds":"1/2"})"}};
  for (const auto& [name, path, request] : rows) {
    EXPECT_EQ(fault(name, request), "") << request;
    const Reply reply = ask(port(), post(path, request));
    EXPECT_EQ(reply.status, 200) << request << reply.body;
  }
  const char* const no_times = R"({"problem":"kepler","scheme":"leapfrog","record":{"times":[]}})";
  EXPECT_NE(fault("SimulateRequest", no_times), "");
  EXPECT_EQ(ask(port(), post("/v1/simulate", no_times)).status, 422);
}

// The schema fits answers without derivatives, too.
TEST_F(OpenApi, AnswersWithoutDerivativesFitTheirSchema) {
  const Reply reply =
      ask(port(), post("/v1/simulate", R"({"problem":{"id":"custom","variables":["x"],"potential":"-x^4"},
          "initial":{"x":1,"vx":1},"scheme":"taylor","until":100,"record":{"samples":3},
          "sensitivities":{"by":"initial","at":"samples"}})"));
  const Json made = Json::parse(reply.body);
  ASSERT_EQ(made["status"], "stopped") << reply.body;
  EXPECT_TRUE(made["sensitivities"]["structure"].is_null());
  EXPECT_EQ(Validator(document()).fault(schema("SimulateAnswer"), made), "");
}

// The document lists exactly those statuses that requests can cause.
TEST(OpenApiStatuses, AreThoseThatTheServiceSends) {
  Settings settings = quiet_settings();
  settings.caps.samples = 1000;
  settings.max_memory = 5'000'000;
  settings.bounds.head_time = settings.bounds.body_time = std::chrono::milliseconds(300);
  settings.bounds.stall = std::chrono::seconds(60);
  const std::string large(4'500'000, 'x');
  const Asset assets[] = {{"/index.html", "text/html", page_text}, {"/large.txt", "font/none", large}};
  Service service(settings, assets);
  ASSERT_FALSE(service.start());
  const Json document = Json::parse(ask(service.port(), get("/v1/openapi.json")).body);
  std::map<std::string, std::set<std::string>> told, sent;
  const auto bring_about = [&](const std::string& name, std::vector<std::string> requests) {
    std::vector<Client> clients;  // at once: some of them have to wait
    for (std::string& request : requests) {
      if (const auto hole = request.find("{id}"); hole != request.npos) request.replace(hole, 4, "kepler");
      clients.emplace_back(service.port()).send(request);
    }
    for (Client& client : clients) sent[name].insert(std::to_string(client.receive().value_or(Reply{}).status));
  };
  std::vector<std::pair<std::string, std::string>> operations;
  for (const auto& [path, methods] : document["paths"].items())
    for (const auto& [method, operation] : methods.items()) operations.emplace_back(path, method);
  for (const auto& [path, method] : operations) {
    const Json& operation = document["paths"][path][method];
    const bool posts = method == "post";
    const std::string name = (posts ? "POST " : "GET ") + path, line = name + " HTTP/1.1\r\nHost: localhost\r\n";
    for (const auto& [status, response] : operation["responses"].items()) told[name].insert(status);
    const auto with = [&](const std::string& field) { return line + field + "\r\nContent-Length: 2\r\n\r\n{}"; };
    std::vector<std::string> requests{line + "Content-Length: 2\r\n\r\n{",
                                      line + "\r\n",
                                      line + "Transfer-Encoding: gzip\r\n\r\n",
                                      line + "Content-Length: 123456789\r\n\r\n",
                                      name + '?' + std::string(10'000, 'x') + " HTTP/1.1\r\nHost: localhost\r\n\r\n",
                                      name + " HTTP/3.1\r\nHost: localhost\r\n\r\n"};
    for (const char* field : {"Host: twice", "Origin: https://not.example", "Accept: image/png", "If-None-Match: *",
                              "Range: bytes=99999999-", "Content-Encoding: gzip", "Expect: wonders"}) {
      requests.push_back(with(field));
    }
    requests.push_back(with("X-Long: " + std::string(100'000, 'x')));
    if (path.find("{id}") != path.npos) {
      std::string other = with("X-Other: 1");
      requests.push_back(other.replace(other.find("{id}"), 4, "no_such"));
    }
    if (path.find("/schemes/") != path.npos) {
      for (std::string& request : requests)
        if (const auto hole = request.find("{id}"); hole != request.npos) request.replace(hole, 4, "leapfrog");
    }
    bring_about(name, std::move(requests));
    if (posts) {
      const Json& examples = operation["requestBody"]["content"]["application/json"]["examples"];
      bring_about(name, {post(path, examples.front()["value"].dump())});
    }
  }
  Client reads_nothing(service.port());
  reads_nothing.send(get("/large.txt"));
  reads_nothing.peek();
  for (const auto& [name, statuses] : told) {
    const std::string body(900'000, ' ');
    bring_about(name, {name + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 900000\r\n\r\n" + body});
    sent[name].insert("500");  // no request brings that about
    EXPECT_EQ(sent[name], statuses) << name;
  }
}

}  // namespace
}  // namespace least::server::test

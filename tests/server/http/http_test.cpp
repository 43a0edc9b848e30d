// The endpoints over real sockets.
#include <gtest/gtest.h>

#include <thread>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using Http = Serving;

constexpr std::string_view kepler = R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1}})";

TEST_F(Http, ServesThePageWithAStrictPolicy) {
  for (const char* path : {"/", "/index.html"}) {
    const Reply page = ask(port(), get(path));
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.fields.at("content-type"), "text/html; charset=utf-8");
    EXPECT_EQ(page.body, page_text);
    const std::string policy = page.fields.at("content-security-policy");
    EXPECT_NE(policy.find("default-src 'self'"), std::string::npos);
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_EQ(page.fields.at("x-content-type-options"), "nosniff");
    EXPECT_EQ(page.fields.at("cache-control"), "no-cache");
    EXPECT_EQ(ask(port(), get(path, "If-None-Match: " + page.fields.at("etag") + "\r\n"), true).status, 304);
    EXPECT_EQ(ask(port(), get(path, "If-None-Match: *\r\n"), true).status, 304);
  }
  EXPECT_EQ(ask(port(), get("/page.js")).fields.at("content-type"), "text/javascript");
}

TEST_F(Http, DescribesItself) {
  const Json catalogue = Json::parse(ask(port(), get("/v1/catalogue")).body);
  for (const std::string kind : {"problems", "schemes"}) {
    ASSERT_FALSE(catalogue[kind].empty());
    for (const auto& card : catalogue[kind])
      EXPECT_EQ(Json::parse(ask(port(), get("/v1/" + kind + "/" + card["id"].get<std::string>())).body), card);
  }
  EXPECT_EQ(ask(port(), get("/healthz")).status, 200);
}

TEST_F(Http, ShowsTheWayFromAMistakenPath) {
  const auto detail = [&](std::string_view path) {
    return Json::parse(ask(port(), get(std::string(path))).body)["detail"].get<std::string>();
  };
  EXPECT_NE(detail("/v1/problems/keplr").find("did you mean \"/v1/problems/kepler\"?"), std::string::npos);
  EXPECT_NE(detail("/v1/schemes/rk4").find("did you mean \"/v1/schemes/runge_kutta_4\"?"), std::string::npos);
  EXPECT_NE(detail("/v1/problems/xyzzy").find("/v1/problems lists"), std::string::npos);
  EXPECT_NE(detail("/v1/simulat").find("did you mean \"/v1/simulate\"?"), std::string::npos);
  for (const std::string path : {"/v1/simulate", "/v1/ensemble", "/v1/stability", "/v1/work-precision"}) {
    const std::string words = detail(path);
    const auto from = words.find('{');
    ASSERT_NE(from, std::string::npos) << path << ": " << words;
    EXPECT_EQ(ask(port(), post(path, words.substr(from))).status, 200) << words;
  }
}

TEST_F(Http, HeadSaysWhatGetWouldWithoutTheBody) {
  for (const char* path : {"/", "/v1/catalogue", "/healthz"}) {
    Client client(port());
    const Reply whole = ask(port(), get(path));
    client.send("HEAD " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto head = client.receive(true);
    ASSERT_TRUE(head);
    EXPECT_EQ(head->status, 200);
    EXPECT_EQ(head->fields.at("content-length"), std::to_string(whole.body.size()));
    client.send(get("/healthz"));  // nothing is left over on the connection
    EXPECT_EQ(client.receive()->status, 200);
  }
}

TEST_F(Http, RunsWhateverTheContentType) {
  for (const char* type : {"application/json", "application/x-www-form-urlencoded", "text/plain", "multipart/form-data",
                           "multipart/form-data; boundary=x", "nonsense"}) {
    const Reply reply = ask(port(), post("/v1/simulate", kepler, "Content-Type: " + std::string(type) + "\r\n"));
    EXPECT_EQ(reply.status, 200) << type;
    EXPECT_EQ(Json::parse(reply.body)["status"], "completed");
  }
  EXPECT_EQ(ask(port(), post("/v1/simulate", kepler)).status, 200);
}

TEST_F(Http, TheEchoSentBackGivesTheSameBytes) {
  for (const char* text :
       {R"({"problem":"kepler","scheme":"leapfrog"})",
        R"({"problem":{"id":"kepler","mu":1.5},"initial":{"t":0.1},"scheme":{"id":"runge_kutta_4","step":0.03},
            "until":{"steps":77},"record":{"samples":9},"columns":["t","energy","x"]})",
        R"({"problem":"harmonic_oscillator","scheme":{"id":"leapfrog","step":0.1},"until":{"t":3.05},
            "record":{"times":[0.5,3.05]}})",
        R"({"problem":"harmonic_oscillator","scheme":"leapfrog","record":{"every":0}})"}) {
    Json first = Json::parse(ask(port(), post("/v1/simulate", text)).body);
    ASSERT_TRUE(first.contains("problem")) << text << first;
    Json request;
    for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits"}) {
      request[key] = first[key];
    }
    Json second = Json::parse(ask(port(), post("/v1/simulate", request.dump())).body);
    first.erase("cost");
    second.erase("cost");
    EXPECT_EQ(first.dump(), second.dump());
  }
}

// The answer's `diagnostics` are results: the diagnostics asked for are the only thing that the echo lacks.
TEST_F(Http, TheEchoOfARunWithDiagnosticsGivesTheSameRun) {
  for (const char* text :
       {R"({"problem":"kepler","scheme":"leapfrog","until":{"t":9.5},"diagnostics":["momenta","structure","error"]})",
        R"({"problem":"kepler","scheme":{"id":"jacobi_maupertuis","step":0.05},"until":{"t":9.5},"record":{"every":3},
            "columns":["t","x","mode","parameter"],"diagnostics":["energy","orbit"]})",
        R"({"problem":"kepler","scheme":{"id":"dormand_prince_5","tolerance":1e-9},"record":{"samples":50},
            "diagnostics":[],"limits":{"steps":40}})"}) {
    Json first = Json::parse(ask(port(), post("/v1/simulate", text)).body);
    ASSERT_TRUE(first.contains("problem")) << text << first;
    Json request;
    for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits"}) {
      request[key] = first[key];
    }
    const Json again = Json::parse(ask(port(), post("/v1/simulate", request.dump())).body);
    for (const char* key : {"status", "trajectory", "final", "events"}) EXPECT_EQ(again.at(key), first.at(key)) << text;
    EXPECT_EQ(again.at("cost").at("steps"), first.at("cost").at("steps"));
    request["diagnostics"] = Json::array();
    for (const auto& [name, result] : first["diagnostics"].items()) request["diagnostics"].push_back(name);
    Json whole = Json::parse(ask(port(), post("/v1/simulate", request.dump())).body);
    first.erase("cost");
    whole.erase("cost");
    EXPECT_EQ(whole.dump(), first.dump());
  }
}

TEST_F(Http, CsvHoldsTheSameNumbers) {
  const std::string request = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":3}})";
  const Json json = Json::parse(ask(port(), post("/v1/simulate", request)).body);
  const Reply csv = ask(port(), post("/v1/simulate", request, "Accept: text/csv\r\n"));
  EXPECT_EQ(csv.fields.at("content-type").substr(0, 8), "text/csv");
  EXPECT_EQ(csv.fields.at("leastaction-status"), "completed");
  EXPECT_EQ(Json::parse(csv.fields.at("leastaction-final")), json["final"]);
  EXPECT_EQ(Json::parse(csv.fields.at("leastaction-diagnostics")), json["diagnostics"]);
  std::string expected = "t,x,y,px,py\n";
  for (std::size_t i = 0; i < 4; ++i) {
    for (const char* column : {"t", "x", "y", "px", "py"}) {
      expected += json["trajectory"][column][i].dump() + (std::string_view(column) == "py" ? "\n" : ",");
    }
  }
  // nlohmann writes 20.0 and 1e-05 where the service writes 20 and 1e-05: compare numbers, not letters
  const auto numbers = [](const std::string& text) {
    std::vector<double> all;
    for (std::size_t at = text.find('\n') + 1; at < text.size();) {
      const auto end = text.find_first_of(",\n", at);
      all.push_back(std::stod(text.substr(at, end - at)));
      at = end + 1;
    }
    return all;
  };
  EXPECT_EQ(csv.body.substr(0, 12), expected.substr(0, 12));
  EXPECT_EQ(numbers(csv.body), numbers(expected));
}

struct Case {
  const char* name;
  std::string request;
  int status;
  std::string (*large)() = nullptr;  // written when it is sent, as every test process lists all cases
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
class HttpError : public Serving, public testing::WithParamInterface<Case> {};
TEST_P(HttpError, IsAProblemDocument) {
  Client client(port());
  client.send(GetParam().large ? GetParam().large() : GetParam().request);
  const auto reply = client.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, GetParam().status);
  EXPECT_EQ(reply->fields.at("content-type"), "application/problem+json");
  const Json document = Json::parse(reply->body);
  EXPECT_EQ(document.at("status"), GetParam().status);
  EXPECT_EQ(document.at("request_id"), reply->fields.at("x-request-id"));
  EXPECT_FALSE(document.at("title").get<std::string>().empty());
  EXPECT_EQ(document.at("type").get<std::string>().find("/errors/"), 0u);
}

std::string chunked(std::string_view path, std::string_view chunks, std::string_view fields = "") {
  return "POST " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n" +
         std::string(fields) + "\r\n" + std::string(chunks);
}

std::string raw(std::string_view line, std::string_view fields = "Host: localhost\r\n") {
  return std::string(line) + "\r\n" + std::string(fields) + "\r\n";
}

INSTANTIATE_TEST_SUITE_P(
    All, HttpError,
    testing::Values(
        Case{"nowhere", get("/v1/nowhere"), 404}, Case{"study_get", get("/v1/work-precision"), 405},
        Case{"study_csv", post("/v1/work-precision", "{}", "Accept: text/csv\r\n"), 406},
        Case{"study_no_json", post("/v1/work-precision", "{"), 400},
        Case{"study_faults", post("/v1/work-precision", "{}"), 422},
        Case{"study_lines_faults", post("/v1/work-precision", "{}", "Accept: application/x-ndjson\r\n"), 422},
        Case{"study_no_length", raw("POST /v1/work-precision HTTP/1.1"), 411},
        Case{"study_large", raw("POST /v1/work-precision HTTP/1.1", "Host: localhost\r\nContent-Length: 1048577\r\n"),
             413},
        Case{"stability_get", get("/v1/stability"), 405}, Case{"stability_faults", post("/v1/stability", "{}"), 422},
        Case{"stability_ndjson", post("/v1/stability", "{}", "Accept: application/x-ndjson\r\n"), 406},
        Case{"stability_no_json", post("/v1/stability", "[1,"), 400}, Case{"problem", get("/v1/problems/keplr"), 404},
        Case{"up", get("/../etc/passwd"), 404}, Case{"get", get("/v1/simulate"), 405},
        Case{"post", post("/v1/catalogue", "{}"), 405},
        Case{"put", raw("PUT /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 0\r\n"), 405},
        Case{"bare_put", raw("PUT /v1/simulate HTTP/1.1"), 405}, Case{"bare_post", raw("POST /nowhere HTTP/1.1"), 404},
        Case{"trace", raw("TRACE / HTTP/1.1"), 405}, Case{"unknown_method", raw("BREW / HTTP/1.1"), 405},
        Case{"xml", post("/v1/simulate", kepler, "Accept: application/xml\r\n"), 406},
        Case{"catalogue_csv", get("/v1/catalogue", "Accept: text/csv\r\n"), 406},
        Case{"no_json", post("/v1/simulate", R"({"problem":)"), 400}, Case{"empty", post("/v1/simulate", ""), 400},
        Case{"utf8", post("/v1/simulate", "{\"problem\":\"\xFF\"}"), 400},
        Case{"faults", post("/v1/simulate", "{}"), 422},
        Case{"deep", "", 422, [] { return post("/v1/simulate", std::string(500'000, '[')); }},
        Case{"deep_object", "", 422,
             [] {
               std::string bomb;
               for (int i = 0; i < 100'000; ++i) bomb += "{\"a\":";
               return post("/v1/simulate", bomb);
             }},
        Case{"many_keys", "", 422,
             [] {
               std::string keys = "{\"a0\":0";
               for (int i = 1; i < 60'000; ++i) keys += ",\"a" + std::to_string(i) + "\":0";
               return post("/v1/simulate", keys + "}");
             }},
        Case{"no_length", raw("POST /v1/simulate HTTP/1.1"), 411},
        Case{"large", raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 1048577\r\n"), 413},
        Case{"huge",
             raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 99999999999999999999999\r\n"), 413},
        Case{"large_chunk", chunked("/v1/simulate", "fffffff\r\n"), 413},
        Case{"huge_chunk", chunked("/v1/simulate", "fffffffffffffffff\r\n"), 413},
        Case{"gzip", post("/v1/simulate", "x", "Content-Encoding: gzip\r\n"), 415},
        Case{"expect", post("/v1/simulate", "{}", "Expect: miracles\r\n"), 417},
        Case{"long_target", get("/" + std::string(9000, 'a')), 414},
        Case{"long_field", get("/", "X: " + std::string(40'000, 'a') + "\r\n"), 431},
        Case{"long_line", "GET /" + std::string(100'000, 'a'), 431},
        Case{"many_fields",
             get("/",
                 [] {
                   std::string fields;
                   for (int i = 0; i < 101; ++i) fields += "X: y\r\n";
                   return fields;
                 }()),
             431},
        Case{"foreign_host", raw("GET / HTTP/1.1", "Host: evil.example\r\n"), 403},
        Case{"lookalike_host", raw("GET / HTTP/1.1", "Host: localhost.evil.example:80\r\n"), 403},
        Case{"foreign_origin", post("/v1/simulate", kepler, "Origin: http://evil.example\r\n"), 403},
        Case{"null_origin", post("/v1/simulate", kepler, "Origin: null\r\n"), 403},
        Case{"lookalike_origin", post("/v1/simulate", kepler, "Origin: http://localhost.evil.example\r\n"), 403},
        Case{"other_port", post("/v1/simulate", kepler, "Origin: http://localhost:1\r\n"), 403},
        Case{"no_host", raw("GET / HTTP/1.1", ""), 400},
        Case{"two_hosts", raw("GET / HTTP/1.1", "Host: localhost\r\nHost: localhost\r\n"), 400},
        Case{"garbage", "\x16\x03\x01 hello\r\n\r\n", 400}, Case{"http2", raw("PRI * HTTP/2.0"), 505},
        Case{"http09", "GET /\r\n\r\n", 400}, Case{"absolute", raw("GET http://evil.example/ HTTP/1.1"), 403},
        Case{"control", raw("GET /\x01 HTTP/1.1"), 400}, Case{"space", raw("GET / x HTTP/1.1"), 400},
        Case{"folded", raw("GET / HTTP/1.1", "Host: localhost\r\n folded\r\n"), 400},
        Case{"space_in_name", raw("GET / HTTP/1.1", "Host : localhost\r\n"), 400},
        Case{"bare_line_feed", raw("GET / HTTP/1.1", "Host: localhost\nX: y\r\n"), 400},
        Case{"two_lengths",
             raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 2\r\nContent-Length: 3\r\n"), 400},
        Case{"length_beside_none",
             raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length:\r\nContent-Length: 2\r\n"), 400},
        Case{"negative_length", raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: -1\r\n"), 400},
        Case{"length_list", raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 2, 2\r\n"), 400},
        Case{"smuggled", chunked("/v1/nowhere", "0\r\n\r\n", "Content-Length: 5\r\n"), 400},
        Case{"gzip_coding",
             raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nTransfer-Encoding: gzip, chunked\r\n"), 501},
        Case{"no_chunk", chunked("/v1/nowhere", "zz\r\n"), 400},
        Case{"short_chunk", chunked("/v1/nowhere", "1\r\n{}\r\n0\r\n\r\n"), 400}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(Http, TellsWhatIsAllowed) {
  EXPECT_EQ(ask(port(), get("/v1/simulate")).fields.at("allow"), "POST, OPTIONS");
  EXPECT_EQ(ask(port(), post("/", "")).fields.at("allow"), "GET, HEAD, OPTIONS");
  EXPECT_EQ(ask(port(), post("/v1/simulate", "{]")).body.find("byte 1") != std::string::npos, true);
}

TEST_F(Http, AcceptsItsOwnNamesAndOrigins) {
  for (const char* host :
       {"localhost", "LOCALHOST:80", "127.0.0.1", "127.0.0.1:1", "[::1]", "[::1]:8080", "named.example"}) {
    EXPECT_EQ(ask(port(), raw("GET /healthz HTTP/1.1", "Host: " + std::string(host) + "\r\n")).status, 200) << host;
  }
  EXPECT_EQ(ask(port(), post("/v1/simulate", kepler, "Origin: http://localhost\r\n")).status, 200);
  const Reply foreign = ask(port(), post("/v1/simulate", kepler, "Origin: https://friend.example\r\n"));
  EXPECT_EQ(foreign.status, 200);
  EXPECT_EQ(foreign.fields.at("access-control-allow-origin"), "https://friend.example");
  EXPECT_EQ(ask(port(), post("/v1/simulate", kepler)).fields.count("access-control-allow-origin"), 0u);
  EXPECT_EQ(
      ask(port(), raw("OPTIONS /v1/simulate HTTP/1.1", "Host: localhost\r\nOrigin: https://friend.example\r\n")).status,
      204);
}

TEST_F(Http, ReadsChunksAndRequestsSentAhead) {
  std::string pieces;
  for (std::size_t i = 0; i < kepler.size(); i += 7) {
    const auto piece = kepler.substr(i, 7);
    pieces += std::to_string(piece.size()) + ";x=y\r\n" + std::string(piece) + "\r\n";
  }
  Client client(port());
  client.send(chunked("/v1/simulate", pieces + "0\r\nTrailer: x\r\n\r\n") + get("/healthz") + "\r\n" +
              post("/v1/simulate", "{}") + get("/nowhere"));
  EXPECT_EQ(client.receive()->status, 200);
  EXPECT_EQ(client.receive()->status, 200);
  EXPECT_EQ(client.receive()->status, 422);
  EXPECT_EQ(client.receive()->status, 404);
}

TEST_F(Http, ReadsARequestThatComesByteByByte) {
  Client client(port());
  for (const char c : post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":2}})")) {
    client.send({&c, 1});
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  EXPECT_EQ(client.receive()->status, 200);
}

TEST_F(Http, ARefusedBodyIsNotTakenForTheNextRequest) {
  const std::string hidden = get("/healthz");
  for (const std::string& request :
       {chunked("/v1/simulate", "200000\r\n" + hidden + hidden),
        raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 2000000\r\n") + hidden,
        post("/v1/simulate", hidden, "Content-Encoding: gzip\r\n"),
        raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\n") + hidden}) {
    Client client(port());
    client.send(request);
    const auto reply = client.receive();
    ASSERT_TRUE(reply);
    EXPECT_GE(reply->status, 400);
    EXPECT_EQ(reply->fields.at("connection"), "close");
    EXPECT_TRUE(client.ended()) << request;
  }
  // The body of a GET, or of a request with an unknown path, belongs to that request.
  Client client(port());
  client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(hidden.size()) +
              "\r\n\r\n" + hidden + post("/nowhere", hidden) + get("/v1/simulate"));
  EXPECT_EQ(client.receive()->status, 200);
  EXPECT_EQ(client.receive()->status, 404);
  EXPECT_EQ(client.receive()->status, 405);
}

TEST_F(Http, AClientThatStillSendsReadsWhyItWasRefused) {
  Client client(port());
  client.send(raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nContent-Length: 8000000\r\n"));
  EXPECT_TRUE(client.send(std::string(8'000'000, ' ')));
  EXPECT_EQ(client.receive().value_or(Reply{}).status, 413);
  EXPECT_TRUE(client.ended());  // in order, not by a reset
}

TEST_F(Http, ABodyIsAskedForOnlyWhereItIsWanted) {
  Client good(port());
  good.send(raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nExpect: 100-continue\r\nContent-Length: " +
                                                  std::to_string(kepler.size()) + "\r\n"));
  EXPECT_EQ(good.interim(), 100);
  good.send(kepler);
  EXPECT_EQ(good.receive().value_or(Reply{}).status, 200);
  Client large(port());
  large.send(
      raw("POST /v1/simulate HTTP/1.1", "Host: localhost\r\nExpect: 100-continue\r\nContent-Length: 2000000\r\n"));
  EXPECT_EQ(large.receive().value_or(Reply{}).status, 413);
}

TEST_F(Http, APartIsTheWholeUnlessItLiesBeyondTheEnd) {
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 500; ++i) ranges += ",0-";
  EXPECT_EQ(ask(port(), get("/", ranges + "\r\n")).body, page_text);
  const Reply beyond = ask(port(), get("/", "Range: bytes=" + std::to_string(page_text.size()) + "-\r\n"));
  EXPECT_EQ(beyond.status, 416);
  EXPECT_EQ(beyond.fields.at("content-range"), "bytes */" + std::to_string(page_text.size()));
  EXPECT_EQ(ask(port(), get("/", "Range: bytes=99999999999999999999-\r\n")).status, 416);
  EXPECT_EQ(ask(port(), get("/", "If-Range: \"old\"\r\nRange: bytes=999999-\r\n")).status, 200);
}

TEST_F(Http, ConnectionsLastAsTheClientAsks) {
  Client once(port());
  once.send(get("/healthz", "Connection: close\r\n"));
  EXPECT_EQ(once.receive()->fields.at("connection"), "close");
  EXPECT_TRUE(once.ended());
  Client old(port());
  old.send("GET /healthz HTTP/1.0\r\n\r\n");
  EXPECT_EQ(old.receive()->status, 200);
  EXPECT_TRUE(old.ended());
  Client many(port());
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(many.send(get("/healthz")));
    ASSERT_EQ(many.receive()->status, 200) << i;
  }
}

TEST_F(Http, RequestIdsAreUnique) {
  const auto id = [&] { return ask(port(), get("/healthz")).fields.at("x-request-id"); };
  EXPECT_NE(id(), id());
}

}  // namespace
}  // namespace least::server::test

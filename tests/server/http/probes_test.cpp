// What the service reports about itself, and the fields of every answer.
#include <gtest/gtest.h>
#include <zlib.h>

#include <ctime>
#include <regex>
#include <thread>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

class Probes : public Serving {};

constexpr std::string_view short_request = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})";
constexpr std::string_view endless_request =
    R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
        "record":{"every":0},"limits":{"steps":10000000000,"seconds":20}})";

// metric() returns the value of a line of the metrics; -1 where there is none.
double metric(const std::string& text, const std::string& name) {
  const auto at = ("\n" + text).find("\n" + name + " ");
  return at == std::string::npos ? -1 : std::stod(text.substr(at + name.size() + 1));
}

TEST_F(Probes, ListsAreIdsWithTitlesAndLinksThatLead) {
  const Json catalogue = Json::parse(ask(port(), get("/v1/catalogue")).body);
  for (const std::string kind : {"problems", "schemes"}) {
    const Json list = Json::parse(ask(port(), get("/v1/" + kind)).body);
    ASSERT_EQ(list.size(), 1u);
    ASSERT_EQ(list[kind].size(), catalogue[kind].size());
    for (std::size_t i = 0; i < list[kind].size(); ++i) {
      const Json& entry = list[kind][i];
      EXPECT_EQ(entry["id"], catalogue[kind][i]["id"]);
      EXPECT_EQ(entry["title"], catalogue[kind][i]["title"]);
      EXPECT_EQ(Json::parse(ask(port(), get(entry["href"].get<std::string>())).body), catalogue[kind][i]);
    }
  }
  const Json index = Json::parse(ask(port(), get("/v1")).body);
  EXPECT_GE(index["endpoints"].size(), 10u);
  for (const Json& endpoint : index["endpoints"]) {
    std::string path = endpoint["href"];
    const std::string id = path.find("problems") != path.npos ? "kepler" : "leapfrog";
    if (const auto hole = path.find("{id}"); hole != path.npos) path.replace(hole, 4, id);
    const bool computes = endpoint["method"] == "POST";
    EXPECT_EQ(ask(port(), computes ? post(path, "{}") : get(path)).status, computes ? 422 : 200) << path;
  }
}

TEST_F(Probes, AreAnsweredWhateverTheHost) {
  for (const char* path : {"/healthz", "/readyz", "/metrics"}) {
    for (const char* host : {"10.0.0.7:8080", "leastaction.default.svc", "[fd00::1]:8080"}) {
      const std::string request = "GET " + std::string(path) + " HTTP/1.1\r\nHost: " + host + "\r\n";
      EXPECT_EQ(ask(port(), request + "\r\n").status, 200) << path << host;
      EXPECT_EQ(ask(port(), request + "Origin: http://evil.example\r\n\r\n").status, 403) << path << host;
    }
    EXPECT_EQ(ask(port(), post(path, "")).status, 405);
  }
  EXPECT_EQ(ask(port(), "GET /v1 HTTP/1.1\r\nHost: 10.0.0.7:8080\r\n\r\n").status, 403);
}

TEST_F(Probes, WhatStandsOnEveryAnswer) {
  const std::regex date("(Mon|Tue|Wed|Thu|Fri|Sat|Sun), \\d\\d [A-Z][a-z]{2} 20\\d\\d \\d\\d:\\d\\d:\\d\\d GMT");
  const std::regex timing("compute;dur=\\d+\\.\\d+");
  for (const std::string& request :
       {get("/"), get("/v1/catalogue"), get("/healthz"), get("/nowhere"), post("/v1/simulate", short_request),
        post("/v1/simulate", short_request, "Accept: application/x-ndjson\r\n"), post("/v1/simulate", "{"),
        post("/v1/stability", "{}"), std::string("GET / HTTP/1.1\r\n\r\n"), std::string("GET / HTTP/3.0\r\n\r\n"),
        std::string("OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n")}) {
    const Reply reply = ask(port(), request);
    ASSERT_NE(reply.status, 0) << request;
    EXPECT_TRUE(std::regex_match(reply.fields.at("date"), date)) << request << reply.fields.at("date");
    EXPECT_TRUE(std::regex_match(reply.fields.at("server-timing"), timing)) << request;
    EXPECT_TRUE(reply.fields.contains("x-request-id")) << request;
    EXPECT_TRUE(reply.status == 204 || reply.fields.contains("content-length") ||
                reply.fields.contains("transfer-encoding"))
        << request;
    std::tm told{};
    ::strptime(reply.fields.at("date").c_str(), "%a, %d %b %Y %H:%M:%S", &told);
    EXPECT_LT(std::abs(std::difftime(::timegm(&told), std::time(nullptr))), 5);
  }
  const Reply run =
      ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":2000000},
    "record":{"every":0}})"));
  const double told = std::stod(run.fields.at("server-timing").substr(12)) * 1e-3;
  EXPECT_GE(told, Json::parse(run.body)["cost"]["seconds"].get<double>());
}

TEST_F(Probes, MetricsCountWhatHappens) {
  const auto ask_metrics = [] { return ask(port(), get("/metrics")).body; };
  const std::string before = ask_metrics();
  EXPECT_EQ(before.find("# HELP leastaction_build_info"), 0u);
  for (int i = 0; i < 3; ++i) ask(port(), post("/v1/simulate", short_request));
  ask(port(), get("/nowhere/1"));
  ask(port(), get("/nowhere/2"));
  const std::string after = ask_metrics();
  const auto grown = [&](const std::string& name) { return metric(after, name) - std::max(metric(before, name), 0.0); };
  EXPECT_EQ(grown(R"(leastaction_requests_total{route="/v1/simulate",status="200"})"), 3);
  EXPECT_EQ(grown(R"(leastaction_requests_total{route="unmatched",status="404"})"), 2);
  EXPECT_EQ(grown("leastaction_run_seconds_count"), 3);
  EXPECT_EQ(grown("leastaction_queue_seconds_count"), 3);
  EXPECT_EQ(grown(R"(leastaction_run_seconds_bucket{le="+Inf"})"), 3);
  EXPECT_GT(grown("leastaction_run_seconds_sum"), 0);
  EXPECT_EQ(grown(R"(leastaction_runs_total{endpoint="/v1/simulate",scheme="leapfrog"})"), 3);
  for (const char* name : {"leastaction_connections", "leastaction_max_running", "leastaction_max_waiting",
                           "leastaction_max_connections", "leastaction_max_held_bytes", "process_resident_memory_bytes",
                           "process_cpu_seconds_total", "process_open_fds"}) {
    EXPECT_GT(metric(after, name), 0) << name;
  }
  EXPECT_LT(std::abs(metric(after, "process_start_time_seconds") - static_cast<double>(std::time(nullptr))), 3600);
  for (const char* name :
       {"leastaction_running", "leastaction_parked", "leastaction_waiting", "leastaction_cancelled_total",
        "leastaction_rejected_total", "leastaction_held_bytes", "leastaction_dropped_log_lines_total"}) {
    EXPECT_EQ(metric(after, name), 0) << name;
  }
  // Every line is a comment or a sample, as Prometheus reads them.
  const std::regex line(
      R"re((# (HELP|TYPE) (leastaction|process)_\w+ .+|(leastaction|process)_\w+(\{\w+="[^"]*"(,\w+="[^"]*")*\})? [0-9.e+-]+)\n)re");
  std::string rest = after;
  for (std::smatch match; std::regex_search(rest, match, line, std::regex_constants::match_continuous);) {
    rest = match.suffix();
  }
  EXPECT_EQ(rest, "");
}

TEST_F(Probes, StudiesAreCountedAndFilesAreOneRoute) {
  ask(port(), get("/page.js"));
  ask(port(), get("/"));
  ask(port(), post("/v1/stability", R"({"problem":"harmonic_oscillator","schemes":["leapfrog"]})"));
  const std::string text = ask(port(), get("/metrics")).body;
  EXPECT_GE(metric(text, R"(leastaction_requests_total{route="/{file}",status="200"})"), 2);
  EXPECT_EQ(text.find("page.js"), std::string::npos);
  EXPECT_GE(metric(text, R"(leastaction_runs_total{endpoint="/v1/stability",scheme="several"})"), 1);
}

// The field Vary tells caches that a compressed answer is not for every client.
TEST_F(Probes, ThatArePackedSaySo) {
  const Reply reply = ask(port(), get("/metrics", "Accept-Encoding: gzip\r\n"));
  EXPECT_EQ(reply.fields.at("content-encoding"), "gzip");
  EXPECT_EQ(reply.fields.at("vary"), "Accept-Encoding");
  EXPECT_EQ(ask(port(), get("/metrics")).fields.at("vary"), "Accept-Encoding");
}

TEST(Metrics, StandAtAPortOfTheirOwnWhereAsked) {
  Settings settings = quiet_settings();
  settings.metrics_port = 0;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  ASSERT_NE(service.metrics_port(), service.port());
  EXPECT_EQ(ask(service.port(), get("/metrics")).status, 404);
  EXPECT_EQ(ask(service.port(), get("/healthz")).status, 200);
  const Reply reply = ask(service.metrics_port(), "GET /metrics HTTP/1.1\r\nHost: 10.0.0.7\r\n\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(metric(reply.body, "leastaction_running"), 0);
  for (const auto& request : {get("/"), get("/healthz"), post("/v1/simulate", short_request)})
    EXPECT_EQ(ask(service.metrics_port(), request).status, 404);
}

TEST(Readiness, IsLostWithAFullQueue) {
  Settings settings = quiet_settings();
  settings.threads = 1;
  settings.queue = 0;
  settings.grace = 0;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  EXPECT_EQ(ask(service.port(), get("/readyz")).status, 200);
  Client busy(service.port());
  busy.send(post("/v1/simulate", endless_request));
  std::this_thread::sleep_for(400ms);
  const Reply reply = ask(service.port(), get("/readyz"));
  EXPECT_EQ(reply.status, 503);
  EXPECT_NE(reply.body.find("queue is full"), std::string::npos);
  EXPECT_EQ(ask(service.port(), get("/healthz")).status, 200);
  const std::string metrics = ask(service.port(), get("/metrics")).body;
  EXPECT_EQ(metric(metrics, "leastaction_running"), 1);
  EXPECT_EQ(ask(service.port(), post("/v1/simulate", short_request)).status, 503);
  EXPECT_EQ(metric(ask(service.port(), get("/metrics")).body, "leastaction_rejected_total"), 1);
}

TEST(Readiness, IsLostWhileTheServiceEnds) {
  Settings settings = quiet_settings();
  settings.grace = 3;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  Client kept(service.port()), busy(service.port());
  kept.send(get("/readyz").substr(0, 30));  // a request under way keeps its connection
  busy.send(post("/v1/simulate", endless_request));
  std::this_thread::sleep_for(300ms);
  std::jthread end([&] { service.stop(); });
  std::this_thread::sleep_for(300ms);
  kept.send(get("/readyz").substr(30));
  const auto reply = kept.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 503);
  EXPECT_NE(reply->body.find("ends"), std::string::npos);
}

std::string unpacked(const std::string& packed) {
  z_stream stream{};
  EXPECT_EQ(::inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string text;
  int status = Z_OK;
  while (status == Z_OK) {
    char block[65536];
    stream.next_out = reinterpret_cast<Bytef*>(block);
    stream.avail_out = sizeof block;
    status = ::inflate(&stream, Z_NO_FLUSH);
    text.append(block, sizeof block - stream.avail_out);
  }
  EXPECT_EQ(status, Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0u);
  ::inflateEnd(&stream);
  return text;
}

TEST_F(Probes, AnswersArePackedForWhoAsks) {
  const std::string plain = ask(port(), get("/v1/catalogue")).body;
  for (const char* wish : {"gzip", "deflate, gzip;q=0.5", "*", "gzip, deflate, br, zstd"}) {
    const Reply reply = ask(port(), get("/v1/catalogue", "Accept-Encoding: " + std::string(wish) + "\r\n"));
    EXPECT_EQ(reply.fields.at("content-encoding"), "gzip") << wish;
    EXPECT_NE(reply.fields.at("vary").find("Accept-Encoding"), std::string::npos);
    EXPECT_EQ(unpacked(reply.body), plain);
    EXPECT_LT(reply.body.size(), plain.size() / 3);
    const std::string tag = reply.fields.at("etag");
    EXPECT_EQ(ask(port(), get("/v1/catalogue", "Accept-Encoding: gzip\r\nIf-None-Match: " + tag + "\r\n"), true).status,
              304);
    EXPECT_NE(tag, ask(port(), get("/v1/catalogue")).fields.at("etag"));
  }
  for (const char* wish : {"identity", "br", "gzip;q=0", "gzip;q=0.1, identity"}) {
    const Reply reply = ask(port(), get("/v1/catalogue", "Accept-Encoding: " + std::string(wish) + "\r\n"));
    EXPECT_FALSE(reply.fields.contains("content-encoding")) << wish;
    EXPECT_EQ(reply.body, plain);
  }
  EXPECT_FALSE(ask(port(), get("/healthz", "Accept-Encoding: gzip\r\n")).fields.contains("content-encoding"));
  const std::string request = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":500}})";
  Json whole = Json::parse(ask(port(), post("/v1/simulate", request)).body);
  const Reply packed = ask(port(), post("/v1/simulate", request, "Accept-Encoding: gzip\r\n"));
  EXPECT_EQ(packed.fields.at("content-encoding"), "gzip");
  Json same = Json::parse(unpacked(packed.body));
  whole.erase("cost");
  same.erase("cost");
  EXPECT_EQ(same, whole);
}

// A stream is compressed piece by piece: each piece can be read when it comes.
TEST_F(Probes, StreamsArePackedPieceByPiece) {
  Client client(port());
  client.send(post("/v1/work-precision",
                   R"({"problem":"kepler","until":{"t":20},"schemes":["leapfrog"],"budget_seconds":2})",
                   "Accept: application/x-ndjson\r\nAccept-Encoding: gzip\r\n"));
  const auto reply = client.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->fields.at("content-encoding"), "gzip");
  ASSERT_GT(reply->chunks.size(), 2u);
  z_stream stream{};
  ASSERT_EQ(::inflateInit2(&stream, 15 + 16), Z_OK);
  char block[65536];
  std::string first = reply->chunks[0];
  stream.next_in = reinterpret_cast<Bytef*>(first.data());
  stream.avail_in = static_cast<uInt>(first.size());
  stream.next_out = reinterpret_cast<Bytef*>(block);
  stream.avail_out = sizeof block;
  EXPECT_EQ(::inflate(&stream, Z_NO_FLUSH), Z_OK);
  ::inflateEnd(&stream);
  const std::string line(block, sizeof block - stream.avail_out);
  EXPECT_TRUE(line.ends_with("}\n")) << line;
  EXPECT_TRUE(unpacked(reply->body).starts_with(line));
}

// The service says that it is not ready any more, and goes on as before until its port closes.
TEST(Readiness, IsLostBeforeThePortCloses) {
  Settings settings = quiet_settings();
  settings.drain = 30;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const int port = service.port();
  Client kept(port);
  kept.send(get("/healthz"));
  EXPECT_EQ(kept.receive().value_or(Reply{}).fields["connection"], "keep-alive");
  std::jthread end([&] { service.stop(); });
  while (ask(port, get("/readyz")).status == 200) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(ask(port, get("/readyz")).status, 503);
  const Reply run = ask(port, post("/v1/simulate", short_request));
  EXPECT_EQ(run.status, 200);
  EXPECT_EQ(run.fields.at("connection"), "close") << "so that nobody asks by a connection that ends";
  kept.send(post("/v1/simulate", short_request));
  EXPECT_EQ(kept.receive().value_or(Reply{}).status, 200);
  service.hurry();
}

// The refusal is readable for a person with a browser.
TEST_F(Probes, AHostThatIsUnknownIsToldWhatToDo) {
  const auto asked_by = [](const std::string& host, const std::string& accept) {
    return ask(port(), "GET / HTTP/1.1\r\nHost: " + host + "\r\nAccept: " + accept + "\r\n\r\n");
  };
  const Reply page = asked_by("LabServer:8080", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8");
  EXPECT_EQ(page.status, 403);
  EXPECT_EQ(page.fields.at("content-type"), "text/html; charset=utf-8");
  EXPECT_NE(page.body.find("--allow-host labserver"), std::string::npos) << page.body;
  const Reply problem = asked_by("labserver:8080", "*/*");
  EXPECT_EQ(problem.fields.at("content-type"), "application/problem+json");
  EXPECT_NE(Json::parse(problem.body)["detail"].get<std::string>().find("--allow-host labserver"), std::string::npos);
  EXPECT_EQ(asked_by("<script>alert(1)</script>", "text/html").body.find("<script"), std::string::npos);
}

// An empty name in the list allows nothing, not requests without a host.
TEST(Hosts, AnEmptyNameIsNobodys) {
  Settings settings = quiet_settings();
  settings.allow_hosts = {""};
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  for (const char* host : {"localhost:evil.com", "localhost:80:80", "localhost:123456", "", ":80"})
    EXPECT_EQ(ask(service.port(), "GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n").status, 403) << host;
  EXPECT_EQ(ask(service.port(), get("/")).status, 200);
}

TEST_F(Probes, TargetsOfEveryFormAreTaken) {
  const auto line = [](const std::string& first, const std::string& host = "localhost") {
    return first + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
  };
  EXPECT_EQ(ask(port(), line("GET http://localhost:8080/healthz")).status, 200);
  EXPECT_EQ(ask(port(), line("GET HTTP://localhost/v1/catalogue?x")).status, 200);
  EXPECT_EQ(ask(port(), line("GET http://localhost")).body, page_text);
  // The target's authority counts, not Host (RFC 9112, 3.2.2).
  EXPECT_EQ(ask(port(), line("GET http://evil.example/v1")).status, 403);
  EXPECT_EQ(ask(port(), line("GET http://localhost/v1", "evil.example")).status, 200);
  // It counts also in the comparison with the page's own origin.
  EXPECT_EQ(ask(port(), line("GET http://localhost/v1", "evil.example\r\nOrigin: http://localhost")).status, 200);
  EXPECT_EQ(ask(port(), line("GET http://localhost/v1", "evil.example\r\nOrigin: http://evil.example")).status, 403);
  EXPECT_EQ(ask(port(), line("GET ftp://localhost/v1")).status, 400);
  EXPECT_EQ(ask(port(), line("GET http:///v1")).status, 400);
  const Reply all = ask(port(), line("OPTIONS *"));
  EXPECT_EQ(all.status, 204);
  EXPECT_NE(all.fields.at("allow").find("POST"), std::string::npos);
  EXPECT_EQ(ask(port(), line("GET *")).status, 400);
  for (const char* host : {"localhost:evil.com", "localhost:80:80", "localhost:123456", "localhost:80a"}) {
    EXPECT_EQ(ask(port(), line("GET /", host)).status, 403) << host;
  }
}

// Bytes that cannot become a request are refused at once, not when their time is over.
TEST_F(Probes, WhatIsNoRequestIsRefusedAtOnce) {
  for (const std::string& bytes :
       {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
        std::string("GET / HTTP/1.1\nHost: localhost\n"), std::string("GET / HTTP/1.1\r\nHost: localhost\nX: y"),
        std::string("\n"), std::string("\x80\x2e\x01"), std::string("{\"problem\"")}) {
    const auto from = std::chrono::steady_clock::now();
    Client client(port());
    client.send(bytes);
    const auto reply = client.receive();
    EXPECT_EQ(reply.value_or(Reply{}).status, 400) << bytes;
    EXPECT_LT(std::chrono::steady_clock::now() - from, 3s) << bytes;
    EXPECT_TRUE(client.ended());
  }
  EXPECT_NE(ask(port(), "\x16\x03\x01").body.find("TLS"), std::string::npos);
}

TEST_F(Probes, ALineFeedAloneEndsNoChunkLine) {
  const auto chunked = [](const std::string& chunks) {
    return "POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n" + chunks;
  };
  EXPECT_EQ(ask(port(), chunked("2;x=y\r\n{}\r\n0\r\n\r\n")).status, 422);
  EXPECT_EQ(ask(port(), chunked("2;x\n\r\n{}\r\n0\r\n\r\n")).status, 400);
  EXPECT_EQ(ask(port(), chunked("2;x\ny\r\n{}\r\n0\r\n\r\n")).status, 400);
}

TEST_F(Probes, ARefusedHeadHasNoBody) {
  for (const char* request : {"HEAD / HTTP/1.1\r\n\r\n", "HEAD / HTTP/9.9\r\nHost: localhost\r\n\r\n",
                              "HEAD / HTTP/1.1\r\nHost: localhost\r\nContent-Length: x\r\n\r\n"}) {
    Client client(port());
    client.send(request);
    const auto reply = client.receive(true);
    ASSERT_TRUE(reply);
    EXPECT_GE(reply->status, 400);
    EXPECT_TRUE(client.ended()) << request;
  }
}

}  // namespace
}  // namespace least::server::test

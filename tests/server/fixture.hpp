// A service in this process, on a free port.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "server/service.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"

namespace least::server::test {

inline constexpr std::string_view page_text = "<!doctype html><title>page</title>";
inline constexpr Asset page_assets[] = {{"/index.html", "text/html; charset=utf-8", page_text},
                                        {"/page.js", "text/javascript", "export {};"}};

/// quiet_settings() returns settings with a free port, and silences the log.
inline Settings quiet_settings() {
  spdlog::set_level(spdlog::level::off);
  Settings settings;
  settings.port = 0;
  settings.grace = 1;
  settings.allow_hosts = {"Named.example"};
  settings.allow_origins = {"https://friend.example"};
  return settings;
}

/// Serving starts one service for all tests of a suite.
class Serving : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    service_ = std::make_unique<Service>(quiet_settings(), page_assets);
    const auto error = service_->start();
    ASSERT_FALSE(error) << *error;
  }
  static void TearDownTestSuite() { service_.reset(); }
  static int port() { return service_->port(); }

 private:
  static inline std::unique_ptr<Service> service_;
};

/// OnePlace is for tests of a service that has one place to compute and none to wait.
class OnePlace : public testing::Test {
 protected:
  void start() {
    settings.threads = 1;
    settings.queue = 0;
    service = std::make_unique<Service>(settings, page_assets);
    ASSERT_FALSE(service->start());
  }
  /// run() returns the status of a short run.
  int run() const {
    return ask(service->port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":9}})"))
        .status;
  }
  /// is_free_soon() tells whether the place becomes free long before the limits of the requests that tests make.
  bool is_free_soon() const {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds soon{15};
    for (const auto from = Clock::now(); Clock::now() - from < soon;
         std::this_thread::sleep_for(std::chrono::milliseconds(20)))
      if (run() == 200) return true;
    return false;
  }

  Settings settings = quiet_settings();
  std::unique_ptr<Service> service;
};

/// Asking sends requests and reads answers in JSON.
class Asking : public Serving {
 protected:
  using Json = nlohmann::json;  // members have no order

  static Reply reply(const Json& request, const char* path = "/v1/simulate", const std::string& accept = {}) {
    return ask(port(), post(path, request.dump(), accept.empty() ? "" : "Accept: " + accept + "\r\n"));
  }
  /// answer() returns the answer to a request; another status than expected ends the test.
  static Json answer(const Json& request, const char* path = "/v1/simulate", int status = 200) {
    const Reply made = reply(request, path);
    if (made.status != status) throw std::runtime_error(made.body.substr(0, 1000));
    return Json::parse(made.body);
  }
  static Json fault_of(const Json& request, const char* path = "/v1/simulate") {
    return only_fault(reply(request, path));
  }
  /// custom() returns the problem of a scene as text.
  static Json custom(const char* text) {
    Json problem = Json::parse(text);
    problem["id"] = "custom";
    return problem;
  }
  /// expect_there_and_back() expects that the end of a run is the start of one that comes back to the first start at
  /// time 0, but for `most` in each variable.
  static void expect_there_and_back(const Json& request, double most) {
    const Json there = answer(request);
    const Json back = answer({{"problem", there["problem"]},
                              {"scheme", there["scheme"]},
                              {"initial", there["final"]},
                              {"record", {{"every", 0}}},
                              {"until", 0}});
    EXPECT_EQ(back["status"], "completed");
    for (const auto& [name, value] : back["final"].items()) EXPECT_NEAR(value, there["initial"][name], most) << name;
  }
  /// expect_bits_of_a_run() expects that the second of three members, which has the start of the request, ends at the
  /// very x at which a single run ends. `values` are those that the members have of a variable.
  static void expect_bits_of_a_run(Json request, const std::string& variable, const Json& values) {
    const Json one = answer(request);
    request.erase("record");
    request["members"] = {{"count", 3}, {"vary", {{"/initial/" + variable, {{"values", values}}}}}};
    request["keep"] = {"final"};
    request["columns"] = {"x"};
    const Json made = answer(request, "/v1/ensemble");
    EXPECT_EQ(made["completed"], 3);
    EXPECT_EQ(made["final"]["x"][1], one["final"]["x"]);
  }
};

}  // namespace least::server::test

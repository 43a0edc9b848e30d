// A service in this process, on a free port.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "server/service.hpp"

namespace least::server::test {

inline constexpr std::string_view page_text = "<!doctype html><title>page</title>";
inline constexpr Asset page_assets[] = {{"/index.html", "text/html; charset=utf-8", page_text},
                                        {"/page.js", "text/javascript", "export {};"}};

/// Settings on a free port; the log of a test is silent.
inline Settings quiet_settings() {
  spdlog::set_level(spdlog::level::off);
  Settings settings;
  settings.port = 0;
  settings.grace = 1;
  settings.allow_hosts = {"Named.example"};
  settings.allow_origins = {"https://friend.example"};
  return settings;
}

/// One service for all tests of a suite.
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

}  // namespace least::server::test

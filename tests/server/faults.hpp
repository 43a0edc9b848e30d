// The faults for which a request was refused.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "tests/server/client.hpp"

namespace least::server::test {

/// only_fault() returns the only fault of a reply; where there is not exactly one, the test fails and its members are
/// empty.
inline nlohmann::json only_fault(const Reply& reply) {
  EXPECT_EQ(reply.status, 422) << reply.body;
  const nlohmann::json document = nlohmann::json::parse(reply.body, nullptr, false);
  const auto errors = document.find("errors");
  if (errors == document.end() || errors->size() != 1) {
    ADD_FAILURE() << reply.body;
    return {{"pointer", ""}, {"detail", ""}, {"allowed", ""}};
  }
  return (*errors)[0];
}
inline bool says(const nlohmann::json& fault, std::string_view part) {
  return fault["detail"].get<std::string>().find(part) != std::string::npos;
}

}  // namespace least::server::test

#include "server/http/accept.hpp"

#include <gtest/gtest.h>

#include <string>

namespace least::server {
namespace {

TEST(Accept, WeighsMediaRanges) {
  const std::string_view offered[] = {"application/json", "text/csv"};
  const auto chosen = [&](std::string_view accept) { return negotiate(accept, offered); };
  EXPECT_EQ(chosen(""), 0u);
  EXPECT_EQ(chosen("*/*"), 0u);
  EXPECT_EQ(chosen("text/csv"), 1u);
  EXPECT_EQ(chosen("TEXT/CSV; header=present"), 1u);
  EXPECT_EQ(chosen("text/*"), 1u);
  EXPECT_EQ(chosen("application/json;q=0.5, text/csv"), 1u);
  EXPECT_EQ(chosen("text/csv;q=0.5, */*;q=0.1"), 1u);
  EXPECT_EQ(chosen("text/csv; q=0.5 , */* ; Q=0.6"), 0u);
  EXPECT_EQ(chosen("application/json;q=0, */*"), 1u);
  EXPECT_EQ(chosen("text/html, application/xhtml+xml, */*;q=0.8"), 0u);
  EXPECT_EQ(chosen("application/cbor"), std::nullopt);
  EXPECT_EQ(chosen("application/x-ndjson, text/*;q=0"), std::nullopt);
  EXPECT_EQ(chosen(",;q=,;;,"), std::nullopt);
}

}  // namespace
}  // namespace least::server

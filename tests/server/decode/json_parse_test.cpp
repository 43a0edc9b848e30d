#include "server/decode/json_parse.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

namespace least::server {
namespace {

std::size_t offset_of_error(std::string_view text) {
  const auto parsed = parse_json(text);
  EXPECT_FALSE(parsed) << text;
  return parsed ? 0 : parsed.error().byte;
}

TEST(JsonText, ReadsATree) {
  const auto parsed = parse_json(R"({"a": [1, 2.5, "x", null, true], "b": {}})");
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->faults.empty());
  EXPECT_EQ(parsed->tree["a"][1].get<double>(), 2.5);
}

TEST(JsonText, TellsWhereTextIsNoJson) {
  EXPECT_EQ(offset_of_error(R"({"a":1,})"), 7u);
  EXPECT_EQ(offset_of_error(""), 0u);
  EXPECT_EQ(offset_of_error("{} x"), 3u);
  EXPECT_EQ(offset_of_error("[1, NaN]"), 4u);
  EXPECT_EQ(offset_of_error("[01]"), 2u);
  EXPECT_FALSE(parse_json("\"\xC3\x28\""));      // bad continuation
  EXPECT_FALSE(parse_json("\"\xED\xA0\x80\""));  // a surrogate in UTF-8
  EXPECT_FALSE(parse_json(R"("\ud800")"));       // half a pair
  EXPECT_FALSE(parse_json(std::string_view("[1]\0", 4)));
}

TEST(JsonText, NamesWhatOtherLanguagesWrite) {
  const auto why = [](std::string_view text) {
    const auto parsed = parse_json(text);
    return parsed ? std::string() : parsed.error().detail;
  };
  for (const char* word : {"NaN", "nan", "Infinity", "-Infinity", "inf", "None", "True", "False"})
    for (const std::string& text : {"{\"t\":" + std::string(word) + "}", "[1, " + std::string(word) + "]"})
      EXPECT_NE(why(text).find(" is not JSON, "), std::string::npos) << text;
  EXPECT_NE(why("{'a': 1}").find("double quotes"), std::string::npos);
  EXPECT_NE(why("{\"a\": 1 // one\n}").find("comments"), std::string::npos);
  EXPECT_EQ(why("{\"a'\" 1}").find("double quotes"), std::string::npos);
  for (const char* other : {R"({"title":"\infty"})", R"({"title":"it\'s"})", "{information:1}", "[nano]"}) {
    EXPECT_EQ(why(other).find(" is not JSON, "), std::string::npos) << other << ": " << why(other);
    EXPECT_EQ(why(other).find("quotes"), std::string::npos) << other << ": " << why(other);
  }
  EXPECT_EQ(why("[nothing]").find(" is not JSON, "), std::string::npos);
}

TEST(JsonText, CollectsDuplicateKeysAndOverflowsWithTheirPlaces) {
  const auto parsed = parse_json(R"({"a": {"x": 1, "x": 2}, "b/c": [0, -1e400, {"y": 1e999}], "d": 7})");
  ASSERT_TRUE(parsed);
  const auto& faults = parsed->faults.list();
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_TRUE(parsed->faults.at("/a/x"));
  EXPECT_TRUE(parsed->faults.at("/b~1c/1"));
  EXPECT_TRUE(parsed->faults.at("/b~1c/2/y"));
  EXPECT_EQ(parsed->tree["d"].get<int>(), 7);
}

TEST(JsonText, KeepsTinyAndHugeDoubles) {
  const auto parsed = parse_json("[1e-400, 4.9e-324, 1.7976931348623157e308, -0.0, 18446744073709551616]");
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->faults.empty());
  EXPECT_EQ(parsed->tree[0].get<double>(), 0);
  EXPECT_EQ(parsed->tree[1].get<double>(), 4.9e-324);
  EXPECT_TRUE(std::signbit(parsed->tree[3].get<double>()));
  EXPECT_EQ(parsed->tree[4].get<double>(), 18446744073709551616.0);
}

TEST(JsonText, BoundsDepthValuesAndKeys) {
  const auto nested = [](int n) {
    return std::string(static_cast<std::size_t>(n), '[') + std::string(static_cast<std::size_t>(n), ']');
  };
  EXPECT_TRUE(parse_json(nested(16))->faults.empty());
  const auto deep = parse_json(nested(17));
  ASSERT_TRUE(deep);
  EXPECT_FALSE(deep->faults.empty());
  EXPECT_TRUE(deep->tree.is_null());
  EXPECT_FALSE(parse_json(nested(1'000'000))->faults.empty());

  EXPECT_FALSE(parse_json("[1,1,1,1]", {.values = 4})->faults.empty());
  EXPECT_TRUE(parse_json("[1,1,1]", {.values = 4})->faults.empty());
  EXPECT_TRUE(parse_json(R"({"a":1,"b":1,"c":1})", {.keys = 2})->faults.at("/c"));
  EXPECT_TRUE(parse_json(R"([{"a":1,"b":1,"c":1},{"a":1,"b":1}])", {.looks = 3})->faults.at("/1/b"));
  EXPECT_FALSE(parse_json(R"([{"a":1,"b":1,"c":1},{"a":1,"b":1}])", {.looks = 4})->faults.full());
}

std::string list_of(std::string_view value, int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) (text += i ? "," : "") += value;
  return text += ']';
}

TEST(JsonText, WithoutMemoryIsNotRead) {
  MemoryBudget memory(1'000'000);
  for (const char* end : {"", ",1e999", ",1e999,1e999"}) {
    std::string text = list_of(R"({"a":1})", 100'000);
    text.insert(text.size() - 1, end);
    const auto parsed = parse_json(text, {}, &memory);
    ASSERT_FALSE(parsed) << end;
    EXPECT_TRUE(parsed.error().no_memory) << end;
    EXPECT_EQ(memory.held(), 0u) << end;
  }
  const auto small = parse_json(list_of("1", 100), {}, &memory);
  EXPECT_TRUE(small);
  EXPECT_EQ(memory.held(), 0u) << "what is small is taken in any case";
}

#if !defined(__SANITIZE_ADDRESS__)  // a sanitizer changes allocations

TEST(JsonText, CountsTheMemoryOfItsTree) {
  const auto in_use = [] {
    const auto info = ::mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const std::string word = '"' + std::string(100, 'x') + '"';
  for (const std::string& text :
       {list_of("1", 200'000), list_of("[]", 100'000), list_of("[1]", 80'000), list_of(R"({"a":1})", 60'000),
        list_of(R"({"a":1,"b":2,"c":3,"d":4,"e":[5]})", 20'000), list_of(R"("a")", 100'000), list_of(word, 8'000),
        list_of("{" + word + ":1}", 8'000), list_of("1", 200'000).insert(1, "1e999,")}) {
    MemoryBudget memory(1 << 30);
    const double before = in_use();
    {
      const auto parsed = parse_json(text, {}, &memory);
      const double taken = in_use() - before, held = static_cast<double>(memory.held());
      EXPECT_GT(held, 0.9 * taken) << text.substr(0, 40);
      EXPECT_LT(held, 1.3 * taken + 2 * small_tree) << text.substr(0, 40);
    }
    EXPECT_EQ(memory.held(), 0u);
  }
}

#endif

TEST(JsonText, ShowsValuesWithinBounds) {
  EXPECT_EQ(shown(Json(-1)), "-1");
  EXPECT_EQ(shown(Json(1e-7)), "1e-07");
  EXPECT_EQ(shown(Json("a\"b")), R"("a\"b")");
  EXPECT_EQ(shown(Json::parse("[1]")), "");
  EXPECT_LT(shown(Json(std::string(100'000, 'x'))).size(), 100u);
  EXPECT_EQ(shown(Json(std::string(79, 'x') + "é!")), std::string("\"").append(79, 'x').append("…\""));
}

}  // namespace
}  // namespace least::server

// The field's published tests: the digits that our runs are said to agree in.
#include "tests/extremes/published.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

class PublishedTests : public testing::TestWithParam<torture::Published> {};

TEST_P(PublishedTests, AgreeInTheDigitsThatAreSaid) {
  const torture::Published& test = GetParam();
  ASSERT_GE(test.digits, 7);
#ifdef __SANITIZE_ADDRESS__
  if (test.name == "van der Pol" || test.name == "Pleiades") GTEST_SKIP() << "takes minutes in such a build";
#endif
  try {
    EXPECT_GE(torture::agreement_of(test, false).digits, test.digits);
  } catch (const std::runtime_error& left_out) {  // forms, by builds of a few problems
    GTEST_SKIP() << left_out.what();
  }
  const auto chosen = torture::agreement_of(test, true);
  EXPECT_GE(chosen.digits, test.digits_of_auto) << chosen.scheme;
}
INSTANTIATE_TEST_SUITE_P(, PublishedTests, testing::ValuesIn(torture::all_published()), [](const auto& tested) {
  std::string name = tested.param.name;
  std::erase(name, ' ');
  return name;
});

TEST(PublishedTable, ListsThemAll) { EXPECT_EQ(torture::all_published().size(), 29U); }

}  // namespace

// Published tests of the field: our runs agree in at least the digits that the table says.
#include "tests/extremes/published.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

class PublishedTests : public testing::TestWithParam<torture::Published> {};

TEST_P(PublishedTests, AgreeInTheDigitsThatAreSaid) {
  const torture::Published& test = GetParam();
  const bool chaotic = test.name == "Burrau" || test.name.starts_with("Lorenz");
  ASSERT_GE(test.digits, chaotic ? 0 : 7);
#ifdef __SANITIZE_ADDRESS__
  if (test.name == "van der Pol" || test.name == "Pleiades") GTEST_SKIP() << "takes minutes in such a build";
#endif
  try {
    EXPECT_GE(torture::agreement_of(test, false).digits, test.digits);
  } catch (const std::runtime_error& left_out) {  // builds with few problems have not all forms
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

TEST(PublishedTable, ListsThemAll) { EXPECT_EQ(torture::all_published().size(), 34U); }

// Ends that were computed elsewhere, compared with the references of this library.
TEST(PublishedMotions, AreThoseOfTheReferences) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes in such a build";
#endif
  std::vector<torture::Published> motions;
  torture::add_motions(motions);
  for (const auto& test : motions) {
    try {
      const auto digits = torture::agreement_of_reference(test);
      EXPECT_EQ(digits.has_value(), test.name != "Lorenz 50") << test.name << ": it takes more than 31 digits";
      if (digits) {
        // The reference of a scene with masses rounds 1/m to a double: for Burrau's bodies that leaves 8 digits.
        EXPECT_GE(*digits, test.name == "Burrau" ? 8 : 12) << test.name;
      }
    } catch (const std::runtime_error& left_out) {
      GTEST_SKIP() << left_out.what();
    }
  }
}

TEST(PublishedEnergies, AreLessThanIsSaid) {
  for (const torture::EnergyRow& row : torture::energy_rows()) {
    try {
      EXPECT_LT(torture::energy_of(row).most, row.most) << row.scheme << " " << row.composition << " " << row.step;
    } catch (const std::runtime_error& left_out) {
      GTEST_SKIP() << left_out.what();
    }
  }
}

}  // namespace

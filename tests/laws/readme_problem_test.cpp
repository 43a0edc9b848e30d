// The problem that the README shows how to add: the build compiles the README's own block of C++.
#include "core/from_values.hpp"
#include "duffing.hpp"
#include "tests/laws/laws.hpp"

namespace {

using namespace least;
using least::problems::Duffing;

static_assert(LinearContact<Duffing<>> && FixedStepSchemeFor<ContactLeapfrog, Duffing<>>);
static_assert(FixedStepSchemeFor<ContactSplitting, Duffing<>> && !FixedStepSchemeFor<Leapfrog, Duffing<>>);

TEST(ReadmeProblem, IsDescribed) {
  EXPECT_EQ(About<Duffing>::card().id, "duffing");
  const auto cards = parameter_cards(About<Duffing>::fields);
  ASSERT_EQ(cards.size(), 3U);
  EXPECT_EQ(cards[0].value, -1);
}
TEST(ReadmeProblem, CanBeRecorded) { laws::recorded<Duffing>(); }
TEST(ReadmeProblem, ForceIsMinusGradient) { laws::force_is_minus_gradient<Duffing>(); }
TEST(ReadmeProblem, EquationsAreHamiltons) { laws::equations_are_hamiltons<Duffing>(); }
TEST(ReadmeProblem, SymmetricSchemesReturn) { laws::symmetric_schemes_return<Duffing>(); }

}  // namespace

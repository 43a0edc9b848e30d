// What an ensemble holds: not its members, where nothing of each is kept.
#include <gtest/gtest.h>

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // which have needs of their own

#include <malloc.h>

#include <fstream>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;

double kibibytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  double found = 0;
  for (std::string word; status >> word;)
    if (word == name && status >> found) break;
  return found;
}
/// How much more than before f holds at most.
template <class F>
double grows_by(F&& f) {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // the most so far is what there is now
  const double before = kibibytes("VmRSS:");
  f();
  return kibibytes("VmHWM:") - before;
}

// A row of three columns and its index are 32 bytes a member: of those that are kept a hundred blocks would show. What
// blocks need while they are computed leaves holes between others, some mebibytes of them, however many blocks there
// are.
TEST(EnsembleMemory, DoesNotGrowWithTheMembers) {
  constexpr std::int64_t many = 120 * block_size;
  EnsemblePlan plan = test::ensemble_of("kepler", "leapfrog", 0.02);
  test::set_columns(plan, {"x", "y", "energy"});
  plan.histograms = {{0, -2, 2, 1000}};
  const auto run = [&](std::int64_t members) {
    test::set_members(plan, members, {{Varied::variable, 0, Spread::uniform, {0.8, 1.2}}});
    EXPECT_EQ(test::harvest_of(plan, 2).ended[0], members);
  };
  const double few = grows_by([&] { run(24 * block_size); });  // as many blocks as may be ahead
  EXPECT_LT(grows_by([&] { run(many); }), few + 4096);
  plan.final = true;
  EXPECT_GT(grows_by([&] { run(many); }), few + 8192) << "what the measure can see";
}

}  // namespace

#endif

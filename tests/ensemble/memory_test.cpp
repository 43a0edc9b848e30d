// The memory of an ensemble does not grow with its members where nothing of each member is kept.
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
/// grows_by() returns by how many KiB f raises the peak of the resident memory above what is there before.
template <class F>
double grows_by(F&& f) {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  const double before = kibibytes("VmRSS:");
  f();
  return kibibytes("VmHWM:") - before;
}

// A row of three columns and its index are 32 bytes a member: a hundred blocks of kept rows would show. The memory that
// blocks need while they are computed leaves some MiB of holes in the heap, however many blocks there are.
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

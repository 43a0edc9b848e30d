// The cost of a run beside its steps: it makes nothing of what it does not keep.
#include "tests/support/allocations.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

TEST(ShortRuns, AllocateLittleBesideTheirSteps) {
  constexpr std::size_t most = 2;  // the integrator and the final state
  const std::atomic<bool> never{false};
  for (const char* scheme : {"leapfrog", "taylor"}) {
    Request request = runs::defaults("kepler", scheme);
    request.until_steps = true;
    request.steps = 1;
    runs::only_final(request);
    Samples none;
    request.scene->mechanics->run(request, none, never);  // the first run may allocate what later ones reuse
    const std::size_t before = counting::allocations();
    request.scene->mechanics->run(request, none, never);
    EXPECT_LE(counting::allocations() - before, most) << scheme;
  }
}

}  // namespace

// Table of RESULTS.md: how long `auto` takes to choose a scheme for every scene at its start. Printed before the
// benchmarks.
#include <cstdio>
#include <string>

#include "core/study/study.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

void bench::advice() {
  using namespace least;
  bench::heading("How long `auto` takes");
  std::printf(
      "To find the cheapest scheme that is right to 1e-6 on every scene as it begins: a scene never seen before, "
      "whose\n"
      "true states are computed first, and the same scene once more. The goal is 0.1 s.\n\n"
      "| scene | choice | error | s | once more: s |\n|---|---|---|---|---|\n");
  const std::atomic<bool> never{false};
  for (const ProblemCard& problem : runs::problem_cards()) {
    if (!bench::is_wanted(problem.id)) continue;
    Request request = runs::defaults(problem.id, schemes()[problem.schemes.front()].id);
    request.end *= 1 + 1e-9;  // the cache already has the true states of the other tables
    Wish wish;
    wish.accuracy = 1e-6;
    const bench::Stopwatch fresh;
    const Advice advice = advise(request, wish, never);
    const double first = fresh.seconds();
    const bench::Stopwatch again;
    advise(request, wish, never);
    const double second = again.seconds();
    std::printf("| `%s` | %s%s | %.1e | %.2f%s | %.2f |\n", problem.id.data(),
                advice.choice ? name(schemes()[advice.choice->scheme], *advice.choice).c_str() : "–",
                advice.met ? "" : ", which does not reach it", advice.estimated_error, first,
                first <= 0.1 ? "" : ", over", second);
  }
}

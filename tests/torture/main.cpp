// The table of the field's published tests as Markdown on the standard output. Written by `./dev torture`.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/extremes/published.hpp"

int main() {
  const char* commit = std::getenv("LEAST_COMMIT");
  std::printf(
      "# Published tests\n\nWritten by `./dev torture` at commit %s. Digits in which the end agrees with the published "
      "one, relative to\nmax(1, the largest component of it), by `taylor` at the tolerance 1e-15 and by `auto` at "
      "1e-9; the scheme that `auto`\nchose, and the seconds of either run. The tests assert what stands in the columns "
      "\"at least\". Sources stand in\n`tests/extremes/published.hpp`.\n\n| test | what | until | published, the first "
      "component | taylor | at least | s | auto | at least | s | scheme "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      commit ? commit : "unknown");
  int wrong = 0;
  for (const torture::Published& test : torture::all_published()) {
    const auto series = torture::agreement_of(test, false), chosen = torture::agreement_of(test, true);
    wrong += series.digits < test.digits || chosen.digits < test.digits_of_auto;
    std::printf("| %s | %s | %.16g | %.16g | %.1f | %d | %.2g | %.1f | %d | %.2g | `%s` |\n", test.name.c_str(),
                test.what.c_str(), test.end, test.known[0], series.digits, test.digits, series.seconds, chosen.digits,
                test.digits_of_auto, chosen.seconds, chosen.scheme.c_str());
    std::fflush(stdout);
  }
  return wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

// Prints the table of published tests of the field as Markdown on the standard output, for `./dev torture`.
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
      "\"at least\". The column \"reference\" is for\nthe motion as this library knows it to 31 digits, where that "
      "is certain to 1e-12. Sources stand in\n`tests/extremes/published.hpp`.\n\nOf chaos the table says "
      "until when a double means something: Lorenz's differences grow by e^(0.9 t), those of\nround-off to the size of "
      "the motion by t = 40, and the three bodies of Burrau, who come as near as 4e-4, lose 13 digits. (Their "
      "reference has 1/m rounded to a double, which leaves it 8.)\n\n| test | "
      "what | until | published, the first component | reference | taylor | at least | s | auto | at least | s | "
      "scheme "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      commit ? commit : "unknown");
  int wrong = 0;
  for (const torture::Published& test : torture::all_published()) {
    const auto series = torture::agreement_of(test, false), chosen = torture::agreement_of(test, true);
    wrong += series.digits < test.digits || chosen.digits < test.digits_of_auto;
    const auto reference = torture::agreement_of_reference(test);
    char digits[16] = "";
    if (reference) std::snprintf(digits, sizeof digits, "%.1f", *reference);
    std::printf("| %s | %s | %.16g | %.16g | %s | %.1f | %d | %.2g | %.1f | %d | %.2g | `%s` |\n", test.name.c_str(),
                test.what.c_str(), test.end, test.known[0], digits, series.digits, test.digits, series.seconds,
                chosen.digits, test.digits_of_auto, chosen.seconds, chosen.scheme.c_str());
    std::fflush(stdout);
  }
  std::printf(
      "\n## The outer planets: their energy\n\nThe Sun, Jupiter, Saturn, Uranus, Neptune and Pluto over 200,000 days "
      "(Hairer, Lubich, Wanner 2006, I.2.4), by every\nscheme that takes a scene of 18 coordinates: the largest error "
      "of "
      "the energy and that at the end, relative to the\nenergy. The tests assert what stands in the column \"less "
      "than\".\n\n| scheme | composition or splitting | step in days, or tolerance | largest | less than | at the end "
      "| force "
      "evaluations | s |\n|---|---|---|---|---|---|---|---|\n");
  for (const torture::EnergyRow& row : torture::energy_rows()) {
    const auto found = torture::energy_of(row);
    wrong += !(found.most < row.most);
    std::printf("| `%s` | %s | %g | %.2g | %g | %.2g | %lld | %.2g |\n", row.scheme.c_str(), row.composition.c_str(),
                row.step, found.most, row.most, found.last, static_cast<long long>(found.forces), found.seconds);
    std::fflush(stdout);
  }
  return wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

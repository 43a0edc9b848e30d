// Runs the Kepler problem under leapfrog for one revolution, every default from the catalogue, and prints how well the
// energy was kept.
#include <atomic>
#include <cstdio>
#include <variant>
#include <vector>

#include "core/catalogue/catalogue.hpp"

int main() {
  least::Request request = least::default_request("kepler", "leapfrog");
  request.end = 18.9;
  least::Samples samples;
  const std::atomic<bool> cancelled{false};
  const auto solution = request.scene->mechanics->run(request, samples, cancelled);
  for (const auto& diagnostic : solution.diagnostics)
    for (const auto& number : std::get<std::vector<least::Report>>(diagnostic.value))
      if (number.key == "max_rel_error") std::printf("relative energy error %.4f\n", std::get<double>(number.value));
}

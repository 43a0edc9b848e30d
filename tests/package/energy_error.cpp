// Runs the Kepler problem under leapfrog, every default from the catalogue, and prints how well the energy was kept.
#include <atomic>
#include <cstdio>

#include "core/catalogue.hpp"

int main() {
  least::Request request;
  request.problem = least::find_problem("kepler").value();
  request.scheme = least::find_scheme("leapfrog").value();
  const least::ProblemCard& card = least::problems()[request.problem];
  for (const auto& parameter : card.parameters) request.parameters.push_back(parameter.value);
  for (const auto& variable : card.variables) request.initial.push_back(variable.value);
  request.settings = {0.01, 0};  // step, composition none
  request.end = 18.9;
  request.diagnostics = {0};  // energy
  least::Samples samples;
  const std::atomic<bool> cancelled{false};
  const least::Outcome outcome = least::run(request, samples, cancelled);
  for (const auto& number : std::get<std::vector<least::Report>>(outcome.diagnostics.at(0).value))
    if (number.key == "max_rel_error") std::printf("relative energy error %.4f\n", std::get<double>(number.value));
}

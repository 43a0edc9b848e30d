#include "core/run/still_components.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/memory_budget.hpp"

namespace least {

void settle_still_components(const ProblemTable& problem, std::span<const RunState> states, ComponentSizes& sizes,
                             const std::function<bool()>& keep_going) {
  constexpr double rounding = 0x1p-45;
  const std::size_t size = problem.traits.components;
  const Held held = HeldByThread::take(size * size * sizeof(double));
  StateNumbers rates(size);
  std::vector<double> slopes(size * size);  // ∂ẋ_i/∂x_j at j·size + i
  std::vector<double> changes(size, 0), most_rate(size, 1 / (states.back().t - states.front().t));  // by kind
  const auto raise = [](double& most, double x) {
    if (std::isfinite(x)) most = std::max(most, x);
  };
  for (const RunState* x : {&states.front(), &states[states.size() / 2], &states.back()}) {
    StateNumbers direction(size, 0.0);
    for (std::size_t j = 0; j < size; ++j) {
      if (j % 16 == 15 && !keep_going()) return;
      if (j > 0) direction[j - 1] = 0;
      direction[j] = 1;
      problem.rates(*x, direction.data(), 0, rates.data(), &slopes[j * size]);
    }
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < size; ++j) {
        const double slope = slopes[j * size + i];
        if (slope == 0) continue;  // nearly all of them in a scene of a thousand components
        raise(changes[sizes.kind(i)], std::abs(slope) * sizes.largest(j));
        // For i = j this is the decay rate of the component.
        raise(most_rate[sizes.kind(i)], std::sqrt(std::abs(slope * slopes[i * size + j])));
      }
  }
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t kind = sizes.kind(i);
    const double natural = changes[kind] / most_rate[kind];
    if (kind == i && sizes.largest(i) <= rounding * natural && std::isfinite(natural)) sizes.set(i, natural);
  }
}

}  // namespace least

#include "core/run/kink_start.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text/scene.hpp"

namespace least {
namespace {

double largest_size(const StateNumbers& numbers) {
  double most = 0;
  for (const double number : numbers) most = std::max(most, std::abs(number));
  return most;
}

/// How often the rates jump within a few steps of Euler's method, of the length h, from x.
int jumps_from(const ProblemTable& problem, RunState x, double h) {
  constexpr int steps = 64;
  constexpr double jump = 0.1;  // of the largest rate
  StateNumbers rates(std::max(x.size(), problem.traits.components)), before = rates;
  int jumps = 0;
  for (int step = 0; step <= steps; ++step) {
    problem.rates(x, rates.data());
    const double largest = std::max(largest_size(rates), largest_size(before));
    double change = 0;
    for (std::size_t i = 0; i < rates.size(); ++i) change = std::max(change, std::abs(rates[i] - before[i]));
    if (step > 0 && change > jump * largest) ++jumps;
    for (std::size_t i = 0; i < problem.traits.moving; ++i) x[i] += h * rates[i];
    x.t += h;
    std::swap(rates, before);
  }
  return jumps;
}

bool chooses(const tape::Tape& tape) {
  for (tape::Index i = 0; i < tape.size(); ++i)
    if (tape[i].op == tape::Op::select) return true;
  return false;
}

}  // namespace

bool begins_on_kink(const Scene& scene, const ProblemTable& problem, const RunState& x, double span) {
  const text::TextScene* const text = scene.mechanics->text();
  if (!text || !chooses(text->form->tape)) return false;
  StateNumbers rates(std::max(x.size(), problem.traits.components));
  problem.rates(x, rates.data());
  double size = 0;
  for (std::size_t i = 0; i < problem.traits.moving; ++i) size = std::max(size, std::abs(x[i]));
  const double fastest = largest_size(rates);
  if (!(fastest > 0) || !std::isfinite(fastest)) return false;
  // So short that nothing that is smooth changes. Where a stiff force is what changes, shorter steps see no jump.
  constexpr double short_part = 1e-5, of_span = 1e-6, shorter = 1.0 / 64;
  constexpr int often = 3;  // a motion that crosses a kink does it once
  const double longest = of_span * (std::isfinite(span) ? span : 1);
  const double h = size > 0 ? std::min(short_part * size / fastest, longest) : longest;
  return h > 0 && jumps_from(problem, x, h) >= often && jumps_from(problem, x, shorter * h) >= often;
}

}  // namespace least

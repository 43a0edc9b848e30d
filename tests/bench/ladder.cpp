#include "tests/bench/ladder.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace {

/// processor_seconds() counts the time of this thread only, so that other threads do not disturb it.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// microseconds() returns the smallest time of interleaved repetitions of each function.
std::vector<double> microseconds(const std::vector<std::function<void()>>& all, int rounds) {
  using Clock = std::chrono::steady_clock;
  constexpr double batch = 50;  // microseconds: shorter runs are repeated in a row to fill this time
  std::vector<double> least(all.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < all.size(); ++i) {
      const int repeats = static_cast<int>(std::clamp(batch / least[i], 1.0, 1e3));  // one run in the first round
      const auto start = Clock::now();
      for (int k = 0; k < repeats; ++k) all[i]();
      const double together = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
      least[i] = std::min(least[i], together / repeats);
    }
  return least;
}

}  // namespace

void bench::Ladder::descend() {
  const double start = processor_seconds();
  const Run run = contestant.measured(value);
  cost = processor_seconds() - start;
  together += cost;
  for (std::size_t i = 0; i < accuracies.size(); ++i) {
    auto& rung = rungs[i];
    if (reached(i)) continue;
    if (!(run.error <= accuracies[i]))
      rung.reset();
    else if (rung)
      rung->holds = true;
    else
      rung = {value, run.forces};
  }
  value = contestant.setting(value / contestant.finer);
  given_up = together > most_seconds || run.forces >= most_forces;
}

void bench::descend(std::vector<Ladder>& ladders, std::size_t count, double far) {
  constexpr double short_run = 5e-4;  // seconds: for shorter runs a chance delay would decide
  double most = most_seconds;
  while (true) {
    Ladder* next = nullptr;
    for (Ladder& ladder : ladders)
      if (!ladder.given_up && !ladder.reached(count - 1) && ladder.value > ladder.contestant.finest &&
          (!next || ladder.cost < next->cost))
        next = &ladder;
    if (!next) return;
    if (next->cost > most) {
      next->given_up = true;
      continue;
    }
    next->descend();
    if (next->reached(count - 1)) most = std::min(most, std::max(far * next->cost, short_run));
  }
}

std::vector<bench::Entrant> bench::entrants(const std::vector<Ladder>& ladders, std::size_t accuracy) {
  std::vector<Entrant> all;
  for (const Ladder& ladder : ladders)
    if (const auto* rung = ladder.reached(accuracy)) all.push_back({&ladder.contestant, rung->value, rung->forces});
  return all;
}

void bench::race(std::vector<Entrant>& all, int rounds) {
  std::vector<std::function<void()>> runs;
  for (const Entrant& entrant : all) runs.push_back(entrant.contestant->prepared(entrant.value));
  const auto us = microseconds(runs, rounds);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].us = us[i];
  std::ranges::stable_sort(all, {}, &Entrant::us);
}

// Contestants that are refined until they reach given accuracies, and races between those that reach them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bench {

inline constexpr std::array accuracies{1e-4, 1e-6, 1e-8, 1e-10};
inline constexpr std::int64_t most_forces = 2'000'000;  // of a run
inline constexpr double most_seconds = 1;               // of all runs of a ladder

struct Run {
  double error;  ///< NaN where it did not complete
  std::int64_t forces;
};

/// Owner says what a contestant is: a scheme of ours that keeps structure, our `taylor`, which keeps none, or a peer,
/// which ours are measured against.
enum class Owner { structure, taylor, peer };

/// Contestant is a scheme with a setting that makes it as fine as one likes.
struct Contestant {
  std::string name;
  double coarsest, finest, finer;  ///< the first and last setting, and the factor between two settings
  std::function<Run(double)> measured;
  std::function<std::function<void()>(double)> prepared;  ///< a run straight to the end, as a user would make it
  std::string_view symbol{};                              ///< the symbol of the setting
  Owner owner = Owner::peer;
  double period = 0;  ///< the setting has to divide this period; 0: none
  /// setting() returns the value itself, or the next finer one that divides the period.
  double setting(double value) const { return value < period ? period / std::ceil(period / value) : value; }
};

/// Ladder finds the coarsest setting at which a contestant reaches each accuracy. The next finer setting has to reach
/// it, too: in the noise of round-off, and where an error happens to change its sign, single runs are too good.
struct Ladder {
  struct Rung {
    double value;
    std::int64_t forces;
    bool holds = false;
  };
  Contestant contestant;
  double value = contestant.setting(contestant.coarsest);
  double cost = 0, together = 0;  ///< seconds: of the last run, of all runs
  bool given_up = false;          ///< its budget is spent, or other contestants are far ahead
  std::array<std::optional<Rung>, accuracies.size()> rungs{};

  const Rung* reached(std::size_t accuracy) const {
    const auto& rung = rungs[accuracy];
    return rung && rung->holds ? &*rung : nullptr;
  }
  /// descend() makes one run at `value`, records the accuracies it reaches and goes on to the next finer setting.
  void descend();
};

/// descend() refines all ladders, always the one whose last run was cheapest. A ladder ends where it has the first
/// `count` accuracies, or its time is spent, or a run costs `far` times as much as the cheapest that had them.
void descend(std::vector<Ladder>& ladders, std::size_t count, double far);

/// Entrant is a contestant at the coarsest setting that reaches an accuracy.
struct Entrant {
  const Contestant* contestant;
  double value;
  std::int64_t forces;
  double us = std::numeric_limits<double>::infinity();
};

std::vector<Entrant> entrants(const std::vector<Ladder>& ladders, std::size_t accuracy);

/// race() times the entrants in microseconds, each the smallest of interleaved repetitions, and sorts them by that.
void race(std::vector<Entrant>& all, int rounds);

}  // namespace bench

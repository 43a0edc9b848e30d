// Contestants that are refined until they reach given accuracies, and races between those that do.
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

/// Whose a contestant is: a scheme of ours that keeps structure, ours that keeps none, a measure.
enum class Owner { structure, taylor, peer };

/// A scheme with a setting that makes it as fine as one likes.
struct Contestant {
  std::string name;
  double coarsest, finest, finer;  ///< the setting: where to begin and to end, the factor between two
  std::function<Run(double)> measured;
  std::function<std::function<void()>(double)> prepared;  ///< a run as one would make it, straight to the end
  std::string_view symbol{};                              ///< of the setting
  Owner owner = Owner::peer;
  double period = 0;  ///< that the setting is to divide
  /// The setting itself, or the next finer one that divides the period.
  double setting(double value) const { return value < period ? period / std::ceil(period / value) : value; }
};

/// The coarsest setting of a contestant at which it reaches each accuracy, and at the next finer one, too: in the noise
/// of round-off, and where an error happens to change its sign, single runs are better than the rest.
struct Ladder {
  struct Rung {
    double value;
    std::int64_t forces;
    bool holds = false;
  };
  Contestant contestant;
  double value = contestant.setting(contestant.coarsest);
  double cost = 0, together = 0;  ///< seconds: of the last run, of all
  bool given_up = false;          ///< its budget is spent, or others are far ahead
  std::array<std::optional<Rung>, accuracies.size()> rungs{};

  const Rung* reached(std::size_t accuracy) const {
    const auto& rung = rungs[accuracy];
    return rung && rung->holds ? &*rung : nullptr;
  }
  /// One run, and what it says.
  void descend();
};

/// All ladders side by side, the cheapest next run first, until what is left is `far` times as dear as the cheapest run
/// that has the first `count` accuracies, or has had its time.
void descend(std::vector<Ladder>& ladders, std::size_t count, double far);

/// A contestant at the coarsest setting that will do.
struct Entrant {
  const Contestant* contestant;
  double value;
  std::int64_t forces;
  double us = std::numeric_limits<double>::infinity();
};

std::vector<Entrant> entrants(const std::vector<Ladder>& ladders, std::size_t accuracy);

/// Times them in microseconds, each the smallest of interleaved repetitions, and sorts them by that.
void race(std::vector<Entrant>& all, int rounds);

}  // namespace bench

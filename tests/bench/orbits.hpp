// Scenes with their true states, and our schemes as contestants on these scenes.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/study/error_study.hpp"
#include "tests/bench/ladder.hpp"

namespace bench {

/// TrueOrbit is a scene with its true states at 64 times, dense where the motion is fast. The last time is the end.
struct TrueOrbit {
  least::Request scene;  ///< its end is where the motion ends, if that is earlier
  std::vector<double> times;
  std::shared_ptr<const least::Truth> truth;
  double floor;  ///< the uncertainty of the true states: smaller errors mean nothing

  explicit TrueOrbit(const least::Request& of);
  std::size_t variables() const { return truth->states.front().size(); }
  /// error() returns the largest error at all times of `states`, which are in a row; not finite where a state is not
  /// finite or missing.
  double error(std::span<const double> states) const;
};

/// ours() returns one of our schemes as a contestant, refined by its own accuracy setting. The orbit must outlive it.
Contestant ours(const TrueOrbit& orbit, const least::SchemeConfig& choice);

}  // namespace bench

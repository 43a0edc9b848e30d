// Scenes with their true states, and our schemes as contestants on them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/study/error_study.hpp"
#include "tests/bench/ladder.hpp"

namespace bench {

/// A scene with its true states at 64 times that follow the motion, dense where that is fast. The last is the end.
struct TrueOrbit {
  least::Request scene;  ///< up to where the motion goes
  std::vector<double> times;
  std::shared_ptr<const least::Truth> truth;
  double floor;  ///< errors below mean nothing

  explicit TrueOrbit(const least::Request& of);
  std::size_t variables() const { return truth->states.front().size(); }
  /// The largest of all times, of states in a row; not finite where one is not, or missing.
  double error(std::span<const double> states) const;
};

/// Refined by its own dial; outlived by the orbit.
Contestant ours(const TrueOrbit& orbit, const least::SchemeConfig& choice);

}  // namespace bench

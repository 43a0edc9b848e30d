// How well the states of a motion can be known: how fast small differences of its start grow.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// Growth is ‖∂x(t)/∂x_j(0)‖ · ‖x(0)‖ / max(1, ‖x(t)‖), the largest of all directions j, with ‖x‖ = max|x_i|: how many
/// times a relative error of the start appears in the error at t.
struct Conditioning {
  static constexpr std::size_t parts = 8;
  std::size_t variables = 0;           ///< of the card, that the motion has
  double growth = 1, most_growth = 1;  ///< at the end, and the largest
  std::array<double, parts> so_far{};  ///< the largest growth up to each eighth of the span
  double size = 0;                     ///< the largest ‖x(t)‖
  double size_halfway = 0;             ///< the same up to half the span
  double reached = 0;                  ///< time up to which the motion goes on, if not to the end that was asked for
  bool ends = false;                   ///< it leaves its domain there, or ceases to be finite
  bool complete = true;                ///< false: given up on the way
  std::vector<double> pace;            ///< times that follow the motion: dense where it is fast
  /// The least and the largest local frequency that the problem estimates along the motion; NaN: it does not.
  double slowest = std::numeric_limits<double>::quiet_NaN(), fastest = std::numeric_limits<double>::quiet_NaN();
  double damping = std::numeric_limits<double>::quiet_NaN();  ///< α where it does not change in time

  /// Whether differences grow exponentially all along the span: by far in each of its last quarters. What grows as a
  /// power of time, or in a single close passage, does not.
  bool chaotic() const {
    constexpr double far = 5;
    return so_far[7] > 1e6 && so_far[7] > 30 * so_far[3] && so_far[5] > far * so_far[3] && so_far[7] > far * so_far[5];
  }
  /// Whether the motion goes ever further, as an angle that turns.
  bool travels() const { return size > 1.5 * size_halfway; }
  std::size_t bytes() const { return sizeof(Conditioning) + pace.size() * sizeof(double); }  ///< in memory, about
};

/// Of a scene from its start to scene.end. Kept for the next question, as truths are; thread-safe. `keep_going` is
/// asked now and then; false gives up.
std::shared_ptr<const Conditioning> conditioning(const Request& scene, const std::function<bool()>& keep_going);

}  // namespace least

// Operations on values become instructions on registers: each value gets one when it is made, which is free for others
// after it was read for the last time.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "core/ensemble/lane_program.hpp"

namespace least {

/// An instruction whose operands in lanes are values, by a number of their own; −1: none. Shared ones are registers.
struct LaneOperation {
  LaneCode code = LaneCode::copy;
  std::int32_t out = -1, a = -1, b = -1, c = -1;
};

class LaneRegisters {
 public:
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();
  /// So many registers, the first, are not given to anything that has none yet.
  explicit LaneRegisters(std::size_t fixed) : fixed_(fixed), count_(fixed) {}

  /// A value and the fixed register where it has to stand at the end.
  using End = std::pair<std::int32_t, std::uint32_t>;
  /// `given`: of each value where it stands, as far as that is settled; afterwards, of all. What is `alive` stays there
  /// to the end. No value is in `ends` that stood in a fixed register before.
  std::vector<LaneInstruction> assign(const std::vector<LaneOperation>& operations, const std::vector<End>& ends,
                                      const std::vector<std::int32_t>& alive, std::vector<std::uint32_t>& given);
  std::size_t count() const { return count_; }

 private:
  std::size_t fixed_, count_;
};

}  // namespace least

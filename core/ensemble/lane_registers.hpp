// Register allocation: each value gets a register when it is computed, which is free for others after its last use.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "core/ensemble/lane_program.hpp"

namespace least {

/// LaneOperation is an instruction before allocation: operands in lanes are numbers of values, −1 for none; shared
/// operands are registers already.
struct LaneOperation {
  LaneCode code = LaneCode::copy;
  std::int32_t out = -1, a = -1, b = -1, c = -1;
};

/// LaneRegisters allocates the registers of one program part.
class LaneRegisters {
 public:
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();
  /// The first `fixed` registers are never given to a value that has none yet.
  explicit LaneRegisters(std::size_t fixed) : fixed_(fixed), count_(fixed) {}

  /// End is a value and the fixed register in which it has to be at the end.
  using End = std::pair<std::int32_t, std::uint32_t>;
  /// assign returns the instructions. `given` holds the register of each value where that is already settled, and of
  /// all values afterwards. Values in `alive` keep their registers to the end. Values in `ends` must not be in a fixed
  /// register before.
  std::vector<LaneInstruction> assign(const std::vector<LaneOperation>& operations, const std::vector<End>& ends,
                                      const std::vector<std::int32_t>& alive, std::vector<std::uint32_t>& given);
  std::size_t count() const { return count_; }

 private:
  std::size_t fixed_, count_;
};

}  // namespace least

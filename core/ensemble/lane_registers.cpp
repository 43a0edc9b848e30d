#include "core/ensemble/lane_registers.hpp"

#include <algorithm>

namespace least {
namespace {

/// shared_operand returns which operand is a shared register: 0 for a, 1 for b, −1 for none.
int shared_operand(LaneCode code) {
  using enum LaneCode;
  if (code == add_shared || code == subtract_shared || code == divide_shared || code == add_scaled ||
      code == subtract_scaled)
    return 1;
  return code == from_shared || code == scale || code == over_shared || code == spread ? 0 : -1;
}
template <class F>
void each_operand(const LaneOperation& one, F&& f) {
  const int shared = shared_operand(one.code);
  if (one.a >= 0 && shared != 0) f(static_cast<std::size_t>(one.a));
  if (one.b >= 0 && shared != 1) f(static_cast<std::size_t>(one.b));
  if (one.c >= 0) f(static_cast<std::size_t>(one.c));
}

}  // namespace

std::vector<LaneInstruction> LaneRegisters::assign(const std::vector<LaneOperation>& operations,
                                                   const std::vector<End>& ends, const std::vector<std::int32_t>& alive,
                                                   std::vector<std::uint32_t>& given) {
  constexpr std::size_t forever = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> last(given.size(), 0), born(given.size(), 0), fixed_read(fixed_, 0);
  for (std::size_t k = 0; k < operations.size(); ++k) {
    born[static_cast<std::size_t>(operations[k].out)] = k;
    each_operand(operations[k], [&](std::size_t i) {
      last[i] = k;
      if (given[i] < fixed_) fixed_read[given[i]] = k;
    });
  }
  // A value that must end in a fixed register is computed there, if that register is not read any more.
  std::vector<End> moves;
  for (const auto& [value, where] : ends) {
    const auto i = static_cast<std::size_t>(value);
    if (given[i] == nowhere && fixed_read[where] <= born[i]) {
      given[i] = where;
    } else {
      moves.emplace_back(value, where);
      last[i] = forever;
    }
  }
  for (const auto value : alive) last[static_cast<std::size_t>(value)] = forever;

  std::vector<LaneInstruction> code;
  std::vector<std::uint32_t> free;
  std::size_t next = fixed_;
  for (std::size_t k = 0; k < operations.size(); ++k) {
    const LaneOperation& one = operations[k];
    const auto place = [&](std::int32_t i, int which) {
      if (i < 0) return std::uint32_t{0};
      return shared_operand(one.code) == which ? static_cast<std::uint32_t>(i) : given[static_cast<std::size_t>(i)];
    };
    LaneInstruction made{one.code, 0, place(one.a, 0), place(one.b, 1), place(one.c, 2)};
    each_operand(one, [&](std::size_t i) {
      if (last[i] != k || given[i] < fixed_) return;
      free.push_back(given[i]);
      last[i] = forever;  // freed only once, also if an operand is named twice
    });
    std::uint32_t& out = given[static_cast<std::size_t>(one.out)];
    if (out == nowhere && !free.empty()) {
      out = free.back();
      free.pop_back();
    } else if (out == nowhere) {
      out = static_cast<std::uint32_t>(next++);
    }
    made.out = out;
    code.push_back(made);
  }
  for (const auto& [value, where] : moves)
    code.push_back({LaneCode::copy, where, given[static_cast<std::size_t>(value)]});
  count_ = std::max(count_, next);
  return code;
}

}  // namespace least

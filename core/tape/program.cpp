#include "core/tape/program.hpp"

#include "core/tape/derivative.hpp"
#include "core/tape/lowered.hpp"
#include "core/tape/steep.hpp"

namespace least::tape {
namespace {

bool reads_the_time(const Program& program) {
  const Index time = program.time();
  const auto is_time = [time](Index value) { return value == time; };
  return !program.linear.empty() ||
         std::ranges::any_of(program.steps, [&](const Step& s) { return s.a == time || s.b == time || s.w == time; }) ||
         std::ranges::any_of(program.values, is_time, &Program::Value::value) ||
         std::ranges::any_of(program.products, is_time, &Program::Product::a) ||
         std::ranges::any_of(program.products, is_time, &Program::Product::b) ||
         std::ranges::any_of(program.rate, is_time);
}

Program::Effort effort_of(const Program& program) {
  Program::Effort effort{.steps = program.motion_steps};
  for (std::size_t i = 0; i < program.motion_steps; ++i) {
    const Step& step = program.steps[i];
    const bool called = step.function != Op::constant && step.products == 0;
    if (called || step.rule == Rule::power || step.rule == Rule::root) ++effort.dear;
  }
  std::size_t slots = 3;  // rounds up to whole fours
  for (std::size_t i = 0; i < program.motion_lanes; ++i) slots += program.lane_a[i] == program.lane_b[i] ? 1 : 2;
  effort.fours = slots / 4;
  return effort;
}

/// lowered_with_powers lowers a tape on which powers may have exponents that move. Series have no rule for these.
Program lowered_with_powers(const Tape& tape, std::span<const Index> rates, std::size_t most) {
  if (!has_moving_exponents(tape)) return lowered(tape, rates, most);
  const PlainTape plain = with_exponentials(tape, rates);
  return lowered(plain.tape, plain.roots, most);
}

}  // namespace

Program::Program(const Tape& tape, std::span<const Index> rates, std::size_t most)
    : Program(lowered_with_powers(tape, rates, most)) {
  steep = steep_arguments(*this);
  conceals = may_conceal(*this);
  if (conceals) branches = branch_values(*this);
  reads_time = reads_the_time(*this);
  effort = effort_of(*this);
}

}  // namespace least::tape

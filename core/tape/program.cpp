#include "core/tape/program.hpp"

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

}  // namespace

Program::Program(const Tape& tape, std::span<const Index> rates, std::size_t most)
    : Program(lowered(tape, rates, most)) {
  steep = steep_arguments(*this);
  conceals = may_conceal(*this);
  if (conceals) branches = branch_values(*this);
  reads_time = reads_the_time(*this);
}

}  // namespace least::tape

// How a tape becomes a program: constexpr, so that programs of the problems of the catalogue are made by the compiler,
// too (core/tape/unrolled.hpp).
#pragma once

#include "core/tape/lowering.hpp"

namespace least::tape {

/// Leaves out the terms of what has become part of something else.
constexpr void gather(Program& program) {
  std::vector<Program::Value> values;
  std::vector<Program::Product> products;
  values.reserve(program.values.size());
  products.reserve(program.products.size());
  const auto move = [](Index& first, Index count, const auto& from, auto& to) {
    const auto begin = from.begin() + first;
    first = static_cast<Index>(to.size());
    to.insert(to.end(), begin, begin + count);
  };
  for (auto* list : {&program.linear, &program.steps})
    for (Step& step : *list) {
      move(step.first_value, step.values, program.values, values);
      move(step.first_product, step.products, program.products, products);
    }
  program.values = std::move(values);
  program.products = std::move(products);
}

/// Of a tape the rates ẋ of the variables, in their order; the first `most` of them are the motion, which what follows
/// after them does not change by a bit.
constexpr Program lowered(const Tape& tape, std::span<const Index> rates, std::size_t most) {
  Program program;
  program.variables = rates.size();
  program.moving = most;
  program.weighted.assign(rates.size() + 1, Program::waste);
  program.rows = Program::first_variable + static_cast<Index>(rates.size()) + 1;
  const auto length = static_cast<std::size_t>(tape.size());
  program.steps.reserve(length);
  program.values.reserve(4 * length);
  program.products.reserve(2 * length);
  program.lane_a.reserve(length);
  program.lane_b.reserve(length);
  program.rate.reserve(rates.size());
  Lowering lowering(tape, program);
  lowering.lower(rates.first(most));
  program.motion_steps = program.steps.size();
  program.motion_lanes = program.lane_a.size();
  if (most < rates.size()) {  // how long steps are is a matter of the motion
    const bool converges = program.whole, ends = program.partial;
    const std::size_t seen = program.switches.size(), known = program.poles.size();
    lowering.lower(rates.subspan(most));
    program.whole = converges;
    program.partial = ends;
    program.switches.resize(seen);
    program.poles.resize(known);
  }
  gather(program);
  return program;
}

}  // namespace least::tape

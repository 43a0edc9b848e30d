// lowered makes a program from a tape. It is constexpr, so that the compiler, too, can make the programs of the
// problems of the catalogue (core/tape/unrolled.hpp).
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/tape/lowering.hpp"

namespace least::tape {

/// Drops the values and products of the lists that no step refers to any more.
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

/// Lets order 0 of sin and cos of p a, a linear in time, follow by the addition theorems where the factors p of two
/// earlier pairs add up to p: of many harmonics only the first costs a call. Rounding errors add up, so a pair may
/// combine `most_calls` calls at most; the next one calls the functions anew.
constexpr void start_by_addition(Program& program) {
  constexpr std::size_t most_pairs = 64;
  constexpr int most_calls = 16;
  struct Pair {
    std::size_t step;
    int calls;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i + 1 < program.steps.size() && pairs.size() < most_pairs; ++i) {
    Step &sine = program.steps[i], &cosine = program.steps[i + 1];
    if (sine.rule != Rule::linear_integral || sine.function != Op::sin || cosine.function != Op::cos ||
        sine.w != cosine.out || cosine.w != sine.out || cosine.a != sine.a)
      continue;
    int calls = 1;
    for (std::size_t j = pairs.size(); j-- > 0 && calls == 1;)
      for (std::size_t k = 0; k <= j && calls == 1; ++k) {
        const Step &x = program.steps[pairs[j].step], &y = program.steps[pairs[k].step];
        const int together = pairs[j].calls + pairs[k].calls;
        if (x.a != sine.a || y.a != sine.a || x.p + y.p != sine.p || together > most_calls) continue;
        calls = together;
        sine.products = cosine.products = 2;
        sine.first_product = static_cast<Index>(program.products.size());
        cosine.first_product = sine.first_product + 2;
        program.products.push_back({x.out, y.w, none, 1});
        program.products.push_back({x.w, y.out, none, 1});
        program.products.push_back({x.w, y.w, none, 1});
        program.products.push_back({x.out, y.out, none, -1});
      }
    pairs.push_back({i, calls});
  }
}

/// Gives lanes their slots. The two slots of a lane lie side by side in one half of a four, so that the higher factors
/// of a four are its lower ones with neighbours exchanged.
constexpr void place_lanes(Program& program) {
  const std::size_t lanes = program.lane_a.size();
  program.low.reserve(2 * lanes + 4);
  program.high.reserve(2 * lanes + 4);
  program.slot.assign(lanes, 0);
  const auto add = [&](Index low, Index high) {
    program.low.push_back(low);
    program.high.push_back(high);
  };
  for (const bool square : {false, true})
    for (std::size_t i = 0; i < lanes; ++i) {
      const Index a = program.lane_a[i], b = program.lane_b[i];
      if ((a == b) != square) continue;
      program.slot[i] = static_cast<Index>(program.low.size());
      add(a, b);
      if (!square) add(b, a);
    }
  while (program.low.size() % 4 != 0) add(program.low.back(), program.low.back());  // padding
}

/// Makes that factor of each product the second one which is known later within an order: steps add the terms with the
/// second factor last, which shortens the chain of dependences from one order to the next. `late` is roughly the number
/// of operations from the beginning of an order, where the variables are known, until a value is known.
constexpr void place_late_factors_last(Program& program) {
  std::vector<int> late(static_cast<std::size_t>(program.rows), -4);
  const auto of = [&](Index value) -> int& { return late[static_cast<std::size_t>(value)]; };
  for (const Step& step : program.steps) of(step.out) = 0;
  for (std::size_t i = 0; i < program.variables; ++i)
    of(Program::first_variable + static_cast<Index>(i)) = std::min(of(program.rate[i]), 0);
  for (const Step& step : program.steps) {
    int last = step.a == none ? -4 : of(step.a);
    if (step.rule == Rule::quotient || step.rule == Rule::select) last = std::max(last, of(step.b));
    if (step.rule == Rule::linear_product) last = std::max(last, of(step.w));
    const Program::Value* const values = program.values.data() + step.first_value;
    for (Index i = 0; i < step.values; ++i) last = std::max(last, of(values[i].value));
    Program::Product* const products = program.products.data() + step.first_product;
    for (Index i = 0; i < step.products; ++i) {
      if (of(products[i].a) > of(products[i].b)) std::swap(products[i].a, products[i].b);
      last = std::max(last, of(products[i].b));
    }
    of(step.out) = last + 1;
  }
}

/// Returns the program of the rates ẋ of all variables, nodes of the tape in the order of the variables. The first
/// `most` variables are the motion; the rates of the others do not change the motion by a bit.
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
  if (most < rates.size()) {  // step lengths, which these flags and lists decide on, are a matter of the motion
    const bool converges = program.whole, ends = program.partial;
    const std::size_t seen = program.switches.size(), known = program.poles.size();
    lowering.lower(rates.subspan(most));
    program.whole = converges;
    program.partial = ends;
    program.switches.resize(seen);
    program.poles.resize(known);
  }
  start_by_addition(program);
  gather(program);
  place_late_factors_last(program);
  place_lanes(program);
  return program;
}

}  // namespace least::tape

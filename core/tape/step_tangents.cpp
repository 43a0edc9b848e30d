#include "core/tape/step_tangents.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/tape/step_passes.hpp"
#include "core/tape/tangent_rules.hpp"
#include "core/tape/wide.hpp"  // results do not depend on the width of registers

namespace least::tape {

/// Plan appends the terms and sums of a step, without their factors, when `derive` calls it.
struct StepTangents::Plan {
  StepTangents& of;
  bool moves(Index x) const { return x != none && of.slot_[tape::at(x)] != none; }
  double value(Index) const { return 1; }
  void add(Index x, double) const {
    if (moves(x)) of.terms_.push_back({of.slot_[tape::at(x)], of.reach_[tape::at(x)], Side{}});
  }
  void add_sum(Index x, Index y, double, double a, double b) const {
    const std::size_t reach = of.reach_[tape::at(y)];
    if (moves(x) && reach > 1)
      of.sums_.push_back({of.slot_[tape::at(x)], y, of.reach_[tape::at(x)], reach, a, b, Side{}});
  }
};
/// Factors sets the factors of the planned terms and sums in the lane `step`, from order 0.
struct StepTangents::Factors {
  StepTangents& of;
  std::size_t step;
  Term* term;
  Sum* sum;
  bool moves(Index x) const { return x != none && of.slot_[tape::at(x)] != none; }
  double value(Index x) const { return of.row_[tape::at(x)]; }
  void add(Index x, double factor) {
    if (moves(x)) term++->factor.lane[step] = factor;
  }
  void add_sum(Index x, Index y, double factor, double, double) {
    if (moves(x) && of.reach_[tape::at(y)] > 1) sum++->factor.lane[step] = factor;
  }
};

StepTangents::StepTangents(Program program, int order, bool along)
    : program_(std::move(program)), order_(static_cast<std::size_t>(order)), along_(along) {
  const Kinds kinds(program_);
  reach_ = kinds.reach;
  slot_.assign(tape::at(program_.rows), none);
  Index slots = 0;
  for (std::size_t value = 0; value < slot_.size(); ++value)
    if (kinds.moves[value]) slot_[value] = slots++;
  for (const Step& s : program_.steps) {
    if (slot_[tape::at(s.out)] == none) continue;
    Planned planned{slot_[tape::at(s.out)], terms_.size(), 0, sums_.size(), 0, reach_[tape::at(s.out)] > 1};
    derive(program_, s, Plan{*this});
    planned.terms_end = terms_.size();
    planned.sums_end = sums_.size();
    planned_.push_back(planned);
  }
  rows_.resize(slot_.size() * (order_ + 1));
  gains_.resize(program_.steps.size());
  row_.resize(slot_.size());
  const std::size_t columns = along ? 1 : program_.variables, parts = (columns + most_columns - 1) / most_columns;
  for (std::size_t part = 0; part < parts; ++part) {
    Group& group = groups_.emplace_back();
    group.first = part * columns / parts;
    group.count = (part + 1) * columns / parts - group.first;
    group.rows.resize(tape::at(slots) * (order_ + 1) * group.count);
    group_.insert(group_.end(), group.count, part);
  }
  if (along) directions_.resize(program_.variables);
  matrices_.resize(steps * (along ? 2 * program_.moving : 3 * entries()));
  found_.resize(2 * most_columns * sums_.size());
}

std::size_t StepTangents::numbers(const Program& program, int order, bool along) {
  const std::size_t columns = along ? 1 : program.variables;
  return tape::at(program.rows) * (static_cast<std::size_t>(order) + 1) * (columns + 1) * steps;
}

const StepTangents::Side* StepTangents::series_of(std::size_t i, std::size_t c, std::size_t& stride) const {
  const Group& group = groups_[group_[c]];
  const std::size_t slot = tape::at(slot_[tape::at(Program::first_variable) + i]);
  stride = group.count;
  return group.rows.data() + slot * (order_ + 1) * stride + (c - group.first);
}

/// Computes order 0 and the factors that follow from it, for one of the steps side by side.
void StepTangents::begin(std::size_t step, const double* y, double t) {
  double* const row = row_.data();
  const Lists lists{program_.values.data(), program_.products.data()};
  const Rules<false> rules{lists, lists};
  std::copy_n(y, program_.variables, row + Program::first_variable);
  row[program_.time()] = t;
  for (const Step& s : program_.linear) rules.begin(s, s, row);
  for (const Step& s : program_.steps) rules.begin(s, s, row);
  for (std::size_t value = 0; value < row_.size(); ++value) rows_[value * (order_ + 1)].lane[step] = row[value];
  Factors factors{*this, step, terms_.data(), sums_.data()};
  for (std::size_t i = 0; i < program_.steps.size(); ++i) {
    const Step& s = program_.steps[i];
    double& gain = gains_[i].lane[step];
    if (s.rule == Rule::quotient || s.rule == Rule::linear_quotient) gain = 1 / row[s.b];
    if (s.rule == Rule::root) gain = 0.5 / row[s.out];
    if (s.rule == Rule::power || s.rule == Rule::linear_power) gain = 1 / row[s.a];
    if (s.rule == Rule::log_like) gain = 1 / row[s.w];
    if (slot_[tape::at(s.out)] != none) derive(program_, s, factors);
  }
}

template <std::size_t Wide>
[[gnu::always_inline]] inline void StepTangents::expand_all() {
  for (std::ptrdiff_t part = 0; part < parts<Wide>; ++part) {
    Motion<Wide>(*this, part).go();
    for (Group& group : groups_) {
      if (group.count == 1) Columns<Wide, 1>(*this, group, part).go();
      if (group.count == 2) Columns<Wide, 2>(*this, group, part).go();
      if (group.count == 3) Columns<Wide, 3>(*this, group, part).go();
      if (group.count == 4) Columns<Wide, 4>(*this, group, part).go();
    }
  }
}
void StepTangents::expand_by_two() { expand_all<2>(); }
LEAST_BY_FOUR void StepTangents::expand_by_four() { expand_all<4>(); }
LEAST_BY_EIGHT void StepTangents::expand_by_eight() { expand_all<8>(); }

void StepTangents::expand(std::span<const double> y, std::span<const double> t, std::span<const double> directions) {
  const std::size_t count = t.size();
  for (std::size_t step = 0; step < steps; ++step) {
    const std::size_t like = std::min(step, count - 1);
    begin(step, y.data() + like * program_.variables, t[like]);
    for (std::size_t i = 0; i < directions_.size(); ++i)
      directions_[i].lane[step] = directions[like * program_.variables + i];
  }
  std::ranges::fill(rows_[tape::at(program_.time()) * (order_ + 1) + 1].lane, 1.0);
  if (LEAST_HAS_BY_EIGHT) return expand_by_eight();
  if (LEAST_HAS_BY_FOUR) return expand_by_four();
  expand_by_two();
}

LEAST_WIDE void StepTangents::find_changes(std::span<const double> h) {
  std::array<double, steps> length, sum;
  for (std::size_t step = 0; step < steps; ++step) length[step] = h[std::min(step, h.size() - 1)];
  std::size_t stride = 0, entry = 0;
  for (std::size_t i = 0; i < program_.moving; ++i)
    for (std::size_t c = 0; c < program_.variables; ++c, ++entry) {
      const Side* const rows = series_of(i, c, stride);
      sum.fill(0);
      for (std::size_t k = order_; k > 0; --k)
        for (std::size_t step = 0; step < steps; ++step)
          sum[step] = (sum[step] + rows[k * stride].lane[step]) * length[step];
      const double *const last = rows[order_ * stride].lane, *const before = rows[(order_ - 1) * stride].lane;
      double* to = matrices_.data() + entry;
      for (std::size_t step = 0; step < steps; ++step, to += 3 * entries()) {
        to[0] = sum[step];
        to[entries()] = last[step];
        to[2 * entries()] = before[step];
      }
    }
}

void StepTangents::change_in(double h, std::size_t step, double* change) const {
  std::size_t stride = 0;
  for (std::size_t i = 0; i < program_.moving; ++i)
    for (std::size_t c = 0; c < program_.variables; ++c) {
      const Side* const rows = series_of(i, c, stride);
      double sum = 0;
      for (std::size_t k = order_; k > 0; --k) sum = (sum + rows[k * stride].lane[step]) * h;
      *change++ = sum;
    }
}

const StepTangents::Side* StepTangents::series_along(std::size_t i) const {
  std::size_t stride = 0;  // 1: there is one direction
  if (i >= program_.moving) return series_of(i - program_.moving, 0, stride);
  return rows_.data() + place(Program::first_variable + static_cast<Index>(i), 0);
}

LEAST_WIDE void StepTangents::find_changes_along(std::span<const double> h) {
  std::array<double, steps> length, sum;
  for (std::size_t step = 0; step < steps; ++step) length[step] = h[std::min(step, h.size() - 1)];
  const std::size_t all = 2 * program_.moving;
  for (std::size_t i = 0; i < all; ++i) {
    const Side* const row = series_along(i);
    sum.fill(0);
    for (std::size_t k = order_; k > 0; --k)
      for (std::size_t step = 0; step < steps; ++step) sum[step] = (sum[step] + row[k].lane[step]) * length[step];
    for (std::size_t step = 0; step < steps; ++step) matrices_[step * all + i] = sum[step];
  }
}

void StepTangents::change_along_in(double h, std::size_t step, double* change) const {
  for (std::size_t i = 0; i < 2 * program_.moving; ++i) {
    const Side* const row = series_along(i);
    double sum = 0;
    for (std::size_t k = order_; k > 0; --k) sum = (sum + row[k].lane[step]) * h;
    *change++ = sum;
  }
}

}  // namespace least::tape

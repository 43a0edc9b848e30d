#include "core/ensemble/text_group.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "core/ensemble/lane_members.hpp"

namespace least {

void TextGroup::add(std::size_t member, std::vector<double> constants) {
  members_.push_back(member);
  constants_.push_back(std::move(constants));
}

std::optional<CompiledLanes> TextGroup::compiled(LaneSource source) const {
  source.trace = &shape_.trace;
  source.rows = shape_.rows;
  const auto& first = shape_.trace.constants();
  source.own.assign(first.size(), false);
  for (const auto& constants : constants_)
    for (std::size_t k = 0; k < constants.size(); ++k)
      if (std::bit_cast<std::uint64_t>(constants[k]) != std::bit_cast<std::uint64_t>(first[k])) source.own[k] = true;
  return CompiledLanes(source);
}

void TextGroup::compile() {
  LaneSource steps, values;
  steps.begin = shape_.begin;
  steps.end = shape_.end;
  steps.kept = shape_.kept;
  steps.outputs = shape_.state;
  steps.failed = shape_.failed;
  steps.forces_at_start = shape_.forces_at_start;
  steps.forces_of_step = shape_.forces_of_step;
  steps_ = compiled(std::move(steps));
  values.steps = false;
  values.end = shape_.values_end;
  values.outputs = shape_.columns;
  columns_ = compiled(values);
  values.outputs = shape_.start;
  if (shape_.pole >= 0) values.outputs.push_back(shape_.pole);
  starts_ = compiled(values);
  step_ = steps_->program();
  column_ = columns_->program();
  start_ = starts_->program();
  own_of_step_.resize(step_.own * members_.size());
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const auto own = own_of(m, *steps_);
    for (std::size_t k = 0; k < own.size(); ++k) own_of_step_[k * members_.size() + m] = own[k];
  }
}

std::vector<double> TextGroup::own_of(std::size_t i, const CompiledLanes& lanes) const {
  std::vector<double> own;
  for (const std::size_t k : lanes.own()) own.push_back(constants_[i][k]);
  return own;
}

bool TextGroup::starts(std::size_t i, double t, double h, const double* state) const {
  const auto own = own_of(i, *starts_);
  std::vector<double> values(start_.outputs.size());
  evaluate_in_lanes(start_, {t, h, state, own.data()}, values.data());
  if (shape_.pole >= 0) {
    if (h > 0 && values.back() != 0) return false;
    values.pop_back();
  }
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

void TextGroup::columns(std::size_t i, double t, const double* state, double* out) const {
  const auto own = own_of(i, *columns_);
  evaluate_in_lanes(column_, {t, 0, state, own.data()}, out);
}

bool TextGroup::advance(std::size_t i, double t, double h, const double* before, double* state) const {
  const auto own = own_of(i, *steps_);
  std::array<double, program_rows + 1> after{};
  evaluate_in_lanes(step_, {t, h, before, own.data()}, after.data());
  const std::size_t rows = shape_.rows.size();
  bool good = after[rows] == 0;  // that it failed
  for (std::size_t k = 0; k < rows; ++k) {
    state[shape_.rows[k]] = after[k];
    good = good && std::isfinite(after[k]);
  }
  return good;
}

}  // namespace least

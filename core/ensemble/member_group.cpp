#include "core/ensemble/member_group.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/ensemble/lane_members.hpp"
#include "core/exact/elements.hpp"
#include "core/run/columns.hpp"

namespace least {
namespace {

template <int N>
double element_of(const std::vector<double>& orbit, std::size_t number) {
  Vec<N> q, p;
  std::copy_n(orbit.begin(), N, q.begin());
  std::copy_n(orbit.begin() + N, N, p.begin());
  return two_body::element(two_body::elements(q, p, orbit.back()), number);
}

}  // namespace

void MemberGroup::add(std::size_t member, std::vector<double> constants) {
  members_.push_back(member);
  if (!constants.empty()) constants_.push_back(std::move(constants));
}

void MemberGroup::set_parameter(std::size_t k, std::span<const double> values) {
  replaced_[constant_at(shape_.parameters[k])].assign(values.begin(), values.end());
}

double MemberGroup::constant_of(std::size_t i, std::size_t constant) const {
  if (const auto own = replaced_.find(constant); own != replaced_.end()) return own->second[i];
  return constants_.empty() ? shape_.trace.constants()[constant] : constants_[i][constant];
}

MemberGroup::Program MemberGroup::compiled(LaneSource source) const {
  source.trace = &shape_.trace;
  source.rows = shape_.rows;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const auto& first = shape_.trace.constants();
  source.own.assign(first.size(), false);
  for (const auto& constants : constants_)
    for (std::size_t k = 0; k < constants.size(); ++k)
      if (bits(constants[k]) != bits(first[k])) source.own[k] = true;
  for (const auto& [k, values] : replaced_)
    source.own[k] = std::ranges::any_of(values, [&, k = k](double x) { return bits(x) != bits(first[k]); });
  auto made = std::make_unique<MemberProgram>(source);
  const auto& own = made->lanes.own();
  made->own.reserve(own.size() * members_.size());
  for (std::size_t i = 0; i < members_.size(); ++i)
    for (const std::size_t k : own) made->own.push_back(constant_of(i, k));
  return made;
}

void MemberGroup::compile_values() {
  LaneSource values;
  values.steps = false;
  values.end = shape_.values_end;
  values.outputs = shape_.columns;
  values.outputs.insert(values.outputs.end(), shape_.orbit.begin(), shape_.orbit.end());
  columns_ = compiled(values);
  values.outputs = shape_.start;
  for (const auto place : {shape_.pole, shape_.inside, shape_.turn, shape_.damping})
    if (place >= 0) values.outputs.push_back(place);
  starts_ = compiled(values);
}

void MemberGroup::compile_steps() {
  LaneSource steps;
  steps.begin = shape_.begin;
  steps.end = shape_.end;
  steps.kept = shape_.kept;
  steps.outputs = shape_.state;
  steps.failed = shape_.failed;
  steps.forces_at_start = shape_.forces_at_start;
  steps.forces_of_step = shape_.forces_of_step;
  steps_ = compiled(std::move(steps));
  const std::size_t own = steps_->view.own, count = members_.size();
  own_of_step_.resize(own * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < own; ++k) own_of_step_[k * count + i] = steps_->own[i * own + k];
}

const double* MemberGroup::evaluate(const MemberProgram& program, std::size_t i, double t, double h,
                                    const double* state) {
  values_.resize(std::max(program.view.outputs.size(), program.view.rows.size() + 1));
  evaluate_in_lanes(program.view, {t, h, state, program.own.data() + i * program.view.own}, values_.data());
  return values_.data();
}

ReturnCode MemberGroup::objection_to_start(std::size_t i, const LaneTask& task, const double* state, bool near) {
  using enum ReturnCode;
  const double* const values = evaluate(*starts_, i, task.start_time, task.step, state);
  const double* next = values + shape_.start.size();
  const auto value = [&](Trace::Place place, double otherwise) { return place >= 0 ? *next++ : otherwise; };
  const double pole = value(shape_.pole, 0), inside = value(shape_.inside, 0), turn = value(shape_.turn, 0),
               damping = value(shape_.damping, 0);
  const bool moves = task.steps > 0;
  const double square = task.step * task.step, damping_step = std::max(damping, 0.0) * task.step;
  double limit = std::numeric_limits<double>::infinity();
  if (shape_.turn_limit >= 0) {
    limit = task.host->turn_limit(damping_step) / square;
    auto& limits = replaced_[constant_at(shape_.turn_limit)];
    limits.resize(members_.size(), limit);
    limits[i] = limit;
  }
  if (!near) return completed;
  if (inside < 0) return left_domain;
  if (!std::all_of(values, values + shape_.start.size(), [](double x) { return std::isfinite(x); })) return singular;
  if (!moves) return completed;
  if (pole != 0) return singular;
  const bool too_fast =
      shape_.turn_is_fixed ? shape_.turn >= 0 && task.host->is_too_fast(turn * square, damping_step) : turn > limit;
  return too_fast ? unstable_step : completed;
}

void MemberGroup::columns(std::size_t i, double t, const double* state, double* out) {
  const double* const values = evaluate(*columns_, i, t, 0, state);
  const std::size_t count = shape_.columns.size();
  std::copy_n(values, count, out);
  for (const std::size_t column : shape_.wrapped) out[column] = wrapped(out[column]);
  if (shape_.elements.empty()) return;
  const std::vector<double> orbit(values + count, values + count + shape_.orbit.size());
  for (const auto& [column, number] : shape_.elements)
    out[column] = orbit.size() == 5 ? element_of<2>(orbit, number) : element_of<3>(orbit, number);
}

bool MemberGroup::advance(std::size_t i, double t, double h, const double* before, double* state) {
  const double* const after = evaluate(*steps_, i, t, h, before);
  const std::size_t rows = shape_.rows.size();
  bool good = shape_.failed < 0 || after[rows] != static_cast<double>(StepFailure::singular);
  for (std::size_t k = 0; k < rows; ++k) {
    state[shape_.rows[k]] = after[k];
    good = good && std::isfinite(after[k]);
  }
  return good;
}

}  // namespace least

#include "core/variations/varied_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/run/run_state.hpp"
#include "core/schemes/least_size.hpp"
#include "core/tape/derivative.hpp"
#include "core/variations/start.hpp"

namespace least::variations {

bool switches(const ParametricScene& scene) {
  for (tape::Index i = 0; i < scene.tape.size(); ++i)
    if (scene.tape[i].op == tape::Op::select) return true;
  return false;
}

VariedMotion::VariedMotion(const ParametricScene& scene, std::span<const Direction> directions,
                           std::span<const std::pair<std::size_t, std::size_t>> pairs, double tolerance, int order)
    : size_(scene.components),
      tolerance_(tolerance),
      order_(order),
      by_(directions.begin(), directions.end()),
      pairs_(pairs.begin(), pairs.end()),
      parameters_(scene.parameters),
      first_{by_.size(), tape::Tangents::lanes_of(by_.size()), std::vector<int>(by_.size())},
      second_{pairs_.size(), tape::Tangents::lanes_of(pairs_.size()), std::vector<int>(pairs_.size())} {
  for (const Direction& direction : by_)
    for (const ParameterChange& change : direction) varied_.push_back(change.parameter);
  std::ranges::sort(varied_);
  varied_.erase(std::unique(varied_.begin(), varied_.end()), varied_.end());
  tape::Program program = program_of(scene, varied_);
  if (by_.empty()) {
    expansion_.emplace(std::move(program), tolerance, order);
  } else if (pairs_.empty() && StepsAhead::suit(program, by_.size())) {
    varied_program_ = program;
    held_.add(StepsAhead::numbers(program) * sizeof(double));
    ahead_.emplace(program_of(scene, {}), std::move(program), tolerance, order);
  } else {
    follow_directions(std::move(program));
  }
  if (switches(scene)) prepare_switches(scene);
}

/// follow_directions prepares to follow all directions together, step by step.
void VariedMotion::follow_directions(tape::Program program) {
  constexpr std::size_t most_numbers = 1 << 23;  // more would not fit into the caches, and is not needed
  expansion_.emplace(taylor::Expansion::of_all_values(std::move(program), tolerance_, order_));
  const tape::Program& known = expansion_->program();
  const std::size_t numbers = tape::Tangents::numbers(known, expansion_->order(), by_.size(), pairs_.size());
  if (numbers > most_numbers && by_.size() + pairs_.size() > 1) throw tape::TooManyOperations();
  held_.add(numbers * sizeof(double));
  tangents_.emplace(known, expansion_->order(), by_.size(), pairs_);
}

/// follow_one_by_one gives up precomputed steps until the next start.
void VariedMotion::follow_one_by_one() {
  one_by_one_ = true;
  if (!expansion_) follow_directions(*varied_program_);
}

void VariedMotion::prepare_switches(const ParametricScene& scene) {
  tape::Tape tape = scene.tape;  // a copy, as constants may have to be added
  std::vector<tape::Index> places, conditions;
  for (const Symbol& rate : scene.rates) places.push_back(rate.on(tape));
  for (const tape::Index place : places)
    for (const tape::Index part : tape::parts_of(tape, place))
      if (tape[part].op == tape::Op::select) conditions.push_back(tape[part].a);
  std::ranges::sort(conditions);
  conditions.erase(std::unique(conditions.begin(), conditions.end()), conditions.end());
  places.insert(places.end(), conditions.begin(), conditions.end());
  sides_.emplace(tape, places);
}

/// program_of returns the program of the motion with numbers for all parameters, except the varied ones: these become
/// variables of rate 0 behind the state, in this order.
tape::Program VariedMotion::program_of(const ParametricScene& scene, const std::vector<std::size_t>& varied) const {
  std::vector<bool> all(scene.varied.size(), false);
  for (const std::size_t parameter : varied) all[parameter] = true;
  if (scene.motion && varied.empty()) return *scene.motion;
  if (scene.varied_motion && all == scene.varied) return *scene.varied_motion;
  tape::Tape tape;
  std::vector<Symbol> x, rates(size_);
  for (std::size_t i = 0; i < size_; ++i) x.push_back(Symbol::variable(tape, i));
  for (const double parameter : parameters_) x.emplace_back(parameter);
  for (std::size_t k = 0; k < varied.size(); ++k) x[size_ + varied[k]] = Symbol::variable(tape, size_ + k);
  formula_of(scene, scene.rates).evaluate(x.data(), Symbol::time(tape), rates.data());
  rates.resize(size_ + varied.size());
  std::vector<tape::Index> places;
  places.reserve(rates.size());
  for (const Symbol& rate : rates) places.push_back(rate.on(tape));
  // With numbers put in, equations with kept sums may become longer than those of the scene, which are limited.
  if (static_cast<std::size_t>(tape.size()) > tape::most_of_equations) throw tape::TooManyOperations();
  return taylor::program_of(tape, places, size_);
}

void VariedMotion::put(Level& level, const std::vector<double>& derivatives) {
  for (auto* numbers : {&level.u, &level.low, &level.seen, &level.low_seen})
    numbers->assign(y_.size() * level.lanes, 0);
  std::ranges::fill(level.exponents, 0);
  for (std::size_t d = 0; d < level.count; ++d)
    for (std::size_t i = 0; i < size_; ++i) level.u[i * level.lanes + d] = derivatives[d * size_ + i];
}

void VariedMotion::take(const Level& level, std::vector<double>& derivatives) const {
  derivatives.reserve(level.count * size_);
  for (std::size_t d = 0; d < level.count; ++d)
    for (std::size_t i = 0; i < size_; ++i)
      derivatives.push_back(std::ldexp(level.seen[i * level.lanes + d], level.exponents[d]));
}

void VariedMotion::start(std::span<const double> x, const Derivatives& derivatives, double t) {
  begin(x, derivatives, t);
  settle_scales();
  plan();
}

void VariedMotion::start_with_control(std::span<const double> x, const Derivatives& derivatives, double t,
                                      std::span<const double> weights, int control_order) {
  begin(x, derivatives, t);
  if (ahead_) {
    std::vector<double> sum(y_.size());
    for (std::size_t i = 0; i < sum.size(); ++i)
      for (std::size_t d = 0; d < by_.size(); ++d) sum[i] += weights[d] * first_.u[i * first_.lanes + d];
    held_.add(ControlMotion::numbers(*varied_program_) * sizeof(double));
    ahead_->control(*varied_program_, control_order, std::move(sum));
  }
  settle_scales();
  plan();
}

std::optional<std::vector<double>> VariedMotion::control() {
  if (!ahead() || !ahead_->controlled()) return std::nullopt;
  return ahead_->control_at(looked_ - t_, std::span(seen_).first(size_), std::span(low_seen_).first(size_));
}

/// begin sets state, derivatives and time, before any step is planned.
void VariedMotion::begin(std::span<const double> x, const Derivatives& derivatives, double t) {
  t_ = t;
  longest_ = 0;
  y_.assign(x.begin(), x.end());
  for (const std::size_t parameter : varied_) y_.push_back(parameters_[parameter]);
  low_.assign(y_.size(), 0);
  put(first_, derivatives.first);
  put(second_, derivatives.second);
  for (std::size_t d = 0; d < by_.size(); ++d)
    for (const auto& [parameter, by] : by_[d]) {
      const auto k = static_cast<std::size_t>(std::ranges::find(varied_, parameter) - varied_.begin());
      first_.u[(size_ + k) * first_.lanes + d] = by;
    }
  if (least_size_ == 0) least_size_ = least_size(largest_of(x));
  if (ahead_) {
    ahead_->begin();
    ahead_->expansion().set_least_size(least_size_);
  }
  one_by_one_ = false;
}

/// settle scales each direction to about the size of the state, which decides step sizes. `beside` is the size of the
/// terms that drive it.
void VariedMotion::settle(Level& level, std::span<const double> beside) {
  const int wanted = std::ilogb(std::max(least_size_, largest_of(std::span(y_).first(size_))));
  for (std::size_t d = 0; d < level.count; ++d) {
    double size = beside.empty() ? 0 : std::abs(beside[d]);
    for (std::size_t at = d; at < level.u.size(); at += level.lanes)
      if (!(std::abs(level.u[at]) <= size)) size = std::abs(level.u[at]);
    const int by = size > 0 && std::isfinite(size) ? wanted - std::ilogb(size) : 0;
    if (by == 0) continue;
    level.exponents[d] -= by;
    for (std::size_t at = d; at < level.u.size(); at += level.lanes) {
      level.u[at] = std::ldexp(level.u[at], by);
      level.low[at] = std::ldexp(level.low[at], by);
    }
  }
}

void VariedMotion::settle_scales() {
  settle(first_, {});
  const auto share = [&](std::size_t k) {
    const auto [d, e] = pairs_[k];
    return std::ldexp(1, first_.exponents[d] + first_.exponents[e] - second_.exponents[k]);
  };
  shares_.resize(pairs_.size());
  for (std::size_t k = 0; k < pairs_.size(); ++k) shares_[k] = share(k);
  settle(second_, shares_);
  for (std::size_t k = 0; k < pairs_.size(); ++k) shares_[k] = share(k);
  seen_ = y_;
  for (Level* level : {&first_, &second_}) level->seen = level->u;
}

void VariedMotion::plan() {
  if (ahead()) {
    if (plan_ahead()) return;
    follow_one_by_one();  // for example near the end of a motion
  }
  expansion_->set_least_size(least_size_);
  expansion_->move(y_.data(), t_);
  double step = expansion_->step();
  if (tangents_) {
    tangents_->expand(expansion_->series(), first_.u, second_.u, shares_);
    step = std::min(step, derivatives_step());
  }
  reach_ = t_ + step;
  if (!(reach_ - t_ > 1e-13 * std::max(std::abs(t_), longest_))) reach_ = t_;  // the motion ends here
}

/// plan_ahead sets reach_ to the end of the next precomputed step, or to the part of it in which the derivatives are
/// accurate enough. False: there is none.
bool VariedMotion::plan_ahead() {
  if (!ahead_->next(y_, low_, t_, 1e-13 * longest_)) return false;
  const double term =
      taylor::Expansion::allowed * tolerance_ * std::max(least_size_, largest_of(std::span(y_).first(size_)));
  double step = ahead_->end() - t_;
  const double whole = step;
  const auto heed = [&](double largest, int k) {
    if (k > 0 && largest * std::pow(whole, k) > term) step = std::min(step, std::pow(term / largest, 1.0 / k));
    return std::isfinite(largest);
  };
  const auto [last, before] = ahead_->last_terms(first_.u, first_.lanes);
  if (!heed(last, order()) || !heed(before, order() - 1)) return false;
  reach_ = step < whole ? t_ + step : ahead_->end();
  return reach_ - t_ > 1e-13 * std::max(std::abs(t_), longest_);
}

/// derivatives_step returns the step for which the last two terms of the derivatives' series meet the tolerance.
double VariedMotion::derivatives_step() {
  double step = std::numeric_limits<double>::infinity();
  const double term =
      taylor::Expansion::allowed * tolerance_ * std::max(least_size_, largest_of(std::span(y_).first(size_)));
  const int told = tangents_->told();
  for (int k = std::max(1, told - 1); k <= told; ++k)
    if (const double last = tangents_->largest(k); last > 0) step = std::min(step, std::pow(term / last, 1.0 / k));
  return told > 0 ? step : 0;
}

template <class T>
std::vector<T> VariedMotion::sides(const std::vector<T>& x, const T& t) const {
  std::vector<T> values(sides_->outputs());
  sides_->evaluate(x.data(), t, values.data());
  return values;
}

std::vector<double> VariedMotion::with_parameters(const std::vector<double>& y) const {
  std::vector<double> x(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(size_));
  x.insert(x.end(), parameters_.begin(), parameters_.end());
  return x;
}

/// rates_before returns f₋ at the end `to` of a step that has just crossed a switch, by the formulas of the side that
/// it left. It extrapolates from two points slightly before `to`, or, where the step is so short that these would lie
/// behind the switch, takes the first terms of the series.
std::vector<double> VariedMotion::rates_before(double to) const {
  constexpr double part = 1e-6, behind = 64 * std::numeric_limits<double>::epsilon();
  const double h = to - t_, little = part * h;
  std::vector<double> rates(size_);
  if (!(little > behind * std::abs(to))) {
    const tape::Series& series = expansion_->series();
    for (std::size_t i = 0; i < size_; ++i) rates[i] = series.coefficients(1)[i] + 2 * h * series.coefficients(2)[i];
    return rates;
  }
  const auto rates_at = [&](double t) {
    std::vector<double> y = y_, low = low_;
    expansion_->evaluate(t - t_, low.data(), y.data());
    return sides(with_parameters(y), t);
  };
  const std::vector<double> near = rates_at(to - little), far = rates_at(to - 2 * little);
  for (std::size_t i = 0; i < size_; ++i) rates[i] = 2 * near[i] - far[i];
  return rates;
}

/// cross_switch corrects the derivatives seen at `to` by the jump of the rates, where the step has just crossed a
/// switch.
void VariedMotion::cross_switch(double to) {
  const std::vector<double> values = with_parameters(seen_);
  const std::vector<double> before = sides(with_parameters(y_), t_), after = sides(values, to);
  std::size_t changed = size_;
  while (changed < after.size() && (before[changed] < 0) == (after[changed] < 0)) ++changed;
  if (changed == after.size()) return;
  const std::vector<double> rates = rates_before(to);  // f₋
  std::vector<double> jump(size_), u(size_);
  for (std::size_t i = 0; i < size_; ++i) jump[i] = rates[i] - after[i];
  const auto slope_along = [&](std::span<const double> slope, const Direction& direction, double share, double dt) {
    std::vector<Slope> x(values.begin(), values.end());
    for (std::size_t i = 0; i < size_; ++i) x[i].slope[0] = slope[i];
    for (const auto& [parameter, by] : direction) x[size_ + parameter].slope[0] = share * by;
    return sides(x, Slope{to, {dt}})[changed].slope[0];
  };
  const double pace = slope_along(rates, {}, 0, 1);
  for (std::size_t d = 0; d < by_.size(); ++d) {
    double* const lane = first_.seen.data() + d;
    for (std::size_t i = 0; i < size_; ++i) u[i] = lane[i * first_.lanes];
    const double later = -slope_along(u, by_[d], std::ldexp(1, -first_.exponents[d]), 0) / pace;
    for (std::size_t i = 0; i < size_; ++i) lane[i * first_.lanes] += jump[i] * later;
  }
}

bool VariedMotion::look(double t) {
  looked_ = t;
  motion().move(y_.data(), t_);
  seen_ = y_;
  low_seen_ = low_;
  motion().evaluate(t - t_, low_seen_.data(), seen_.data());
  const auto finite = [](double component) { return std::isfinite(component); };
  if (!std::ranges::all_of(seen_, finite)) return false;
  if (ahead()) {
    first_.seen = first_.u;
    first_.low_seen = first_.low;
    ahead_->change_in(t - t_, first_.seen, first_.low_seen, first_.lanes);
    return std::ranges::all_of(first_.seen, finite);
  }
  if (!tangents_) return true;
  for (Level* level : {&first_, &second_}) level->low_seen = level->low;
  tangents_->evaluate(t - t_, first_.seen, first_.low_seen, second_.seen, second_.low_seen);
  return std::ranges::all_of(first_.seen, finite) && std::ranges::all_of(second_.seen, finite);
}

/// step_to makes the state seen at `to` the beginning of the next step.
void VariedMotion::step_to(double to) {
  y_ = seen_;
  low_ = low_seen_;
  for (Level* level : {&first_, &second_}) {
    level->u = level->seen;
    level->low = level->low_seen;
  }
  longest_ = std::max(longest_, to - t_);
  t_ = to;
  settle_scales();
  plan();
}

/// advance_ahead takes the precomputed step, or a part of it. False: derivatives are not finite at its end.
bool VariedMotion::advance_ahead(double end) {
  const double to = std::min(reach_, end);
  if (!(to > t_)) return false;
  if (to < ahead_->end()) {
    if (!look(to)) return false;
    ahead_->take_part(to - t_, std::span(seen_).first(size_), std::span(low_seen_).first(size_));
    ahead_->leave(to == reach_ ? 0.98 * (to - t_) / (ahead_->end() - t_) : 1);
  } else {
    first_.seen = first_.u;
    first_.low_seen = first_.low;
    ahead_->change(first_.seen, first_.low_seen, first_.lanes);
    if (!std::ranges::all_of(first_.seen, [](double slope) { return std::isfinite(slope); })) return false;
    std::ranges::copy(ahead_->state(), seen_.begin());
    low_seen_ = low_;
    std::ranges::copy(ahead_->low(), low_seen_.begin());
    ahead_->take();
  }
  step_to(to);
  return true;
}

bool VariedMotion::advance(double end) {
  if (ahead()) {
    if (!(end > t_)) return false;
    if (advance_ahead(end)) return true;
    follow_one_by_one();
    plan();
  }
  // Halving stops once no number lies between `to` and t_: then the midpoint rounds to one of them.
  double before = std::numeric_limits<double>::infinity();
  for (double to = std::min(reach_, end); to > t_ && to < before; to = t_ + (to - t_) / 2) {
    before = to;
    if (!look(to)) continue;
    if (!expansion_->defined(seen_.data(), to)) continue;
    if (sides_) cross_switch(to);
    step_to(to);
    return true;
  }
  return false;
}

Derivatives VariedMotion::derivatives() const {
  Derivatives all;
  take(first_, all.first);
  take(second_, all.second);
  return all;
}

}  // namespace least::variations

#include "core/variations/varied_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/tape/derivative.hpp"

namespace least::variations {
namespace {

double largest_of(std::span<const double> x) {
  double most = 0;
  for (const double component : x) most = std::abs(component) <= most ? most : std::abs(component);
  return most;
}

}  // namespace

bool switches(const ParametricScene& scene) {
  for (tape::Index i = 0; i < scene.tape.size(); ++i)
    if (scene.tape[i].op == tape::Op::select) return true;
  return false;
}

VariedMotion::VariedMotion(const ParametricScene& scene, std::span<const Direction> directions,
                           std::span<const std::pair<std::size_t, std::size_t>> pairs, double tolerance, int order)
    : size_(scene.components), pairs_(pairs.begin(), pairs.end()), numbers_(size_) {
  const auto block = [&](bool shares) {
    Block made{numbers_, {}};
    numbers_ += size_;
    if (shares) made.share = numbers_++;
    return made;
  };
  for (const Direction& direction : directions) directions_.push_back(block(direction.has_value()));
  for (std::size_t k = 0; k < pairs_.size(); ++k) seconds_.push_back(block(true));
  expansion_.emplace(program_of(scene, directions), tolerance, order);
  if (switches(scene)) prepare_switches(scene, directions);
}

void VariedMotion::prepare_switches(const ParametricScene& scene, std::span<const Direction> directions) {
  tape::Tape tape = scene.tape;  // constants are written
  std::vector<tape::Index> places, conditions;
  for (const Symbol& rate : scene.rates) places.push_back(rate.on(tape));
  for (const tape::Index place : places)
    for (const tape::Index part : tape::parts_of(tape, place))
      if (tape[part].op == tape::Op::select) conditions.push_back(tape[part].a);
  std::ranges::sort(conditions);
  conditions.erase(std::unique(conditions.begin(), conditions.end()), conditions.end());
  places.insert(places.end(), conditions.begin(), conditions.end());
  sides_.emplace(tape, places);
  parameters_ = scene.parameters;
  by_.assign(directions.begin(), directions.end());
}

tape::Program VariedMotion::program_of(const ParametricScene& scene, std::span<const Direction> directions) {
  // Derived where parameters are variables, then written with numbers in their place.
  const std::size_t first = size_ + scene.parameters.size();
  tape::Tape tape = scene.tape;
  tape.bound(2 * tape::most_of_equations);
  const auto variable = [&](std::size_t number) { return Symbol::variable(tape, first + number); };
  std::vector<int> all(first);
  std::iota(all.begin(), all.end(), 0);
  const auto along = [&](const std::vector<Symbol>& slopes, std::size_t d) {
    Symbol sum;
    for (std::size_t j = 0; j < size_; ++j) sum += slopes[j] * variable(directions_[d].first + j);
    if (directions[d]) sum += slopes[size_ + *directions[d]] * variable(*directions_[d].share);
    return sum;
  };
  std::vector<Symbol> rates(numbers_);
  for (std::size_t i = 0; i < size_; ++i) {
    const Symbol rate = scene.rates[i].is_constant() ? scene.rates[i] : Symbol::at(tape, scene.rates[i].place());
    rates[i] = rate;
    const std::vector<Symbol> slopes = tape::gradient(tape, rate, all);
    std::vector<std::vector<Symbol>> second(directions_.size());
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      rates[directions_[d].first + i] = along(slopes, d);
      const bool paired = std::ranges::any_of(pairs_, [&](const auto& pair) { return pair.first == d; });
      if (paired) second[d] = tape::gradient(tape, rates[directions_[d].first + i], all);
    }
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto [d, e] = pairs_[k];
      Symbol sum = variable(*seconds_[k].share) * along(second[d], e);
      for (std::size_t j = 0; j < size_; ++j) sum += slopes[j] * variable(seconds_[k].first + j);
      rates[seconds_[k].first + i] = sum;
    }
  }
  tape::Tape folded;
  folded.bound(tape::most_of_equations);
  tape::Substitution fold(tape, folded, [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    if (number < size_) return Symbol::variable(folded, number);
    if (number < first) return Symbol(scene.parameters[number - size_]);
    return Symbol::variable(folded, number - first);
  });
  std::vector<tape::Index> places;
  places.reserve(rates.size());
  for (const Symbol& rate : rates) places.push_back(fold(rate).on(folded));
  return taylor::program_of(folded, places, places.size());
}

void VariedMotion::start(std::span<const double> x, const Derivatives& derivatives, double t) {
  t_ = t;
  longest_ = 0;
  y_.assign(numbers_, 0);
  low_.assign(numbers_, 0);
  std::ranges::copy(x, y_.begin());
  const auto put = [&](std::vector<Block>& blocks, const std::vector<double>& from) {
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      std::copy_n(from.data() + k * size_, size_, y_.data() + blocks[k].first);
      if (blocks[k].share) y_[*blocks[k].share] = 1;
      blocks[k].exponent = 0;
    }
  };
  put(directions_, derivatives.first);
  put(seconds_, derivatives.second);
  settle_scales();
  seen_ = y_;
  plan();
}

/// What is followed of a block is 2^`by` times as large from now on.
void VariedMotion::rescale(Block& block, int by) {
  for (std::size_t i = block.first; i < block.first + size_; ++i) {
    y_[i] = std::ldexp(y_[i], by);
    low_[i] = std::ldexp(low_[i], by);
  }
  block.exponent -= by;
}

/// Derivatives to about the size that decides on steps, with what drives them.
void VariedMotion::settle_scales() {
  const int wanted = std::ilogb(std::max(1.0, largest_of(std::span(y_).first(size_))));
  const auto missing = [&](const Block& block) {
    double size = largest_of(std::span(y_).subspan(block.first, size_));
    if (block.share) size = std::max(size, std::abs(y_[*block.share]));
    return size > 0 && std::isfinite(size) ? wanted - std::ilogb(size) : 0;
  };
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    const int by = missing(directions_[d]);
    if (by == 0) continue;
    rescale(directions_[d], by);
    if (directions_[d].share) y_[*directions_[d].share] = std::ldexp(y_[*directions_[d].share], by);
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      for (const std::size_t of : {pairs_[k].first, pairs_[k].second})
        if (of == d) y_[*seconds_[k].share] = std::ldexp(y_[*seconds_[k].share], -by);
  }
  for (Block& second : seconds_) {
    const int by = missing(second);
    if (by == 0) continue;
    rescale(second, by);
    y_[*second.share] = std::ldexp(y_[*second.share], by);
  }
}

void VariedMotion::plan() {
  expansion_->move(y_.data(), t_);
  reach_ = t_ + expansion_->step();
  if (!(reach_ - t_ > 1e-13 * std::max(std::abs(t_), longest_))) reach_ = t_;  // of a motion that ends
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

/// What a step to `to`, which is seen, has made of the derivatives, where it has ended shortly behind a switch.
void VariedMotion::cross_switch(double to) {
  const std::vector<double> before = sides(with_parameters(y_), t_), after = sides(with_parameters(seen_), to);
  std::size_t changed = size_;
  while (changed < after.size() && (before[changed] < 0) == (after[changed] < 0)) ++changed;
  if (changed == after.size()) return;
  // f₋ is that of the side that was left, from two looks a little back along the step.
  const std::vector<double> end = seen_, rest = low_seen_;
  const double little = 1e-6 * (to - t_);
  look(to - little);
  const std::vector<double> near = sides(with_parameters(seen_), to - little);
  look(to - 2 * little);
  const std::vector<double> far = sides(with_parameters(seen_), to - 2 * little);
  seen_ = end;
  low_seen_ = rest;
  std::vector<double> jump(size_), rates(size_);
  for (std::size_t i = 0; i < size_; ++i) {
    rates[i] = 2 * near[i] - far[i];
    jump[i] = rates[i] - after[i];
  }
  const std::vector<double> values = with_parameters(end);
  const auto slope_along = [&](std::span<const double> u, const Direction& direction, double share, double dt) {
    std::vector<Slope> x(values.begin(), values.end());
    for (std::size_t i = 0; i < size_; ++i) x[i].slope[0] = u[i];
    if (direction) x[size_ + *direction].slope[0] = share;
    return sides(x, Slope{to, {dt}})[changed].slope[0];
  };
  const double pace = slope_along(rates, {}, 0, 1);
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    const Block& block = directions_[d];
    double* const u = seen_.data() + block.first;
    const double later = -slope_along(std::span(u, size_), by_[d], block.share ? seen_[*block.share] : 0, 0) / pace;
    for (std::size_t i = 0; i < size_; ++i) u[i] += jump[i] * later;
  }
}

bool VariedMotion::look(double t) {
  expansion_->move(y_.data(), t_);
  seen_ = y_;
  low_seen_ = low_;
  expansion_->evaluate(t - t_, low_seen_.data(), seen_.data());
  return std::ranges::all_of(seen_, [](double component) { return std::isfinite(component); });
}

bool VariedMotion::advance(double end) {
  for (double to = std::min(reach_, end); to > t_; to = t_ + (to - t_) / 2) {
    if (!look(to)) continue;
    if (!expansion_->defined(seen_.data(), to)) continue;
    if (sides_) cross_switch(to);
    y_ = seen_;
    low_ = low_seen_;
    longest_ = std::max(longest_, to - t_);
    t_ = to;
    settle_scales();
    seen_ = y_;
    plan();
    return true;
  }
  return false;
}

Derivatives VariedMotion::derivatives() const {
  Derivatives all;
  const auto take = [&](const std::vector<Block>& blocks, std::vector<double>& to) {
    for (const Block& block : blocks)
      for (std::size_t i = 0; i < size_; ++i) to.push_back(std::ldexp(seen_[block.first + i], block.exponent));
  };
  take(directions_, all.first);
  take(seconds_, all.second);
  return all;
}

}  // namespace least::variations

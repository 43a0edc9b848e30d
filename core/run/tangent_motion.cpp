#include "core/run/tangent_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/run_state.hpp"
#include "core/schemes/least_size.hpp"
#include "core/tape/derivative.hpp"

namespace least {

tape::Program TangentMotion::program_of(tape::Tape equations, std::span<const tape::Index> rates,
                                        std::size_t directions) {
  if (equations.has_terms()) throw tape::TooManyOperations();  // terms that can be written out have been
  const std::size_t size = rates.size();
  equations.bound(tape::most_of_equations);
  std::size_t left = std::size_t(1) << 18;  // bound on operations: some hundredths of a second
  std::vector<tape::Index> all(rates.begin(), rates.end());
  all.resize(size * (1 + directions));
  for (std::size_t i = 0; i < size; ++i) {
    const auto slopes = tape::slopes_of(equations, Symbol::at(equations, rates[i]), 0, size, left);
    for (std::size_t d = 0; d < directions; ++d) {
      Symbol rate;
      for (const auto& [j, slope] : slopes) rate += slope * Symbol::variable(equations, (1 + d) * size + j);
      all[(1 + d) * size + i] = rate.on(equations);
    }
  }
  return taylor::program_of(equations, all, all.size());
}

TangentMotion::TangentMotion(tape::Tape equations, std::span<const tape::Index> rates, std::size_t directions,
                             double tolerance)
    : size_(rates.size()),
      directions_(directions),
      expansion_(
          std::make_shared<taylor::Expansion>(program_of(std::move(equations), rates, directions), tolerance, 0)) {}

void TangentMotion::start(std::span<const double> x, std::span<const double> tangents, double t) {
  t_ = t;
  scale_ = largest_of(x);
  expansion_->set_least_size(least_size(scale_));
  y_.assign(x.begin(), x.end());
  y_.insert(y_.end(), tangents.begin(), tangents.end());
  exponents_.assign(directions_, 0);
  low_.assign(y_.size(), 0);
  rescale();
  seen_ = y_;
}

std::size_t TangentMotion::operations() const {
  const tape::Program& program = expansion_->program();
  return program.steps.size() + program.lane_a.size() + program.variables;
}

/// rescale scales the derivatives to the size of the state, which decides the steps.
void TangentMotion::rescale() {
  const int wanted = std::ilogb(std::max(least_size(scale_), largest_of(std::span(y_).first(size_))));
  for (std::size_t d = 0; d < directions_; ++d) {
    const std::span<double> u = std::span(y_).subspan((1 + d) * size_, size_);
    const double size = largest_of(u);
    if (!(size > 0)) continue;
    const int by = wanted - std::ilogb(size);
    if (by == 0) continue;
    for (double& component : u) component = std::ldexp(component, by);
    exponents_[d] -= by;
  }
}

double TangentMotion::step() {
  expansion_->move(y_.data(), t_);
  return expansion_->step();
}

bool TangentMotion::look(double ahead) {
  expansion_->move(y_.data(), t_);  // a copy may have used the series meanwhile
  seen_ = y_;
  std::ranges::fill(low_, 0.0);
  expansion_->evaluate(ahead, low_.data(), seen_.data());
  return std::ranges::all_of(seen_, [](double component) { return std::isfinite(component); });
}

bool TangentMotion::move(double t) {
  if (!expansion_->defined(seen_.data(), t)) return false;
  y_ = seen_;
  t_ = t;
  rescale();
  seen_ = y_;  // exponents_ belong to seen_
  return true;
}

double TangentMotion::growth() const {
  double most = 0;
  for (std::size_t d = 0; d < directions_; ++d)
    most = std::max(most, std::ldexp(largest_of(std::span(seen_).subspan((1 + d) * size_, size_)), exponents_[d]));
  return most * scale_;
}

double TangentMotion::derivative(std::size_t component, std::size_t direction) const {
  return std::ldexp(seen_[(1 + direction) * size_ + component], exponents_[direction]);
}

}  // namespace least

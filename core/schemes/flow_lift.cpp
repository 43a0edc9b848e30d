#include "core/schemes/flow_lift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace least {
namespace {

using text::FlowParts;

/// φ₁(z) = (eᶻ − 1)/z, with its derivative.
double relative_growth(double z) { return phi1(z); }
Slope relative_growth(const Slope& z) {
  const double one = phi1(z.value);
  // φ₁′ = (eᶻ − φ₁)/z, and its series where that cancels
  const double x = z.value;
  const double slope =
      std::abs(x) < 0.1
          ? 1.0 / 2 +
                x * (1.0 / 3 +
                     x * (1.0 / 8 +
                          x * (1.0 / 30 + x * (1.0 / 144 + x * (1.0 / 840 + x * (1.0 / 5760 + x * (1.0 / 45360)))))))
          : (std::exp(x) - one) / x;
  return {one, {slope * z.slope[0]}};
}

}  // namespace

template <class T>
std::string FlowLift<T>::objection(const FlowParts& flow, const LiftedSplitting& scheme) {
  if (scheme.lift == LiftMethod::automatic) return {};
  if (!flow.lift)
    return fmt::format(
        "of more variables than the {} that are solved for at once only the lift automatic goes on, part by part",
        text::Lift::most_coordinates);
  if (scheme.lift == LiftMethod::exact && !flow.linear())
    return "the lift exact needs equations that are linear with constant coefficients";
  return {};
}

template <class T>
FlowLift<T>::FlowLift(std::shared_ptr<const FlowParts> flow, const LiftedSplitting& scheme)
    : flow_(std::move(flow)),
      composition_(scheme.composition),
      weights_(&Weights<double>::of(composition_)),
      whole_(scheme.lift != LiftMethod::automatic || flow_->linear()),
      map_(whole_ ? flow_->lift : nullptr, composition_, scheme.lift),
      momenta_(flow_->variables),
      slope_(flow_->variables + 1),
      rates_(2 * flow_->variables),
      old_(flow_->variables),
      speed_(flow_->variables) {}

template <class T>
void FlowLift<T>::begin(const T* x, double t) {
  work_ = {};
  looks_ = 0;
  if (whole_) map_.begin(x, t, slope_.data());
}

template <class T>
StepStatus FlowLift<T>::step(T* x, double t, double h) noexcept {
  if (whole_) {
    std::ranges::fill(momenta_, T(0));
    const StepStatus status = map_.step({x, momenta_.data(), nullptr, slope_.data()}, t, h);
    work_ = map_.work();
    return status;
  }
  const auto& parts = flow_->parts;
  const std::size_t last = parts.size() - 1;
  // Two halves of an exact part, one after the other, are one motion where the time changes nothing.
  const bool joins = flow_->autonomous && parts.front().affine && last > 0;
  double before = 0;
  StepStatus status = StepStatus::ok;
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages) && status == StepStatus::ok; ++i) {
    const double length = h * weights_->gamma[i], middle = t + h * weights_->middle[i];
    const auto go = [&](std::size_t k, double part) {
      if (status == StepStatus::ok) status = move(parts[k], x, middle, part);
    };
    const bool holds = joins && i + 1 < static_cast<std::size_t>(weights_->stages);
    if (last > 0) go(0, 0.5 * (before + length));
    for (std::size_t k = 1; k < last; ++k) go(k, 0.5 * length);
    go(last, length);
    for (std::size_t k = last; k-- > 1;) go(k, 0.5 * length);
    if (last > 0 && !holds) go(0, 0.5 * length);
    before = holds ? length : 0;
  }
  work_.forces = (looks_ + static_cast<std::int64_t>(last)) / static_cast<std::int64_t>(parts.size());
  return status;
}

template <class T>
void FlowLift<T>::look(const FlowParts::Part& part, const T* x, double t) noexcept {
  part.rates.evaluate(x, t, rates_.data());
  ++looks_;
}

template <class T>
StepStatus FlowLift<T>::move(const FlowParts::Part& part, T* x, double t, double h) noexcept {
  if (!part.affine) return by_midpoint(part, x, t, h);
  look(part, x, t);
  const std::size_t m = part.of.size();
  for (std::size_t i = 0; i < m; ++i) {
    T& own = x[part.of[i]];
    own = own + h * (relative_growth(h * rates_[m + i]) * rates_[i]);
  }
  return StepStatus::ok;
}

/// k = X(x + h k/2), x += h k, by Newton's method; each variable has its own equation. One round more than the numbers
/// need brings their slopes to round-off as well.
template <class T>
StepStatus FlowLift<T>::by_midpoint(const FlowParts::Part& part, T* x, double t, double h) noexcept {
  constexpr int most_rounds = 30;
  constexpr double small = 8 * std::numeric_limits<double>::epsilon();
  const std::size_t m = part.of.size();
  look(part, x, t);
  for (std::size_t i = 0; i < m; ++i) {
    old_[i] = x[part.of[i]];
    speed_[i] = rates_[i];
  }
  double before = std::numeric_limits<double>::infinity();
  bool found = false;
  for (int round = 0;; ++round) {
    if (round == most_rounds) return StepStatus::solver_failed;
    for (std::size_t i = 0; i < m; ++i) x[part.of[i]] = old_[i] + (0.5 * h) * speed_[i];
    look(part, x, t);
    ++work_.iterations;
    double most = 0;
    for (std::size_t i = 0; i < m; ++i) {
      const T change = (rates_[i] - speed_[i]) / (1.0 - (0.5 * h) * rates_[m + i]);
      speed_[i] = speed_[i] + change;
      const double moved = std::abs(h * plain_number(change)),
                   size = std::abs(plain_number(old_[i])) + std::abs(h * plain_number(speed_[i]));
      if (!(moved < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      if (moved > 0) most = std::max(most, moved / size);
    }
    if (found) break;
    found = most <= small || (most >= 0.5 * before && most <= 1e3 * small);
    if (found && std::is_same_v<T, double>) break;
    before = most;
  }
  for (std::size_t i = 0; i < m; ++i) x[part.of[i]] = old_[i] + h * speed_[i];
  return StepStatus::ok;
}

template class FlowLift<double>;
template class FlowLift<Slope>;

}  // namespace least

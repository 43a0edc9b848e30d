// The *error* of a state, as the contract defines it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace least {

struct ProblemCard;

/// What differences are divided by: max(1, the largest component of the true state), or each component by its own
/// largest size along the true motion, which is for states far below 1 and for components in different units.
enum class Norm : std::uint8_t { absolute, relative };

/// The largest component-wise difference from the true state of the first `size` components. `sizes`: what each
/// component is divided by in the relative norm, of ComponentSizes; empty: the absolute norm. Not finite where a
/// component is not.
template <class A, class B>
double state_error(const A& x, const B& truth, std::size_t size, std::span<const double> sizes = {}) {
  double difference = 0, most = 1;
  for (std::size_t i = 0; i < size; ++i) {
    double here = std::abs(x[i] - truth[i]);
    if (sizes.empty())
      most = std::max(most, std::abs(truth[i]));
    else if (here > 0)
      here /= sizes[i];
    if (!(here <= difference) && !std::isnan(difference)) difference = here;  // NaN comes in and stays
  }
  return difference == 0 ? 0 : difference / most;
}
template <class X>
double state_error(const X& x, const X& truth, std::span<const double> sizes = {}) {
  return state_error(x, truth, X::size, sizes);
}

/// For each variable of a problem the first one of its kind, by their names: places (x, y, z; x1, y1, x2; x[1]) are one
/// kind, and so are their momenta and their velocities; other variables are where only an index tells them apart.
std::vector<std::size_t> kinds_of(const ProblemCard& card);

/// How large components become along a motion, those of a kind together. So a component that stays at 0 beside others
/// of its kind is held against theirs.
class ComponentSizes {
 public:
  /// For the first `count` variables.
  ComponentSizes(std::span<const std::size_t> kinds, std::size_t count)
      : kinds_(kinds.begin(), kinds.begin() + static_cast<std::ptrdiff_t>(count)), largest_(count, 0) {}

  template <class X>
  void see(const X& x) {
    for (std::size_t i = 0; i < kinds_.size(); ++i) see(i, x[i]);
  }
  void see(std::size_t component, double x) {
    double& largest = largest_[kinds_[component]];
    if (std::abs(x) > largest && std::isfinite(x)) largest = std::abs(x);
  }
  /// The largest of the component's kind; 0: none has ever left 0.
  double largest(std::size_t component) const { return largest_[kinds_[component]]; }
  std::size_t count() const { return kinds_.size(); }
  /// Another size for the component's kind.
  void set(std::size_t component, double size) { largest_[kinds_[component]] = size; }
  std::size_t kind(std::size_t component) const { return kinds_[component]; }

  /// What state_error divides by. A kind that never leaves 0 has no size of its own: its differences are left as they
  /// are, as in the absolute norm.
  std::vector<double> divisors() const {
    std::vector<double> all;
    for (const std::size_t kind : kinds_) all.push_back(largest_[kind] > 0 ? largest_[kind] : 1);
    return all;
  }

 private:
  std::vector<std::size_t> kinds_;
  std::vector<double> largest_;  ///< by kind, at the first of each
};

}  // namespace least

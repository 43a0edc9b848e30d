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

/// Norm says what differences of states are divided by. `absolute`: max(1, the largest component of the true state).
/// `relative`: each component by its own largest size along the true motion, for states far below 1 and for components
/// in different units.
enum class Norm : std::uint8_t { absolute, relative };

/// state_error returns the largest difference of the first `size` components of x from the true state, divided as Norm
/// says. `sizes` are the divisors of the relative norm (ComponentSizes::divisors), empty for the absolute norm. Not
/// finite where a component of x is not.
template <class A, class B>
double state_error(const A& x, const B& truth, std::size_t size, std::span<const double> sizes = {}) {
  double difference = 0, most = 1;
  for (std::size_t i = 0; i < size; ++i) {
    double here = std::abs(x[i] - truth[i]);
    if (sizes.empty())
      most = std::max(most, std::abs(truth[i]));
    else if (here > 0)
      here /= sizes[i];
    if (!(here <= difference) && !std::isnan(difference)) difference = here;  // NaN stays
  }
  return difference == 0 ? 0 : difference / most;
}
template <class X>
double state_error(const X& x, const X& truth, std::span<const double> sizes = {}) {
  return state_error(x, truth, X::size, sizes);
}

/// kinds_of returns for each variable of a problem the index of the first variable of the same kind. Kinds go by names:
/// places (x, y, z; x1, y1, x2; x[1]) are one kind, and so are their momenta and their velocities; other variables are
/// of one kind if their names differ only in an index.
std::vector<std::size_t> kinds_of(const ProblemCard& card);

/// ComponentSizes records how large components become along a motion, with one size for all components of a kind. So
/// the error of a component that stays at 0 is relative to the size of others of its kind.
class ComponentSizes {
 public:
  /// For the first `count` variables; `kinds` is the result of kinds_of.
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
  /// The largest size of the component's kind; 0 if it has always been 0.
  double largest(std::size_t component) const { return largest_[kinds_[component]]; }
  std::size_t count() const { return kinds_.size(); }
  /// Replaces the size of the component's kind.
  void set(std::size_t component, double size) { largest_[kinds_[component]] = size; }
  std::size_t kind(std::size_t component) const { return kinds_[component]; }

  /// The divisors for state_error. A kind that has always been 0 has no size of its own: its divisor is 1, so its
  /// differences are absolute.
  std::vector<double> divisors() const {
    std::vector<double> all;
    for (const std::size_t kind : kinds_) all.push_back(largest_[kind] > 0 ? largest_[kind] : 1);
    return all;
  }

 private:
  std::vector<std::size_t> kinds_;
  std::vector<double> largest_;  ///< size of a kind, at the index of its first component
};

}  // namespace least

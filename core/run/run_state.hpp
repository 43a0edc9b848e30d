// The state of a run of any problem, as numbers whose count is known only at run time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "core/problem_traits.hpp"

namespace least {

/// StateNumbers are the numbers of one state. Up to twenty of them, enough for eight degrees of freedom, are stored in
/// place, without an allocation.
class StateNumbers {
 public:
  StateNumbers() = default;
  explicit StateNumbers(std::size_t count, double value = 0) {
    resize(count);
    std::fill(begin(), end(), value);
  }
  StateNumbers(const double* first, const double* last) { assign(first, last); }
  StateNumbers(const StateNumbers& other) { copy(other); }
  StateNumbers(StateNumbers&& other) noexcept { take(other); }
  StateNumbers& operator=(const StateNumbers& other) {
    if (this != &other) copy(other);
    return *this;
  }
  StateNumbers& operator=(StateNumbers&& other) noexcept {
    if (this != &other) take(other);
    return *this;
  }
  ~StateNumbers() = default;

  std::size_t size() const { return count_; }
  double* data() { return count_ > in_place ? elsewhere_.data() : here_.data(); }
  const double* data() const { return count_ > in_place ? elsewhere_.data() : here_.data(); }
  double* begin() { return data(); }
  double* end() { return data() + count_; }
  const double* begin() const { return data(); }
  const double* end() const { return data() + count_; }
  double& operator[](std::size_t i) { return data()[i]; }
  double operator[](std::size_t i) const { return data()[i]; }

  /// The values are unspecified afterwards.
  void resize(std::size_t count) {
    if (count > in_place) elsewhere_.resize(count);
    count_ = count;
  }
  [[gnu::noinline]] void assign(const double* first, const double* last) {
    resize(static_cast<std::size_t>(last - first));
    std::copy(first, last, begin());
  }

 private:
  static constexpr std::size_t in_place = 20, few = 8;

  /// Steps copy states: up to `few` numbers are copied as a block of fixed size, without a loop or a call.
  void copy(const StateNumbers& other) {
    if (other.count_ > few) return assign(other.begin(), other.end());
    count_ = other.count_;
    std::memcpy(here_.data(), other.here_.data(), few * sizeof(double));
  }

  [[gnu::noinline]] void take(StateNumbers& other) noexcept {
    count_ = other.count_;
    if (count_ > in_place)
      elsewhere_ = std::move(other.elsewhere_);
    else
      std::copy_n(other.here_.data(), count_, here_.data());
  }

  std::size_t count_ = 0;
  std::array<double, in_place> here_;
  std::vector<double> elsewhere_;  ///< all numbers, if there are more than in_place
};

/// largest_of returns the largest absolute value of the numbers, NaN if one of them is NaN, and 0 of none.
inline double largest_of(std::span<const double> numbers) {
  double largest = 0;
  for (const double x : numbers)
    if (std::abs(x) > largest || std::isnan(x)) largest = std::abs(x);
  return largest;
}

/// StateView refers to a state stored elsewhere: the time and the components in order, followed by the components of a
/// tangent direction if the run carries one.
struct StateView {
  double t;
  const double* numbers;

  double operator[](std::size_t i) const { return numbers[i]; }
};

/// StateRows are rows of states after steps, each of `width` numbers: the time, then the numbers of the state.
struct StateRows {
  const double* first;
  std::size_t width, count;

  StateView operator[](std::size_t i) const { return {first[i * width], first + i * width + 1}; }
  /// At most `most` rows from row i on.
  StateRows part(std::size_t i, std::size_t most) const {
    return {first + i * width, width, std::min(most, count - i)};
  }
};

/// RunState is a state that owns its numbers.
struct RunState {
  using Number = double;

  double t = 0;
  StateNumbers numbers;

  operator StateView() const { return {t, numbers.data()}; }  // NOLINT(google-explicit-constructor): a view of it
  double& operator[](std::size_t i) { return numbers[i]; }
  double operator[](std::size_t i) const { return numbers[i]; }
  std::size_t size() const { return numbers.size(); }
};

template <class X>
inline constexpr std::size_t numbers_in = Sloped<X> ? 2 * X::size : X::size;

/// state_from converts to the state type X of a problem.
template <class X>
X state_from(StateView view) {
  X x;
  x.t = view.t;
  for (std::size_t i = 0; i < X::size; ++i) {
    if constexpr (Sloped<X>) {
      x[i] = {view[i], {view[X::size + i]}};
    } else {
      x[i] = view[i];
    }
  }
  return x;
}
template <class X>
X state_from(const RunState& x) {
  if constexpr (std::is_same_v<X, RunState>) return x;
  if constexpr (!std::is_same_v<X, RunState>) return state_from<X>(StateView(x));
}
template <class X>
void write_numbers(const X& x, double* numbers) {
  for (std::size_t i = 0; i < X::size; ++i) {
    numbers[i] = value_of(x[i]);
    if constexpr (Sloped<X>) numbers[X::size + i] = x[i].slope[0];
  }
}
template <class X>
void assign_numbers(const X& x, RunState& state) {
  state.t = x.t;
  state.numbers.resize(numbers_in<X>);
  write_numbers(x, state.numbers.data());
}
inline void assign_numbers(const RunState& x, RunState& state) { state = x; }
inline RunState run_state(const RunState& x) { return x; }
template <class X>
RunState run_state(const X& x) {
  RunState state;
  assign_numbers(x, state);
  return state;
}

}  // namespace least

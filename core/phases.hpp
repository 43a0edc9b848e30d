// Phases of a problem that repeats in time, tabulated over one period where a whole number of steps makes one.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "core/scene.hpp"

namespace least {

template <class P>
concept Periodic = HasPhases<P> && requires(const P& m) {
  { m.period() } -> std::convertible_to<double>;
};

/// phase(m, t) at the given nodes (fractions of the step) of one step after the other. What is asked for out of turn,
/// or with another step, is computed. A value; copies share the table.
template <class P, class S>
class PhaseClock {
 public:
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));

  PhaseClock() = default;
  PhaseClock(const P& problem, const S& start, double step, std::span<const S> nodes) {
    if constexpr (Periodic<P> && std::is_same_v<S, double>) {
      const double period = problem.period(), steps = std::round(period / step);
      constexpr double most = 4096, slack = 8 * std::numeric_limits<double>::epsilon();
      if (!(steps >= 1 && steps * static_cast<double>(nodes.size()) <= most)) return;
      if (!(std::abs(steps * step - period) <= slack * period)) return;
      auto table = std::make_shared<std::vector<F>>();
      for (double n = 0; n < steps; ++n)
        for (const S& node : nodes) table->push_back(phase(problem, start + (n + node) * step));
      table_ = std::move(table);
      step_ = step;
      expected_ = start;
      width_ = nodes.size();
    }
  }

  /// To be called at the start of a step: whether the table holds its phases.
  bool begin(const S& t, const S& h) noexcept {
    if constexpr (Periodic<P> && std::is_same_v<S, double>) {
      tabled_ = table_ && h == step_ && std::abs(t - expected_) <= 1e-9 * h;
      if (tabled_) {
        row_ = next_;
        next_ = row_ + width_ == table_->size() ? 0 : row_ + width_;
        expected_ = t + h;
      }
    }
    return tabled_;
  }
  /// Whether this step's phases come from the table, and where in it the i-th node's is.
  bool tabulated() const noexcept { return tabled_; }
  std::size_t place(std::size_t i) const noexcept { return row_ + i; }
  /// What follows from each phase of the table and its node, as a table alike; null where there is none.
  template <class G>
  auto tabulate(G&& g) const {
    using Value = decltype(g(std::declval<const F&>(), std::size_t{}));
    std::shared_ptr<std::vector<Value>> values;
    if (!table_) return values;
    values = std::make_shared<std::vector<Value>>();
    for (std::size_t k = 0; k < table_->size(); ++k) values->push_back(g((*table_)[k], k % width_));
    return values;
  }
  /// The i-th node's phase of this step, at the time t.
  F at(const P& problem, std::size_t i, const S& t) const noexcept {
    if constexpr (Periodic<P> && std::is_same_v<S, double>)
      if (tabled_) return (*table_)[row_ + i];
    return phase(problem, t);
  }

 private:
  std::shared_ptr<const std::vector<F>> table_;
  double step_ = 0;
  S expected_{};
  std::size_t width_ = 1, row_ = 0, next_ = 0;
  bool tabled_ = false;
};
/// A problem without phases needs no clock.
template <class P, class S>
requires(!Periodic<P>) class PhaseClock<P, S> {
 public:
  PhaseClock() = default;
  PhaseClock(const P&, const S&, double, std::span<const S>) {}
  bool begin(const S&, const S&) noexcept { return false; }
  auto at(const P& problem, std::size_t, const S& t) const noexcept { return phase(problem, t); }
};

}  // namespace least

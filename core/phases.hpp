// A clock for problems that repeat in time: what a step needs of its times, tabulated over one period where a whole
// number of steps makes one.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/scene.hpp"

namespace least {

template <class P>
concept Periodic = HasPhases<P> && requires(const P& m) {
  { m.period() } -> std::convertible_to<double>;
};

/// Entries (a phase, or a phase and what follows from it) at the given nodes (fractions of the step) of one step after
/// the other. What is asked for out of turn, or with another step, is made. A value; copies share the table.
template <class Entry, class P, class S>
class PhaseClock {
 public:
  /// make(i, t) → the entry of the i-th node at the time t, for a step of the length `step`.
  template <class Make>
  PhaseClock(const P& problem, const S& start, double step, std::span<const S> nodes, Make&& make) {
    if constexpr (tabulates) {
      const double period = problem.period(), steps = std::round(period / step);
      constexpr double most = 4096, slack = 8 * std::numeric_limits<double>::epsilon();
      if (!(steps >= 1 && steps * static_cast<double>(nodes.size()) <= most)) return;
      if (!(std::abs(steps * step - period) <= slack * period)) return;
      auto table = std::make_shared<std::vector<Entry>>();
      for (double n = 0; n < steps; ++n)
        for (std::size_t i = 0; i < nodes.size(); ++i) table->push_back(make(i, start + (n + nodes[i]) * step));
      table_ = std::move(table);
      step_ = step;
      expected_ = start;
      width_ = nodes.size();
    }
  }

  /// To be called at the start of a step.
  void begin(const S& t, const S& h) noexcept {
    if constexpr (tabulates) {
      tabled_ = table_ && h == step_ && std::abs(t - expected_) <= 1e-9 * h;
      if (tabled_) {
        row_ = next_;
        next_ = row_ + width_ == table_->size() ? 0 : row_ + width_;
        expected_ = t + h;
      }
    }
  }
  /// The i-th node's entry of this step: the table's, else make().
  template <class Make>
  Entry at(std::size_t i, Make&& make) const {
    if constexpr (tabulates)
      if (tabled_) return (*table_)[row_ + i];
    return make();
  }

 private:
  static constexpr bool tabulates = std::is_same_v<S, double>;

  std::shared_ptr<const std::vector<Entry>> table_;
  double step_ = 0;
  S expected_{};
  std::size_t width_ = 1, row_ = 0, next_ = 0;
  bool tabled_ = false;
};
/// A problem that does not repeat needs no table.
template <class Entry, class P, class S>
requires(!Periodic<P>) class PhaseClock<Entry, P, S> {
 public:
  template <class Make>
  PhaseClock(const P&, const S&, double, std::span<const S>, Make&&) {}
  void begin(const S&, const S&) noexcept {}
  template <class Make>
  Entry at(std::size_t, Make&& make) const {
    return make();
  }
};

}  // namespace least

// A clock for problems that are periodic in time: it tabulates what a step needs to know of its times over one period,
// where a whole number of steps makes up a period.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/problem_traits.hpp"

namespace least {

template <class P>
concept Periodic = HasPhases<P> && requires(const P& m) {
  m.period();
};
/// PeriodicInLanes holds where each lane of the parameters has a period of its own.
template <class P>
concept PeriodicInLanes = Periodic<P> && !requires(const P& m) {
  { m.period() } -> std::convertible_to<double>;
};

namespace phases {
inline constexpr double most_entries = 4096;
inline constexpr double slack =
    8 * std::numeric_limits<double>::epsilon();  ///< relative, of a period made up of whole steps
}  // namespace phases

/// PhaseClock gives the entries (a phase, or a phase and values derived from it) at the nodes of one step after the
/// other; nodes are fractions of a step. Entries for a step out of sequence, or of another length, are computed instead
/// of read from the table. Copies share the table.
template <class Entry, class P, class S>
class PhaseClock {
 public:
  /// make(i, t) returns the entry of node i at the time t, for a step of the length `step`.
  template <class Make>
  PhaseClock(const P& problem, const S& start, double step, std::span<const S> nodes, Make&& make) {
    if constexpr (tabulates) {
      const double period = problem.period(), steps = std::round(period / step);
      if (!(steps >= 1 && steps * static_cast<double>(nodes.size()) <= phases::most_entries)) return;
      if (!(std::abs(steps * step - period) <= phases::slack * period)) return;
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
  /// at returns the entry of node i of this step: from the table, or else make(t), where t is the time of the node.
  template <class Make>
  Entry at(std::size_t i, const S& t, Make&& make) const {
    if constexpr (tabulates)
      if (tabled_) return (*table_)[row_ + i];
    return make(t);
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
  Entry at(std::size_t, const S& t, Make&& make) const {
    return make(t);
  }
};

/// For lanes with different periods nothing is tabulated. A lane whose scene alone would have a table computes its
/// entries at the times of that table, so that it has the bits of a lone run.
template <class Entry, PeriodicInLanes P, class S>
requires std::is_same_v<S, double>
class PhaseClock<Entry, P, S> {
 public:
  template <class Make>
  PhaseClock(const P& problem, double start, double step, std::span<const double> nodes, Make&&)
      : start_(start), step_(step), expected_(start), nodes_(nodes) {
    using least::abs;
    using least::floor;
    const R period = problem.period();
    steps_ = floor(period / step + 0.5);
    tables_ = (steps_ >= R(1)) & (steps_ * static_cast<double>(nodes.size()) <= R(phases::most_entries)) &
              (abs(steps_ * step - period) <= phases::slack * period);
  }

  void begin(double t, double h) noexcept {
    using least::select;
    in_turn_ = h == step_ && std::abs(t - expected_) <= 1e-9 * h;
    if (!in_turn_) return;
    row_ = next_;
    next_ = select(row_ + 1 < steps_, R(row_ + 1), R(0));
    expected_ = t + h;
  }
  template <class Make>
  Entry at(std::size_t i, double t, Make&& make) const {
    using least::select;
    if (!in_turn_) return make(t);
    return make(select(tables_, R(start_ + (row_ + nodes_[i]) * step_), R(t)));
  }

 private:
  using R = std::remove_cvref_t<decltype(std::declval<const P&>().period())>;

  double start_, step_, expected_;
  std::span<const double> nodes_;
  R steps_{}, row_{0}, next_{0};
  std::remove_cvref_t<decltype(R{} < R{})> tables_{};
  bool in_turn_ = false;
};

}  // namespace least

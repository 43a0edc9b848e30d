#include "core/reference/true_motion.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <system_error>
#include <utility>

#include "core/tape/wide.hpp"

namespace least {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

constexpr std::size_t long_equations = 256;  ///< operations, beyond which keep_going() is asked within a step, too
constexpr double first_step = 0.1;           ///< longest first step; each later step is at most twice the one before

std::size_t nth(Index i) { return static_cast<std::size_t>(i); }

/// Returns the other one of the pairs sin, cos and sinh, cosh; Op::constant for all other operations.
Op partner_of(Op op) {
  switch (op) {
    case Op::sin:
      return Op::cos;
    case Op::cos:
      return Op::sin;
    case Op::sinh:
      return Op::cosh;
    case Op::cosh:
      return Op::sinh;
    default:
      return Op::constant;
  }
}

/// x times `by`, a power of two.
DoubleDouble scaled(double by, const DoubleDouble& x) { return {by * x.high(), by * x.low()}; }

DoubleDouble inverse_of(std::size_t k) { return DoubleDouble(1) / DoubleDouble(static_cast<double>(k)); }

}  // namespace

bool TrueMotion::covers(const tape::Tape& tape) {
  for (Index i = 0; i < tape.size(); ++i)
    if (tape[i].op == Op::raise || tape[i].op == Op::total) return false;
  return true;
}

TrueMotion::TrueMotion(tape::Tape equations, std::span<const Index> rates, double tolerance)
    : tape_(std::move(equations)),
      rates_(rates.begin(), rates.end()),
      tolerance_(tolerance),
      order_(static_cast<std::size_t>(std::ceil(-0.5 * std::log(tolerance))) + 1) {  // Jorba & Zou, 3.2
  steep_ = tape::steep_arguments(tape_, rates_);
  for (std::size_t i = 0; i < rates.size(); ++i)
    variables_.push_back(tape_.write({.op = Op::variable, .value = static_cast<double>(i)}));
  for (Index i = 0; i < tape_.size(); ++i)
    if (const Op other = partner_of(tape_[i].op); other != Op::constant) {
      const Index a = tape_[i].a;
      tape_.write({.op = other, .a = a});
    }
  rows_of_.assign(nth(tape_.size()), {});
  Index rows = tape_.size();
  const auto weigh = [&](Index node) {
    if (rows_of_[nth(node)].weighted == tape::none) rows_of_[nth(node)].weighted = rows++;
  };
  for (Index i = 0; i < tape_.size(); ++i) {
    const Node& node = tape_[i];
    Rows& own = rows_of_[nth(i)];
    switch (node.op) {
      case Op::power:
        weigh(i);
        weigh(node.a);
        break;
      case Op::log:
        weigh(i);
        break;
      case Op::atan:
        weigh(i);
        own.helper = rows++;
        break;
      case Op::asin:
      case Op::acos:
        weigh(i);
        own.helper = rows;
        rows += 2;
        break;
      case Op::exp:
        weigh(node.a);
        break;
      case Op::tan:
      case Op::tanh:
        weigh(node.a);
        own.helper = rows++;
        break;
      case Op::sin:
      case Op::cos:
      case Op::sinh:
      case Op::cosh:
        weigh(node.a);
        own.helper = tape_.write({.op = partner_of(node.op), .a = node.a});
        break;
      default:
        break;
    }
    if (node.op == Op::divide && tape_[node.b].linear) poles_.push_back(node.b);
    if (node.op == Op::power && tape_[node.a].linear) poles_.push_back(node.a);
    if (node.op == Op::sqrt && tape_[node.a].linear) poles_.push_back(node.a);
  }
  for (Index i = 0; i < tape_.size(); ++i) {
    const Op op = tape_[i].op;
    if (op == Op::time) time_ = i;
    if (op == Op::variable || op == Op::time) {
      if (const Index slope = rows_of_[nth(i)].weighted; slope != tape::none) given_.emplace_back(i, slope);
    } else if (op != Op::constant) {
      made_.push_back(i);
    }
  }
  choice_of_.resize(nth(tape_.size()));
  for (Index i = 0; i < tape_.size(); ++i)
    if (tape_[i].op == Op::select) {
      const auto known = std::ranges::find(choices_, tape_[i].a, &Choice::by);
      choice_of_[nth(i)] = static_cast<std::size_t>(known - choices_.begin());
      if (known == choices_.end()) choices_.push_back({.by = tape_[i].a});
    }
  reciprocals_.resize(nth(tape_.size()));
  for (std::size_t k = 0; k <= order_; ++k) inverses_.push_back(k > 0 ? inverse_of(k) : DoubleDouble(0));
  held_ = HeldByThread::take(sizeof(DoubleDouble) * nth(rows) * (order_ + 1));
  rows_.assign(nth(rows) * (order_ + 1), DoubleDouble());
  for (Index i = 0; i < tape_.size(); ++i)
    if (tape_[i].op == Op::constant) *row(i) = {tape_[i].value, tape_[i].low};
}

void TrueMotion::start(std::vector<DoubleDouble> x, double t) {
  x_ = std::move(x);
  t_ = t;
  start_ = t;
  short_ = 0;
  length_ = 0;
  begun_ = false;
  longest_ = first_step;
  lost_ = stuck_ = false;
  chooses_ = true;
  double size = 0;
  for (const auto& component : x_) size = std::max(size, std::abs(component.high()));
  least_size_ = size > 0 && size < 1 ? size : 1;
}

/// Computes all orders at the state x_. Returns false if keep_going() does.
LEAST_FUSED bool TrueMotion::expand(const std::function<bool()>& keep_going) {
  const bool looks = made_.size() > long_equations;
  if (!begun_) begin_at(x_, false);
  for (std::size_t v = 0; v < variables_.size(); ++v) row(variables_[v])[0] = x_[v];
  begun_ = true;
  chooses_ = false;
  if (time_ != tape::none) row(time_)[1] = unit_;
  for (std::size_t k = 0; k < order_; ++k) {
    if (looks && !keep_going()) return false;
    if (k > 0)
      for (const Index i : made_) extend(i, k);
    for (std::size_t v = 0; v < variables_.size(); ++v)
      row(variables_[v])[k + 1] = scaled(unit_, row(rates_[v])[k] * inverses_[k + 1]);
    for (const auto& [i, slope] : given_) row(slope)[k + 1] = static_cast<double>(k + 1) * row(i)[k + 1];
  }
  return true;
}

double TrueMotion::largest(std::size_t k) const {
  double most = 0;
  for (const Index variable : variables_) {
    const double size = std::abs(row(variable)[k].high());
    if (!(size <= most)) most = size;  // NaN comes in and stays
    if (std::isnan(size)) return size;
  }
  return most;
}

/// Returns the order up to which the coefficients of all variables are finite.
std::size_t TrueMotion::finite_orders() const {
  std::size_t order = 0;
  while (order < order_ && std::isfinite(largest(order + 1))) ++order;
  return order;
}

/// Returns how long a step may be, in units, by the first `used` orders, as the scheme `taylor` does
/// (core/schemes/taylor_length.cpp).
double TrueMotion::length(std::size_t used) const {
  constexpr double kept = 1.0 / 16, slack = 10;
  constexpr std::size_t looked_at = 8;
  const double scale = std::max(least_size_, largest(0)), allowed = std::log(kept * scale) + std::log(tolerance_);
  double log_h = std::log(longest_ / unit_);
  for (std::size_t k = used; k > 0 && k + 2 > used; --k)
    if (const double size = largest(k); size > 0)
      log_h = std::min(log_h, (allowed - std::log(size)) / static_cast<double>(k));
  const double root = std::exp(std::log(tolerance_) / static_cast<double>(used));
  double h = std::exp(log_h);
  // Where the last two orders happen to vanish, the ones before them decide: cₖ ≤ rᵏ has to hold.
  const double log_r = std::log(root / h);
  for (std::size_t k = used; k > 0 && k + looked_at > used; --k)
    if (const double size = largest(k);
        size > 0 && std::log(size) > std::log(slack * kept * scale) + static_cast<double>(k) * log_r)
      h = std::min(h, root * std::pow(kept * scale / size, 1.0 / static_cast<double>(k)));
  return until_pole(h, used);
}

/// Computes the series at the state, in a suitable unit of time. Returns false where there is none, or if keep_going()
/// does.
bool TrueMotion::settle(const std::function<bool()>& keep_going) {
  constexpr int most_tries = 60;
  bool bounded = steep_.empty();
  for (Choice& choice : choices_) choice.turns = 0;
  for (int i = 0; i < most_tries; ++i) {
    length_ = 0;
    if (!keep_going() || !expand(keep_going)) return false;
    const std::size_t used = finite_orders();
    if (used < order_ && !bounded) {
      begin_at(x_, bounded = true);
      continue;
    }
    if (used == 0) {  // the first rates are too large for the unit, or NaN
      if (!std::isfinite(largest(1)) && unit_ < 1e-250) break;
      unit_ *= 0x1p-10;
      continue;
    }
    length_ = length(used);
    const int off = length_ > 0 ? std::ilogb(length_) : 0;
    if (std::abs(off) > 3) {
      unit_ = std::ldexp(unit_, off);
    } else if (used == order_) {
      if (!take_sides()) return true;
      begun_ = false;
      if (stuck_) break;
    } else {
      break;
    }
  }
  length_ = 0;
  lost_ = !stuck_;
  return false;
}

/// Whether the polynomials solve the equations at the time h, in units, within the step: a series knows nothing of a
/// force that is switched on later. Leaves the state at that time in `ahead_`, and order 0 of the nodes there.
LEAST_FUSED bool TrueMotion::solves(double h) {
  constexpr double slack = 1e6;  // tolerances: a force that was missed is much larger
  const DoubleDouble t = t_;
  slopes_.clear();
  ahead_.clear();
  for (const Index variable : variables_) {
    const DoubleDouble* const c = row(variable);
    DoubleDouble value = c[order_], slope{};
    for (std::size_t k = order_; k-- > 0;) {
      slope = slope * h + value;
      value = value * h + c[k];
    }
    slopes_.push_back(slope);
    ahead_.push_back(value);
  }
  t_ = t_ + DoubleDouble(h * unit_);
  begin_at(ahead_, false);
  const double scale = std::max(least_size_, largest(0));
  bool good = true;
  for (std::size_t v = 0; v < variables_.size() && good; ++v) {
    const DoubleDouble rate = scaled(unit_, row(rates_[v])[0]);
    good = std::abs((rate - slopes_[v]).high()) * h <= slack * tolerance_ * std::max(scale, std::abs(rate.high()) * h);
  }
  for (std::size_t v = 0; v < variables_.size(); ++v) row(variables_[v])[0] = x_[v];
  t_ = t;
  return good;
}

/// Shortens the step until steep functions are resolved in it. Returns whether the argument of any of them moves.
bool TrueMotion::until_steep() {
  bool moves = false;
  for (const tape::SteepArgument& steep : steep_) {
    const DoubleDouble* const c = row(steep.argument);
    const auto value = [&](double time) {
      double sum = 0;
      for (std::size_t k = order_; k-- > 0;) sum = sum * time + c[k].high();
      return sum;
    };
    double change = 0;
    for (std::size_t k = order_ - 1; k > 0; --k) change = (change + std::abs(c[k].high())) * length_;
    if (steep.calm(c[0].high(), change)) continue;
    moves = true;
    tape::SteepLooks looks;
    for (std::size_t i = 0; i < looks.size(); ++i)
      looks[i] = value(length_ * static_cast<double>(i) / static_cast<double>(looks.size() - 1));
    length_ = tape::resolved_length(steep, length_, tape::most_of_series, looks, value);
  }
  return moves;
}

/// Shortens the step that the series allows until the polynomials solve the equations, and leaves order 0 at its end. A
/// step of the greatest length, in which hardly anything happens, and one in which arguments of steep functions move
/// are also checked on the way. Returns false, with no step, if keep_going() does.
bool TrueMotion::shorten(const std::function<bool()>& keep_going) {
  constexpr int parts = 8;
  const bool looks = made_.size() > long_equations;
  const bool steep = until_steep(), idle = steep || length_ * unit_ >= 0.99 * longest_;
  for (const Choice& choice : choices_) length_ = told_until(choice, length_);
  free_ = length_;
  until_change();
  for (int tries = 0; tries < 60; ++tries) {
    bool good = true;
    for (int part = idle ? 1 : parts; part <= parts && good; ++part) {
      if (looks && !keep_going()) {
        length_ = 0;
        return false;
      }
      good = solves(length_ * part / parts);
    }
    if (good) return true;
    free_ = length_ *= 0.5;
  }
  solves(length_);
  return true;
}

LEAST_FUSED DoubleDouble TrueMotion::within(Index variable, const DoubleDouble& h) const {
  const DoubleDouble* const c = row(variable);
  DoubleDouble sum = c[order_];
  for (std::size_t k = order_; k-- > 0;) sum = sum * h + c[k];
  return sum;
}

std::span<const DoubleDouble> TrueMotion::at(double t, const std::function<bool()>& keep_going) {
  constexpr double shortest = 1e-25;  // of steps, relative to the time
  // Where the motion ends, steps stay short: more than `patience` in a row below `tiny` times the time since the start.
  constexpr double tiny = 1e-9;
  constexpr int patience = 1000;
  if (t_ == DoubleDouble(t)) return x_;
  if (length_ == 0 && !(settle(keep_going) && shorten(keep_going))) return {};
  while ((DoubleDouble(t) - t_).high() > length_ * unit_) {
    x_ = ahead_;
    t_ = t_ + DoubleDouble(length_ * unit_);
    longest_ = 2 * free_ * unit_;
    if (!settle(keep_going) || !shorten(keep_going)) return {};
    short_ = length_ * unit_ < tiny * (t_.high() - start_) ? short_ + 1 : 0;
    if (short_ <= patience && free_ * unit_ > shortest * std::abs(t_.high())) continue;
    lost_ = !choices_.empty();  // another method may get across the change of a formula
    return {};
  }
  const DoubleDouble h = (DoubleDouble(t) - t_) / DoubleDouble(unit_);
  asked_.clear();
  for (const Index variable : variables_) asked_.push_back(within(variable, h));
  return asked_;
}

SideBySide side_by_side(TrueMotion& one, TrueMotion& other, std::span<const double> times,
                        const std::function<bool()>& keep_going) {
  using States = std::vector<DoubleDouble>;
  std::atomic<std::size_t> wanted{times.size()};  // times still wanted: less where one motion has ended
  const auto run = [&wanted, times](TrueMotion& motion, const std::function<bool()>& going) {
    States states;
    std::size_t done = 0;
    const std::function<bool()> on = [&] { return done < wanted && going(); };
    for (; done < wanted; ++done) {
      const auto x = motion.at(times[done], on);
      if (x.empty()) break;
      states.insert(states.end(), x.begin(), x.end());
    }
    for (std::size_t seen = wanted; done < seen && !wanted.compare_exchange_weak(seen, done);) {
    }
    return states;
  };
  // Each motion goes on to where the other one ended, so that the result does not depend on which thread is faster.
  const auto both = [&](States first, States second) -> SideBySide {
    const bool lost = (one.lost() && first.size() <= second.size()) || (other.lost() && second.size() <= first.size());
    if (lost) return {{}, true};
    return {{std::move(first), std::move(second)}};
  };
  bool going = true;
  const std::function<bool()> ask = [&] { return going = going && keep_going(); };
  std::future<States> promise;
  try {
    promise = std::async(std::launch::async, [&] { return run(other, [] { return true; }); });
  } catch (const std::system_error&) {  // no thread is available: one after the other
    States first = run(one, ask);
    return both(std::move(first), run(other, ask));
  }
  const struct Stop {
    std::atomic<std::size_t>& wanted;
    ~Stop() { wanted = 0; }
  } stop{wanted};  // also when something is thrown
  States first = run(one, ask);
  while (promise.wait_for(std::chrono::milliseconds(1)) == std::future_status::timeout)
    if (!ask()) wanted = 0;
  return both(std::move(first), promise.get());
}

}  // namespace least

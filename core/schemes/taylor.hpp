// taylor: the Taylor series of the motion itself, from the equations of motion that a problem states, recorded as a
// tape (core/tape). Of any order, so that a step is as long as the series converges well: a third of the way to the
// nearest singularity, in complex time, at twelve digits. Sets its own clock, reads the time, keeps no structure:
// energy drifts at a rate that the tolerance sets. What a state carries beyond the motion, an action or a tangent
// direction, has no say in the steps: asking for more never changes a run. Where its own series, as that of an action
// of twice the frequency, is not good for all of a step, it is begun anew on the way, beside that of the motion. A step
// costs one pass over the tape per order; by convention it counts as many force evaluations as its order. The state
// within a step is the polynomial itself. Sums over steps are compensated. Velocities of a Lagrangian that is not
// quadratic in them have series of their own within a step, and are found anew from the momenta where it begins. The
// tape is recorded when a run begins, by the problem with its parameters: choices, whole exponents and what is zero
// leave it shorter; that takes a few microseconds, so that a thread keeps what the last two of a problem have made of
// it, for the next with the same parameters. One engine runs all tapes, so that a problem costs its recording and
// nothing else to compile. Sources: Jorba & Zou, Experimental Mathematics 14, 99 (2005); Corliss & Chang, ACM Trans.
// Math. Softw. 8, 114 (1982); Biscani & Izzo, MNRAS 504, 2614 (2021).
#pragma once

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/scheme.hpp"
#include "core/schemes/expansion.hpp"
#include "core/tape/series.hpp"
#include "core/tape/steep.hpp"
#include "core/tape/symbol.hpp"

namespace least {

namespace taylor {

/// States that are doubles at heart: plain, or with a tangent direction.
template <class X>
concept Flat = std::is_same_v<typename X::Time, double> &&(std::is_same_v<typename X::Number, double> || Sloped<X>);
template <Flat X>
inline constexpr std::size_t components = Sloped<X> ? 2 * X::size : X::size;
/// As many with room for a whole four where three stand behind others: they are faster than two and one.
template <Flat X>
inline constexpr std::size_t with_room = components<X> % 4 == 3 ? components<X> + 1 : components<X>;

/// The i-th component: values, then slopes.
template <class X>
constexpr auto& component(X& x, std::size_t i) {
  if constexpr (requires { x[0].slope; }) {
    return i < X::size ? x[i].value : x[i - X::size].slope[0];
  } else {
    return x[i];
  }
}

/// The equations of motion of a problem, on states like X, written on a tape: the rates of its variables.
template <class X, VectorField P>
constexpr std::array<tape::Index, components<X>> write_equations(const P& problem, tape::Tape& tape) {
  std::array<tape::Index, components<X>> rates;
  using Number = std::conditional_t<Sloped<X>, Dual<Symbol, 1>, Symbol>;
  typename X::template in<Number, Symbol> x;
  for (std::size_t i = 0; i < components<X>; ++i) component(x, i) = Symbol::variable(tape, i);
  x.t = Symbol::time(tape);
  auto rate = derivative(problem, x);
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = component(rate, i).on(tape);
  return rates;
}
/// A state without tangent direction.
template <class X>
auto values_of(const X& x) {
  std::array<typename X::Number, X::size> y;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i];
  return y;
}
template <class X, VectorField P>
tape::Program record(const P& problem) {
  tape::Tape tape;
  const auto rates = write_equations<X>(problem, tape);
  return program_of(tape, rates, StateOf<P>::size);
}

template <class X, VectorField P>
std::shared_ptr<Expansion> expand(const P& problem, tape::Program program, double tolerance, int order) {
  auto made = std::make_shared<Expansion>(std::move(program), tolerance, order);
  if constexpr (ConstantDamping<P>) made->limit(problem.damping());  // of s, also where (q, p) is at rest
  return made;
}
/// For steps of one run: one that the thread's last runs of this type of problem have left or still use, where that is
/// of the same parameters, its program at least, where only the tolerance or the order is another.
template <class X, VectorField P>
std::shared_ptr<Expansion> expansion_of(const P& problem, double tolerance, int order) {
  if constexpr (std::is_trivially_copyable_v<P>) {
    struct Left {
      P problem;
      double tolerance;
      int order;
      std::shared_ptr<Expansion> expansion;
    };
    thread_local std::array<Left, 2> all;  // runs side by side, as on the page; some 16 kB each
    thread_local std::size_t oldest = 0;
    const tape::Program* program = nullptr;
    for (const Left& left : all) {
      // For padding it may only miss. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
      if (!left.expansion || std::memcmp(&left.problem, &problem, sizeof(P)) != 0) continue;
      if (left.tolerance == tolerance && left.order == order) return left.expansion;
      program = &left.expansion->program();
    }
    const HeldByThread nobody(nullptr);  // it stays when its request is over
    auto made = expand<X>(problem, program ? *program : record<X>(problem), tolerance, order);
    all[oldest] = {problem, tolerance, order, made};
    oldest = (oldest + 1) % all.size();
    return made;
  } else {
    return expand<X>(problem, record<X>(problem), tolerance, order);
  }
}

}  // namespace taylor

template <VectorField P, taylor::Flat X>
class TaylorStepper {
 public:
  static constexpr bool reads_time = true, has_dense = true;
  /// Steps are so long that a quantity may change its sign more than once: they are looked at in so many parts.
  static constexpr int parts = 16;

  TaylorStepper(const P& problem, double tolerance, int order)
      : expansion_(taylor::expansion_of<X>(problem, tolerance, order)) {
    if constexpr (carries) expansion_->make_beside();
  }

  StepStatus step(X& x) noexcept { return step_within(x, std::numeric_limits<double>::infinity()); }
  /// A step that is at most so long: where it is as long to the bit, it has come to what lies so far ahead. `late`: by
  /// how much rounding has made x.t too late, for a caller who minds that where the step ends.
  StepStatus step_within(X& x, double most, double late = 0) noexcept {
    begin(x);
    expansion_->move(end_.data(), x.t);
    const Values y = end_, low = low_;
    work_.forces += expansion_->order();
    double h = expansion_->step(most);
    if (!(h > 0)) return StepStatus::singular;
    if (!(x.t + h < x.t + most)) h = most;
    for (;; h *= 0.5) {
      if (h < most && !(x.t + h > x.t)) return StepStatus::underflow;
      expansion_->evaluate(h, y.data(), low.data(), end_.data(), low_.data(), true);
      // At the very time that the next step begins at: what is found here need not be found again.
      if (expansion_->defined(end_.data(), x.t + (h - late))) break;
    }
    if constexpr (carries) {
      mark_ = {0, y, low};
      carry(x.t, h, mark_, low_, end_);
    }
    start_ = y;
    start_low_ = low;
    t_ = x.t;
    h_ = h;
    assign(end_, x);
    x.t = t_ + h;
    return StepStatus::ok;
  }
  /// How long the last step was: the time after it is rounded.
  double elapsed() const { return h_; }

  /// x moved to the time t, not before its own, by as many steps as that takes.
  StepStatus reach(X& x, double t) noexcept {
    constexpr int most_parts = 10'000;
    for (int part = 0; part < most_parts; ++part) {
      if (!(x.t < t)) return StepStatus::ok;
      Values y = values(x), low{};
      expansion_->move(y.data(), x.t);
      work_.forces += expansion_->order();
      const double h = expansion_->step(t - x.t);
      if (!(h > 0)) return StepStatus::singular;
      if (!(x.t + h > x.t)) return StepStatus::underflow;
      [[maybe_unused]] Mark mark{0, y, low};
      expansion_->evaluate(h, low.data(), y.data(), true);
      if constexpr (carries) carry(x.t, h, mark, low, y);
      assign(y, x);
      x.t = h < t - x.t ? x.t + h : t;
    }
    return StepStatus::solver_failed;
  }
  /// x set to the state at t by the polynomial of the last step; false where t lies outside it.
  bool interpolate(X& x, double t) const noexcept {
    const double h = t - t_, slack = 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
    if (!(h_ > 0 && h >= 0 && h <= h_ + slack)) return false;
    Values y = start_, low = start_low_;
    expansion_->move(y.data(), t_);
    expansion_->evaluate(h, low.data(), y.data(), true);
    if constexpr (carries) {
      if (h < mark_.after) mark_ = {0, start_, start_low_};
      carry(t_, h, mark_, low, y);
    }
    assign(y, x);
    x.t = t;
    return true;
  }
  const Work& work() const noexcept { return work_; }
  /// One that has taken no step yet, of the same program.
  TaylorStepper anew() const {
    TaylorStepper other;
    other.expansion_ = expansion_;
    return other;
  }

 private:
  TaylorStepper() = default;

  static constexpr std::size_t count = taylor::components<X>;
  using Values = std::array<double, taylor::with_room<X>>;
  static constexpr std::size_t moving = StateOf<P>::size;
  static constexpr bool carries = count > moving;
  /// Where the series of what is carried was last begun within a step.
  struct Mark {
    double after = 0;  ///< the step's beginning
    Values y{}, low{};
  };

  /// Of the state y at the time h after t, to which the series of the motion has led, what is carried: in as many steps
  /// as it needs, from the mark on, which goes along.
  void carry(double t, double h, Mark& mark, Values& low, Values& y) const noexcept {
    if (mark.after == 0 && !(expansion_->carried_step() < h)) return;
    constexpr int most_parts = 1000;
    taylor::Expansion& series = expansion_->beside();
    for (int part = 0; part < most_parts; ++part) {
      series.move(mark.y.data(), t + mark.after);
      const double most = std::min(series.step(), series.carried_step());
      if (!(most < h - mark.after && mark.after + most > mark.after)) break;
      series.evaluate(most, mark.low.data(), mark.y.data(), true);
      mark.after += most;
    }
    Values end = mark.y, rest = mark.low;
    series.evaluate(h - mark.after, rest.data(), end.data(), true);
    std::copy(end.begin() + moving, end.end(), y.begin() + moving);
    std::copy(rest.begin() + moving, rest.end(), low.begin() + moving);
  }

  Values values(const X& x) const {
    Values y{};
    for (std::size_t i = 0; i < count; ++i) y[i] = taylor::component(x, i);
    return y;
  }
  static void assign(const Values& y, X& x) {
    for (std::size_t i = 0; i < taylor::components<X>; ++i) taylor::component(x, i) = y[i];
  }
  /// Where a step begins: where the last one ended, with what rounding has kept from it, but for what is changed.
  void begin(const X& x) {
    for (std::size_t i = 0; i < count; ++i) set(i, tape::read_alone(taylor::component(x, i)));
  }
  void set(std::size_t i, double value) {
    if (value == end_[i]) return;
    end_[i] = value;
    low_[i] = 0;
  }

  std::shared_ptr<taylor::Expansion> expansion_;
  double t_ = 0, h_ = 0;                          ///< of the last step
  Values start_{}, end_{}, start_low_{}, low_{};  ///< where it began and ended; what rounding has kept from that
  /// In it: states in between, asked for in turn, cost few series.
  [[no_unique_address]] mutable std::conditional_t<carries, Mark, std::monostate> mark_;
  Work work_;
};

struct Taylor {
  double tolerance = 1e-12;
  int order = 0;

  static constexpr bool own_clock = true, asks_no_level = true;
  static constexpr bool remembers = true;  ///< its last step: adapts to the state
  static constexpr std::tuple fields{
      Field<Taylor>{"tolerance",
                    "ε",
                    "1",
                    "what the last terms of a step may be, absolute and relative alike",
                    &Taylor::tolerance,
                    {1e-15, 1e-2}},
      Field<Taylor, int>{"order",
                         "p",
                         "1",
                         "of the polynomial; 0: the one that is the cheapest at the tolerance",
                         &Taylor::order,
                         {0, 40}}};
  static SchemeCard card() {
    return {
        .id = "taylor",
        .title = "Taylor series",
        .summary =
            "The Taylor series of the motion, of high order, by automatic differentiation of the scene's own "
            "equations. Steps are as long as the series allows, the state within a step is its polynomial.",
        .orders = {{"", 20}},
        .structure = "none",
        .good_for =
            "many digits, relaxation and close passages: every part of the motion goes at its own pace; samples "
            "between steps are as accurate as steps and cost no force",
        .fails_when =
            "runs are so long that the drift of the energy counts, which the tolerance sets; forces are not "
            "smooth; the motion is stiff (steps end where the series does). A step counts as many force "
            "evaluations as its order",
        .needs = "equations of motion",
        .references = {"Jorba, Zou, Experimental Mathematics 14, 99 (2005)", "Biscani, Izzo, MNRAS 504, 2614 (2021)"}};
  }
  template <VectorField P, taylor::Flat X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return TaylorStepper<P, X>(problem, tolerance, order);
  }
};

}  // namespace least

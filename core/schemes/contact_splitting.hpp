// contact_splitting: a palindrome of exact flows. For H = K + V + A(s, t), over h with everything in time taken at its
// middle (the flow of time is D, outermost),
//   plain   C½ B½ A B½ C½    C: q += h g⁻¹p, s += hK;  B: p −= h∇V, s −= hV;  A: (p, s) *= e^{−αh}
//   merged  C½ AB C½         AB: p = Ep − φ∇V, s = Es − φV,  E = e^{−αh},  φ = (1 − E)/α
// one force and one exponential a step. For A = γs²/2 − R the flow of A is a Möbius map of s with a pole where the
// motion itself blows up; `plain` leaves −R with V. For a flow that is a sum of exact flows: their palindrome. Order 2,
// symmetric, and for H a contact map with factor e^{−∫α}. Stable for ωh < 2 at every damping; merged, for
// ωh < 2√(x/tanh x), x = αh/2. Where s is linear it is not read by the motion and carried only if asked for.
//   saba_2 … aba_1064   C and AB in turn, for forces and damping that are weak against the drift: see alternation.hpp
// Sources: Bravetti, Seri, Vermeeren, Zadra, Celest. Mech. Dyn. Astron. 132, 7 (2020), section 4; Zadra, Bravetti,
// García-Chung, Seri, Mathematics 9, 1960 (2021).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "core/phases.hpp"
#include "core/scheme.hpp"
#include "core/schemes/alternation.hpp"

namespace least {

enum class Splitting : std::uint8_t { automatic, plain, merged, saba_2, saba_4, aba_864, aba_1064 };
/// The position among `alternations::named`, if it is one of those.
constexpr std::optional<std::size_t> alternation_of(Splitting splitting) {
  if (splitting < Splitting::saba_2) return std::nullopt;
  return static_cast<std::size_t>(splitting) - static_cast<std::size_t>(Splitting::saba_2);
}
static_assert(alternation_of(Splitting::aba_1064) == alternations::named.size() - 1);
inline constexpr auto splitting_names = [] {
  std::array<std::string_view, 3 + alternations::named.size()> all{"automatic", "plain", "merged"};
  std::ranges::transform(alternations::named, all.begin() + 3, &alternations::Named::name);
  return all;
}();

/// ActionFlow has the coefficients of the flow of A over h that do not depend on s: E and φ where A is linear in s;
/// cosh wh and sinh(wh)/w, w² = γR/2, where it is quadratic.
template <class A>
struct ActionFlow {
  A e{}, f{};
  template <class M>
  friend ActionFlow select(const M& mask, const ActionFlow& yes, const ActionFlow& no) {
    using least::select;
    return {select(mask, yes.e, no.e), select(mask, yes.f, no.f)};
  }
};

/// Returns the coefficients of the common flow of A = γs²/2 − R and the potential; `square` is w² = γR/2.
template <class R, class S>
ActionFlow<R> quadratic_flow(const R& square, const S& h) {
  using least::abs;
  using least::cos;
  using least::exp;
  using least::sin;
  using least::sqrt;
  const R x = square * (h * h), w = sqrt(abs(square)), turn = w * h;  // x: (wh)²
  const auto series = [&] {
    R even(1), odd(1);  // Σ xᵏ/(2k)! and Σ xᵏ/(2k + 1)!, to 36 digits
    for (int k = 15; k > 0; --k) {
      even = 1 + x * even / ((2 * k - 1) * (2 * k));
      odd = 1 + x * odd / ((2 * k) * (2 * k + 1));
    }
    return ActionFlow<R>{even, h * odd};
  };
  const auto circular = [&] {
    const auto pole = [] { return ActionFlow<R>{R(-1), R(0)}; };  // within the step whatever s is
    return either(
        abs(turn) < R(3.141592653589793),
        [&] {
          return ActionFlow<R>{cos(turn), sin(turn) / w};
        },
        pole);
  };
  const auto hyperbolic = [&] {
    const R up = exp(turn), down = exp(-turn);
    return ActionFlow<R>{(up + down) / 2, (up - down) / (2 * w)};
  };
  return either(abs(x) < R(0.25), series, [&] { return either(square < R(0), circular, hyperbolic); });
}

/// `merged`: whether A and B are taken as one flow; a mask where each lane has an α of its own.
template <SeparableContact P, class X, class Merged>
class ContactSplittingStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  ContactSplittingStepper(const P& problem, const X& x, double step, const Alternation<S>& turns, const Merged& merged)
      : problem_(problem),
        turns_(&turns),
        merged_(merged),
        clock_(problem, x.t, step, turns.middles(),
               [&](std::size_t i, const S& t) { return middle_of(turns.kick[i] * S(step), t); }) {}

  StatusOf<T> step(X& x, const S& h) noexcept {
    using least::any;
    if constexpr (constant) prepare(h);
    clock_.begin(x.t, h);
    X y = x;
    StatusOf<T> status = StepStatus::ok;
    const auto stages = static_cast<std::size_t>(turns_->stages);
    for (std::size_t i = 0; i < stages; ++i) {
      drift(y, turns_->drift[i] * h);
      status = middle(y, status, turns_->kick[i] * h, i, x.t + turns_->middle[i] * h);
      if (!any(succeeded(status))) return status;
    }
    drift(y, turns_->drift[stages] * h);
    take(x, y, succeeded(status));
    return status;
  }
  const Work& work() const { return work_; }
  /// The stepper keeps nothing of the state: a lane that moves to another stepper takes nothing along.
  template <class F>
  void each_kept(F&&) {}

 private:
  static constexpr bool constant = ConstantDamping<P> || QuadraticContact<P>;
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));
  using R = std::remove_cvref_t<decltype(std::declval<S>() *
                                         action_slope(std::declval<const P&>(), S{}, std::declval<const F&>()))>;
  /// What a stage needs of the time at its middle.
  struct Middle {
    F phase;
    ActionFlow<R> flow;
  };

  void prepare(const S& h) {
    if (h == prepared_) return;
    prepared_ = h;
    for (std::size_t i = 0; i < static_cast<std::size_t>(turns_->stages); ++i)
      flows_[i] = flow(turns_->kick[i] * h, phase(problem_, S(0)));
  }
  ActionFlow<R> flow(const S& h, const F& f) const {
    using least::exp;
    using least::phi1;
    if constexpr (LinearContact<P>) {
      const R z = -(h * damping(problem_, f));
      return {exp(z), either(
                          merged_, [&] { return R(h * phi1(z)); }, [&] { return R(h); })};
    } else {
      if (!merged_) return {R(1), R(h)};
      return quadratic_flow(R(problem_.action_curvature() * problem_.offset() / 2), h);
    }
  }

  template <class Time>
  Middle middle_of(const S& h, const Time& t) const {
    const F f = phase(problem_, t);
    return {f, flow(h, f)};
  }

  /// B½ A B½, or AB.
  StatusOf<T> middle(X& y, StatusOf<T> status, const S& h, std::size_t i, const S& t) {
    const auto [f, c] = clock_.at(i, t, [&](const auto& time) {
      if constexpr (constant) {
        return Middle{phase(problem_, time), flows_[i]};
      } else {
        return middle_of(h, time);
      }
    });
    const Vec<n, T> slope = gradient(problem_, y.q, f);
    ++work_.forces;
    const S half = h * 0.5;
    if constexpr (LinearContact<P>) {
      const auto pushed = [&, &e = c.e, &over = c.f](const T& x, const T& push) {
        return either(
            merged_, [&] { return T(e * x - over * push); }, [&] { return T(e * (x - half * push) - half * push); });
      };
      for (std::size_t k = 0; k < n; ++k) y.p[k] = pushed(y.p[k], slope[k]);
      if constexpr (X::acting) y.action.s = pushed(y.action.s, problem_.potential(y.q, f));
    } else {
      const auto offset = problem_.offset();
      T potential = problem_.potential(y.q, f);
      if (!merged_) potential = potential - offset;
      const T s = y.action.s - half * potential;
      const T d = c.e + (0.5 * problem_.action_curvature()) * (s * c.f);
      if (all_failed(status, !(d > T(0)), StepStatus::singular)) return status;
      for (std::size_t k = 0; k < n; ++k) y.p[k] = (y.p[k] - half * slope[k]) / (d * d) - half * slope[k];
      const T top = merged_ ? T(s * c.e + offset * c.f) : T(s * c.e);
      y.action.s = top / d - half * potential;
    }
    return status;
  }

  void drift(X& y, const S& h) const {
    const auto v = velocity(problem_, y.q, y.p);
    for (std::size_t k = 0; k < n; ++k) y.q[k] = y.q[k] + h * v[k];
    if constexpr (X::acting) y.action.s = y.action.s + (h * 0.5) * dot(y.p, v);
  }

  P problem_;
  const Alternation<S>* turns_;
  Merged merged_;
  PhaseClock<Middle, P, S> clock_;
  S prepared_ = S(std::numeric_limits<double>::quiet_NaN());  ///< the step that flows_ are for
  std::array<ActionFlow<R>, constant ? compositions::most_stages : 1> flows_{};
  Work work_;
};

/// PalindromeStepper composes the exact flows of a SplitFlow to a palindrome. The outermost piece must not depend on
/// time; where two stages meet, its two flows are one.
template <SplitFlow P, class X>
class PalindromeStepper {
 public:
  using S = typename X::Time;

  PalindromeStepper(const P& problem, const Alternation<S>& turns) : problem_(problem), turns_(&turns) {}

  StatusOf<typename X::Number> step(X& x, const S& h) noexcept {
    auto y = x.y;
    const auto stages = static_cast<std::size_t>(turns_->stages);
    const auto start = phase(problem_, x.t);
    for (std::size_t i = 0; i < stages; ++i) {
      y = problem_.flow(Piece<0>{}, y, S(turns_->drift[i] * h), start);
      y = inner<1>(y, S(turns_->kick[i] * h), phase(problem_, x.t + turns_->middle[i] * h));
    }
    x.y = problem_.flow(Piece<0>{}, y, S(turns_->drift[stages] * h), start);
    work_.forces += turns_->stages;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  /// The stepper keeps nothing of the state: a lane that moves to another stepper takes nothing along.
  template <class F>
  void each_kept(F&&) {}

 private:
  template <int I, class Y, class F>
  Y inner(const Y& y, const S& h, const F& f) const {
    if constexpr (I + 1 == P::pieces) {
      return problem_.flow(Piece<I>{}, y, h, f);
    } else {
      const S half = h * 0.5;
      return problem_.flow(Piece<I>{}, inner<I + 1>(problem_.flow(Piece<I>{}, y, half, f), h, f), half, f);
    }
  }

  P problem_;
  const Alternation<S>* turns_;
  Work work_;
};

struct ContactSplitting {
  double step = 0.01;
  Composition composition = Composition::none;
  Splitting splitting = Splitting::automatic;
  static constexpr std::tuple fields{
      step_field<ContactSplitting>(), composition_field<ContactSplitting>(),
      Field<ContactSplitting, Splitting>{"splitting",
                                         "",
                                         "",
                                         "plain: potential and damping apart; merged: their common flow, for strong "
                                         "damping; automatic: merged from αh > 0.5 on; saba and aba: merged, with long "
                                         "steps where forces and damping are weak against the free motion, without a "
                                         "composition. Systems that are not mechanical have one splitting only",
                                         &ContactSplitting::splitting,
                                         {0, 0},
                                         splitting_names}};
  static SchemeCard card() {
    return {
        .id = "contact_splitting",
        .title = "Contact splitting",
        .summary = "A palindrome of exact flows: drift, kick and damping each solved exactly.",
        .orders = orders(),
        .symmetric = true,
        .structure = "contact",
        .recommended = "kahan_li_6",
        .good_for =
            "everything with damping, forcing or exactly solvable parts; with compositions up to order 10; "
            "strong damping (merged); weak perturbations of free motion (saba, aba)",
        .fails_when = "ωh ≥ 2, or the step is long against the damping where the splitting is plain",
        .needs = "a contact Hamiltonian with a constant kinetic metric, or a vector field that is a sum of exact flows",
        .references = {"Bravetti, Seri, Vermeeren, Zadra, Celest. Mech. Dyn. Astron. 132, 7 (2020)",
                       "Zadra, Bravetti, García-Chung, Seri, Mathematics 9, 1960 (2021)",
                       "Laskar, Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001)",
                       "Blanes, Casas, Farrés, Laskar, Makazaga, Murua, Appl. Numer. Math. 68, 58 (2013)"}};
  }
  std::vector<Conflict> conflicts(const ProblemCard& problem) const {
    if (!alternation_of(splitting)) return {};
    const auto reads_action = [](const VariableCard& variable) { return variable.name == "s" && !variable.optional; };
    if (!problem.keeps_form || std::ranges::any_of(problem.variables, reads_action))
      return {{"splitting", "needs mechanics with a damping α(t)s", "automatic, plain, merged"}};
    if (composition != Composition::none)
      return {{"composition", "goes with the splittings automatic, plain and merged: the others have their own order",
               "none"}};
    return {};
  }
  template <SeparableContact P, class X>
  auto bind(const P& problem, const X& x) const {
    const auto merged = takes_as_one(problem);
    return ContactSplittingStepper<P, X, std::remove_const_t<decltype(merged)>>(problem, x, step,
                                                                                turns<typename X::Time>(), merged);
  }
  template <SplitFlow P, class X>
  auto bind(const P& problem, const X&) const {
    return PalindromeStepper<P, X>(problem, turns<typename X::Time>());
  }

  /// Merged, the flow of the damping with the force is exact.
  template <class P>
  double stiff_from(const P& problem) const {
    return takes_as_one(problem) ? std::numeric_limits<double>::infinity() : 2;
  }
  /// A single step reads everything at its middle and so keeps order 2 at a singular start; the others have to begin on
  /// a series.
  template <class P>
  bool starts_at_singularity(const P&) const {
    return composition == Composition::none && !alternation_of(splitting);
  }

 private:
  static std::vector<std::pair<std::string, int>> orders() {
    auto all = orders_from(2);
    for (const auto& named : alternations::named) all.emplace_back(named.name, named.order);
    return all;
  }
  template <class S>
  const Alternation<S>& turns() const {
    if (const auto i = alternation_of(splitting)) return Alternation<S>::named(*i);
    return Alternation<S>::of(composition);
  }
  template <class P>
  auto takes_as_one(const P& problem) const {
    if constexpr (ConstantDamping<P>) {
      constexpr double ever = std::numeric_limits<double>::infinity();
      return problem.damping() * step > (splitting >= Splitting::merged  ? -ever
                                         : splitting == Splitting::plain ? ever
                                                                         : 0.5);
    } else {
      return splitting >= Splitting::merged || (splitting == Splitting::automatic && QuadraticContact<P>);
    }
  }
};

}  // namespace least

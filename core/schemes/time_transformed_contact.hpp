// time_transformed where there is damping, H = K(p) + V(q, t) + α(t) s with a constant kinetic metric: steps that
// follow the motion and are contact maps. Derived here from contact Hamilton's equations (Bravetti, Entropy 19, 535
// (2017)) by the time transformation of Preto & Tremaine (1999); no source is known that has it. On the extended space
// (q, t; p, p_t; s) with the form ds − p·dq − p_t dt, put
//   A = K + p_t + αs + c,  B = c − V,  c = κ + E₀,  F(x) = xᵏ/k,  k < 0
// with p_t = −H at the start, so that A = B. The contact Hamiltonian Γ = F(A) − F(B) vanishes there and stays 0, as
// Γ′ = −ΓΓ_s; where it is 0 its field is Aᵏ⁻¹ times that of H: dt/dτ = Aᵏ⁻¹. Its parts, taken as A½ B A½ over τ:
//   −F(B)   p −= τBᵏ⁻¹∇V, s += τF(B), p_t −= τBᵏ⁻¹V_t: exact
//   F(A)    q, p move along the present momentum alone, for a time Δt:
//     α constant: exact. z = α(1 − k)r/k with r = τA₀ᵏ⁻¹; A₁ = A₀(1 − z)^{1/(1−k)}, αΔt = −k ln(A₁/A₀),
//       E = e^{−αΔt}: q += (1 − E)/α g⁻¹p, p and p_t are multiplied by E. z ≥ 1 is a pole that α < 0 has.
//     α(t): with a = ∫α the form times eᵃ is dS − π·dq − Π dt, π = eᵃp, Π = eᵃ(p_t + αs), and eᵃF(A), which does not
//       contain S, generates the discrete Lagrangian of t, F* being the Legendre transform of F,
//         L = eᵃτF*(δ/τ) − δ(c eᵃ + K(π)e⁻ᵃ),  a at the middle of t₀ and t₁ = t₀ + δ,
//       of order 2 in τ and symmetric; Π₀ = −∂L/∂t₀ is one equation for δ, solved by Newton's method.
// What a stage reads of p_t and s is A alone, which is kept from step to step: s, where asked for, goes along. With
// λ = e^{−∫α} a step φ fulfils φ*η = λη; p is only ever multiplied and pushed along ∇V: in a central force with
// constant α the angular momentum decays by e^{−αt} to round-off. κ = −E₀ where V < 0, else κ > max V − E₀ along the
// orbit. Look-alike: αs taken to V instead; s grows, and B loses its sign.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/problem_traits.hpp"
#include "core/schemes/damping_integral.hpp"
#include "core/schemes/transformed_stepper.hpp"

namespace least {

/// PowerSlope computes F′(x) = xᵏ⁻¹ of F(x) = xᵏ/k; for k = −½ by a square root that runs beside the division.
class PowerSlope {
 public:
  explicit PowerSlope(double k) : k_(k) {}
  /// Returns factor · xᵏ⁻¹.
  template <class T>
  T operator()(const T& x, const T& factor = T(1)) const {
    using least::pow;
    using least::sqrt;
    return k_ == -0.5 ? T(sqrt(x) * (factor / (x * x))) : T(factor * pow(x, k_ - 1));
  }

 private:
  double k_;
};

/// Series is the first N terms, N even, of a power series in z that is 1 at z = 0, for small z.
template <class S, std::size_t N>
class Series {
 public:
  /// (1 − (1 − z)ᵐ)/(mz); its limit −ln(1 − z)/z for m = 0.
  static Series power(const S& m) {
    return Series([&](const S& j) { return j - m; });
  }
  /// (eᶻ − 1)/z
  static Series exponential() {
    return Series([](const S&) { return S(1); });
  }
  /// Returns `factor` times the series, with a short chain of dependent operations, because steps wait for it.
  template <class T>
  T operator()(const T& z, const T& factor) const {
    const T z2 = z * z;
    T power = factor, sum = factor * (c_[0] + c_[1] * z);
    for (std::size_t j = 2; j < N; j += 2) {
      power = power * z2;
      sum = sum + power * (c_[j] + c_[j + 1] * z);
    }
    return sum;
  }

 private:
  /// c_j/c_{j−1} = rise(j)/(j + 1)
  template <class F>
  explicit Series(const F& rise) {
    c_[0] = S(1);
    for (std::size_t j = 1; j < N; ++j) c_[j] = c_[j - 1] * rise(S(double(j))) / S(double(j + 1));
  }
  std::array<S, N> c_;
};

/// Why a step could not be taken.
enum class TransformedFault : std::uint8_t { standstill, pole, kinetic, potential, level, unsolved };
/// Describes a fault in words. `room`: the number that failed, such as A or B where it is not positive.
std::string words_of(TransformedFault fault, double kappa, double room);

template <LinearContact P, class X>
requires SeparableContact<P>
class TransformedContact {
 public:
  using T = typename X::Number;
  using Constant = typename Underlying<T>::type;
  using S = std::conditional_t<std::numeric_limits<Constant>::is_specialized, Constant, double>;
  static constexpr bool constant = ConstantDamping<P>;
  static constexpr bool reads_time = !Autonomous<P>;
  /// A, which has to be kept because it contains p_t + αs, and Aᵏ⁻¹, which one flow hands on to the next.
  struct Memory {
    T a, pace;
  };

  /// `level`: c = κ + E₀; `kappa` is for messages alone. The run begins at x: A = B there.
  TransformedContact(const P& problem, const X& x, const T& level, const T& kappa, double exponent,
                     const Weights<S>& weights)
      : problem_(problem),
        level_(level),
        kappa_(kappa),
        slope_(exponent),
        inverse_(1 / S(exponent)),
        weights_(&weights),
        time_(Powers::power(S(0))),
        way_(Powers::power(S(exponent) / (1 - S(exponent)))),
        way2_(Powers::power(2 * S(exponent) / (1 - S(exponent)))),
        fall_(Powers::power(1 / (1 - S(exponent)))),
        growth_(Powers::exponential()) {
    settle(x, at(level - problem.potential(x.q, phase(problem, x.t))));
  }
  void settle(const X& x, const Memory& memory) {
    now_ = memory;
    if constexpr (!constant) here_ = damping_at(problem_, x.t);
  }
  const Memory& memory() const { return now_; }
  /// Returns the memory for this value of A.
  Memory at(const T& a) const { return {a, slope_(a)}; }
  const T& pace(const X&) const { return now_.pace; }
  /// The largest |B²/(A₀A₁) − 1| of a kick.
  T strain() const { return strain_ / strain_level_; }
  int stages() const { return weights_->stages; }
  std::string failure() const { return words_of(fault_, value_of(kappa_), value_of(room_)); }

  StepStatus move(X& state, const T& sigma, T& time, Work& work) {
    using least::all;
    X x;  // locals, which stay in registers from stage to stage as long as stages are inlined
    x.t = state.t;
    x.q = state.q;
    x.p = state.p;
    x.action = state.action;
    Memory now = now_;
    T elapsed(0);
    [[maybe_unused]] const auto here = here_;
    fault_ = TransformedFault::standstill;  // where all stages succeed and the time does not advance
    const auto stages = static_cast<std::size_t>(weights_->stages);
    const T half = 0.5 * sigma;
    S before(0);
    for (std::size_t i = 0; i < stages; ++i) {
      const S& gamma = weights_->gamma[i];
      if constexpr (constant) {  // flows: two that meet are one
        if (!flow(x, now, half * (before + gamma), elapsed)) return StepStatus::singular;
        if (!kick(x, now, sigma * gamma, elapsed, work)) return StepStatus::singular;
      } else {
        if (!generated(x, now, half * gamma, elapsed, work) || !kick(x, now, sigma * gamma, elapsed, work) ||
            !generated(x, now, half * gamma, elapsed, work)) {
          here_ = here;
          return fault_ == TransformedFault::unsolved ? StepStatus::solver_failed : StepStatus::singular;
        }
      }
      before = gamma;
    }
    if constexpr (constant)
      if (!flow(x, now, half * before, elapsed)) return StepStatus::singular;
    if (!all(elapsed * sigma > T(0))) [[unlikely]] {
      here_ = here;
      return StepStatus::singular;
    }
    state.q = x.q;
    state.p = x.p;
    state.action = x.action;
    now_ = now;
    time = elapsed;
    return StepStatus::ok;
  }

 private:
  static constexpr std::size_t terms = Precision<S>::epsilon > 1e-17 ? 6 : 14;
  static constexpr double small = 1.0 / 512;
  using Powers = Series<S, terms>;
  using Vector = decltype(X::q);

  /// The part F(A) with constant α: Δt, (1 − E)/α, (1 − E²)/2α and (A₀ − A₁)/(αA₀).
  struct Passage {
    T time, way, way2, fall;
    template <class M>
    friend Passage select(const M& mask, const Passage& yes, const Passage& no) {
      using least::select;
      return {select(mask, yes.time, no.time), select(mask, yes.way, no.way), select(mask, yes.way2, no.way2),
              select(mask, yes.fall, no.fall)};
    }
  };

  bool fail(TransformedFault fault, const T& room) {
    fault_ = fault;
    room_ = room;
    return false;
  }

  [[gnu::always_inline]] bool flow(X& x, Memory& now, const T& tau, T& elapsed) {
    using least::abs;
    using least::all;
    if (!all(now.a > T(0))) [[unlikely]]
      return fail(TransformedFault::kinetic, now.a);
    const auto alpha = problem_.damping();
    const T r = tau * now.pace, z = (alpha * (inverse_ - 1) * tau) * now.pace;
    const auto series = [&] {
      Passage by{time_(z, r), way_(z, r), T(0), fall_(z, T(r * inverse_))};
      if constexpr (X::acting) by.way2 = way2_(z, r);
      return by;
    };
    const auto closed = [&] {
      using least::log1m;
      using least::phi1;
      const T time = -(r * log1m(z) / z), decay = -(alpha * time);
      Passage by{time, time * phi1(decay), T(0), time * phi1(T(decay * inverse_)) * inverse_};
      if constexpr (X::acting) by.way2 = time * phi1(T(2.0 * decay));
      return by;
    };
    if (!all(z < T(1))) [[unlikely]]
      return fail(TransformedFault::pole, z);
    const Passage by = either(abs(z) < T(small), series, closed);
    const T e = 1.0 - alpha * by.way;
    const auto v = velocity(problem_, x.q, x.p);
    if constexpr (X::acting) {
      const T kinetic = 0.5 * dot(x.p, v);
      T& s = x.action.s;
      s = e * s + 2.0 * kinetic * by.way2 + (now.a - kinetic - level_) * by.way - now.a * by.fall;
    }
    for (std::size_t i = 0; i < x.q.size(); ++i) {
      x.q[i] = x.q[i] + by.way * v[i];
      x.p[i] = e * x.p[i];
    }
    now.a = now.a - (alpha * now.a) * by.fall;
    now.pace = now.pace / (1.0 - z);
    elapsed = elapsed + by.time;
    return true;
  }

  /// eᶻ − 1
  T grown(const T& z) const {
    using least::abs;
    using least::phi1;
    const auto series = [&] { return growth_(z, z); };
    const auto closed = [&] { return T(z * phi1(z)); };
    return either(abs(z) < T(small), series, closed);
  }

  /// The part F(A) with α(t), by its discrete Lagrangian.
  bool generated(X& x, Memory& now, const T& tau, T& elapsed, Work& work) {
    using least::abs;
    using least::all;
    constexpr int most_iterations = 30;
    if (!all(now.a > T(0))) [[unlikely]]
      return fail(TransformedFault::kinetic, now.a);
    const S legendre = 1 - inverse_, bend = 1 / inverse_ - 1;  // F*(F′(A)) = legendre A F′(A); k − 1
    const auto v = velocity(problem_, x.q, x.p);
    const T kinetic = 0.5 * dot(x.p, v), bound = now.a - kinetic - level_, t0 = x.t + elapsed, r = tau * now.pace;
    const T near(4 * std::sqrt(Precision<S>::epsilon));
    // The first guess of δ, to the third order in r.
    const T h = 0.5 * r * here_.rate, inverse = 1.0 / now.a;
    T delta = r * (1.0 - legendre * h + (h * h) * (legendre * (legendre - 0.5) + (0.5 * bend) * (bound * inverse)) +
                   (0.125 * bend * (r * r) * here_.slope) * (2.0 * legendre - 1.0 + (kinetic - level_) * inverse));
    int last = std::is_same_v<T, Constant> ? 0 : 1;  // derivatives lag behind by an iteration
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      ++work.iterations;
      DampingAt<T> middle = damping_after(problem_, here_, t0, T(t0 + 0.5 * delta));
      const T exponent = here_.integral - middle.integral, loss = grown(exponent);
      T e = 1.0 + loss, slow = kinetic * (e * e);  // what is left of p, of K
      const T y = 0.5 * delta * middle.rate, rise = 0.5 * (middle.rate + 0.5 * delta * middle.slope);
      const T top = now.a + loss * (bound + kinetic * (1.0 + e)) - y * (level_ - slow), bottom = 1.0 - legendre * y;
      T mean = top / bottom;
      if (!all(mean > T(0))) [[unlikely]]
        return fail(TransformedFault::pole, mean);
      const T g = tau * slope_(mean);
      // Newton's method: `turn` is d ln(mean)/dδ. In the derivative of g, δ stands for g, which is computed late.
      const T lost = 0.5 * middle.rate * (e * bound) + middle.rate * (slow * (1.0 + y)) + rise * (level_ - slow);
      const T turn = legendre * rise / bottom - lost / top;
      const T change = (g - delta) / (1.0 - bend * (delta * turn));
      delta = delta + change;
      if (!all(abs(change) <= near * abs(delta)) || last-- > 0) continue;
      // The rest by Taylor's formula: its square is below round-off.
      const T wait = 0.5 * change;
      mean = mean + mean * turn * change;
      middle.integral = middle.integral + wait * (middle.rate + 0.5 * wait * middle.slope);
      e = e - e * middle.rate * wait;
      middle.rate = middle.rate + middle.slope * wait;
      arrive(x, now, v, kinetic, delta, mean, e, middle, damping_after(problem_, here_, t0, T(t0 + delta)));
      elapsed = elapsed + delta;
      return true;
    }
    return fail(TransformedFault::unsolved, delta);
  }
  /// The end of that part, after the time δ; `e`: what is left of p in the middle.
  void arrive(X& x, Memory& now, const Vector& v, const T& kinetic, const T& delta, const T& mean, const T& e,
              const DampingAt<T>& middle, const DampingAt<T>& there) {
    const S legendre = 1 - inverse_;
    const T exponent = middle.integral - there.integral, loss = grown(exponent), after = 1.0 + loss;
    const T slow = kinetic * (e * e), y = 0.5 * delta * middle.rate, way = delta * e, left = e * after;
    if constexpr (X::acting) x.action.s = after * (e * x.action.s + delta * (slow - level_ + legendre * mean));
    now = at(mean * (after * (1.0 + legendre * y)) - level_ * (loss + y * after) + slow * (after * (loss + y)));
    for (std::size_t i = 0; i < x.q.size(); ++i) {
      x.q[i] = x.q[i] + way * v[i];
      x.p[i] = left * x.p[i];
    }
    here_ = there;
  }

  /// The part −F(B).
  [[gnu::always_inline]] bool kick(X& x, Memory& now, const T& tau, const T& elapsed, Work& work) {
    using least::abs;
    using least::all;
    using least::select;
    const auto f = phase(problem_, T(x.t + elapsed));
    const auto [potential, gradient] = potential_at(problem_, x.q, f);
    ++work.forces;
    const T b = level_ - potential, push = slope_(b, tau), lift = b * inverse_;  // push·lift = τF(B)
    const Vector rate = velocity(problem_, x.q, gradient);
    // A changes by what K, αs and p_t change by. All that does not need `push` is computed while that is pending.
    T change = -dot(rate, x.p);
    if constexpr (constant) {
      change = change + problem_.damping() * lift;
    } else {
      change = change + here_.rate * lift;
    }
    if constexpr (PotentialReadsTime<P>) change = change - potential_rate(problem_, x.q, T(x.t + elapsed));
    const T a = (now.a + push * change) + (push * push) * (0.5 * dot(rate, gradient));
    for (std::size_t i = 0; i < x.p.size(); ++i) x.p[i] = x.p[i] - push * gradient[i];
    if constexpr (X::acting) x.action.s = x.action.s + push * lift;
    const T square = b * b, level = now.a * a, off = abs(square - level);
    if (!all(b > T(0))) [[unlikely]]
      return fail(TransformedFault::potential, b);
    if (!all(a > T(0))) [[unlikely]]
      return fail(TransformedFault::kinetic, a);
    if (!all(near_level(square, level))) [[unlikely]]
      return fail(TransformedFault::level, T(square / level));
    const auto more = off * strain_level_ > strain_ * level;  // kept as a fraction, to spare a division
    strain_ = select(more, off, strain_);
    strain_level_ = select(more, level, strain_level_);
    now = at(a);
    return true;
  }

  P problem_;
  T level_, kappa_;
  PowerSlope slope_;
  S inverse_;  ///< 1/k
  const Weights<S>* weights_;
  Powers time_, way_, way2_, fall_, growth_;
  Memory now_{};
  T strain_ = T(0), strain_level_ = T(1), room_{};
  struct Nothing {};
  [[no_unique_address]] std::conditional_t<constant, Nothing, DampingAt<T>> here_{};  ///< at the time of the state
  TransformedFault fault_ = TransformedFault::standstill;
};

}  // namespace least

// The Lane–Emden equation q̈ + (2/t) q̇ + qⁿ = 0 of a star in equilibrium: H = p²/2 + q^{n+1}/(n+1) + (2/t) s, from its
// regular start at t = 0.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "core/describe.hpp"
#include "core/number/quad.hpp"
#include "core/problem.hpp"

namespace least::problems {

/// AfterZero is what follows the first zero of q: the end of the motion; the power qⁿ itself; |q|^{n−1} q; or no force.
enum class AfterZero : std::uint8_t { stop, continue_, signed_, clamp };

template <class R = double>
struct LaneEmden {
  R n{3};
  AfterZero after_zero = AfterZero::stop;

  static constexpr int dof = 1;

  constexpr bool bounded() const { return after_zero == AfterZero::stop; }
  constexpr bool continues() const { return after_zero == AfterZero::continue_; }
  /// straight(): for n = 0 the force goes on unchanged past the zero. Where the motion ends at the zero, steps still
  /// look beyond it, otherwise as with `signed_`.
  constexpr bool straight() const { return bounded() || continues(); }
  /// plain(): the force is the power of q itself also for q < 0. This includes odd whole n, where the power has the
  /// sign of q.
  constexpr bool plain() const {
    if constexpr (std::is_same_v<R, double>) {
      const double half = (n - 1) / 2;
      if (after_zero != AfterZero::clamp && half >= 0 && half == static_cast<int>(half)) return true;
    }
    return continues();
  }

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    using least::abs;
    using least::pow;
    using least::select;
    const auto power = [&] {
      const T v = pow(continues() ? q[0] : abs(q[0]), n + 1.0) / (n + 1.0);
      return after_zero == AfterZero::clamp ? select(q[0] < T(0), T(0), v) : v;
    };
    return straight() ? either(n > 0, power, [&] { return q[0]; }) : power();
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    using least::abs;
    using least::pow;
    using least::select;
    const auto past_zero = [&](const T& w) {
      return plain() ? w : select(q[0] < T(0), after_zero == AfterZero::clamp ? T(0) : T(-w), w);
    };
    return {either(
        n > 0, [&] { return past_zero(pow(plain() ? q[0] : abs(q[0]), n)); },
        [&] { return straight() ? T(1) : past_zero(T(1)); })};
  }
  template <class S>
  constexpr auto damping(const S& t) const {
    return 2.0 / t;
  }
  template <class S>
  constexpr auto damping_integral(const S& t) const {
    using least::log;
    return 2.0 * log(t);
  }
  /// Zeros of q are reported; the first is the surface of the star.
  template <class T>
  constexpr T section(const Vec<1, T>& q) const {
    return q[0];
  }
  /// A bounded motion ends where this becomes negative.
  template <class T>
  constexpr T inside(const Vec<1, T>& q) const {
    return q[0];
  }

  /// Up to this time the series replaces the steps, as α = 2/t is infinite at the start.
  static constexpr double series_until = 0.1;
  /// q = Σ a_k t^{2k}, qⁿ = Σ c_k t^{2k} by Miller's recurrence, and s = t⁻² ∫₀ᵗ τ² (p²/2 − V) dτ where `asked`, else
  /// 0.
  template <class T, bool asked, class S>
  State<1, T, S, Action<T>> series(const S& t) const {
    if (t == S(0)) return {t, {T(1)}, {T(0)}, {T(0)}};
    // For doubles twelve terms suffice: each is at most a sixtieth of the one before. A single state stops earlier, at
    // the second negligible term in a row, as one alone may vanish by chance (n = 5/8).
    constexpr std::size_t most = std::is_same_v<T, Quad> ? 40 : 12;
    constexpr bool alone = std::is_same_v<T, double> && std::is_same_v<S, double>;
    std::size_t terms = most;
    const T power(n);
    const S t2 = t * t;
    Vec<most + 1, T> a{T(1)}, c{T(1)}, l{};
    [[maybe_unused]] S power_of_t(1);
    // Multiplication by a reciprocal has a shorter latency than division
    const auto over = [](const T& x, std::size_t whole) {
      return alone ? T(x * (T(1) / double(whole))) : T(x / double(whole));
    };
    [[maybe_unused]] bool last_was_nothing = false;
    for (std::size_t k = 0; k < terms; ++k) {
      if (k > 0) {
        T sum(0);
        for (std::size_t i = 1; i <= k; ++i) sum = sum + (power * double(i) - double(k - i)) * (a[i] * c[k - i]);
        c[k] = over(sum, k);
      }
      a[k + 1] = -over(c[k], (2 * k + 2) * (2 * k + 3));
      if constexpr (alone) {
        power_of_t *= t2;  // t^{2k + 2}, the power of the next term
        const bool nothing = std::abs(c[k]) * power_of_t < 1e-20;
        if (nothing && last_was_nothing) terms = k + 1;
        last_was_nothing = nothing;
      }
      if constexpr (!asked) continue;
      for (std::size_t i = 0; i <= k; ++i) l[k] = l[k] - a[i] * c[k - i] / (power + 1.0);
      for (std::size_t i = 1; i <= k; ++i) l[k] = l[k] + 2.0 * double(i * (k + 1 - i)) * (a[i] * a[k + 1 - i]);
    }
    T q(0), p(0), s(0);
    for (std::size_t k = terms; k-- > 0;) {
      q = q * t2 + a[k];
      p = p * t2 + 2.0 * double(k + 1) * a[k + 1];
      if constexpr (asked) s = s * t2 + l[k] / double(2 * k + 3);
    }
    return {t, {q}, {p * t}, {s * t}};
  }

  /// Closed forms exist for n = 0, 1 and 5 from the regular start.
  template <class X>
  bool exact_applies(const X& x0) const {
    const bool regular = x0.t == 0 && x0.q[0] == 1 && x0.p[0] == 0;
    return regular && (n == 5 || ((n == 0 || n == 1) && straight()));
  }
  template <class T, class S>
  State<1, T, S> exact(const State<1, T, S>&, const S& t) const {
    using least::abs;
    using least::sincos;
    using least::sqrt;
    const T x(t), x2 = x * x;
    if (n == 0) return {t, {1 - x2 / 6}, {-x / 3}, {}};
    if (n == 5) {
      const T w = 3 / (3 + x2), q = sqrt(w);
      return {t, {q}, {-x * w * q / 3}, {}};
    }
    if (abs(x) < 1) {
      T q(0), p(0);
      for (int k = 16; k > 0; --k) {
        p = 2 * k - x2 * p / ((2 * k + 2) * (2 * k + 3));
        q = 1 - x2 * q / ((2 * k) * (2 * k + 1));
      }
      return {t, {q}, {-x * p / 6}, {}};
    }
    const auto [sine, cosine] = sincos(x);
    return {t, {sine / x}, {(cosine - sine / x) / x}, {}};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::LaneEmden> {
  using P = problems::LaneEmden<>;
  static constexpr std::array<std::string_view, 4> after_zero{"stop", "continue", "signed", "clamp"};
  static constexpr std::tuple fields{
      Field<P>{"n", "n", "1", "polytropic index: pressure as density to the power 1 + 1/n", &P::n, {0, 20}},
      Field<P, problems::AfterZero>{
          "after_zero",
          "",
          "",
          "past the first zero of q: end there, go on with the plain power (whole n), with |q|^{n−1} q, or with "
          "no force",
          &P::after_zero,
          {0, 3},
          after_zero},
  };
  static ProblemCard card() {
    return {
        .id = "lane_emden",
        .title = "Lane–Emden equation",
        .summary =
            "A star from its centre outward, t being the radius: its density is q to the power n, its pressure q to "
            "the "
            "power n + 1, both relative to the centre. Watch for the first zero of q, the surface: it moves outward as "
            "n grows and is gone from n = 5 on.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><msup><mi>q</mi><mrow><mi>n</mi><mo>+</mo><mn>1</mn></mrow></msup><mrow><mi>n</mi>"
            "<mo>+</mo><mn>1</mn></mrow></mfrac><mo>+</mo><mfrac><mn>2</mn><mi>t</mi></mfrac><mi>s</mi>"
            "</math>",
        .variables = {{"q", "q", "1", "density to the power 1/n, relative to the centre", 1},
                      {"p", "p", "1", "its slope", 0},
                      {"s", "s", "1", "action", 0, true}},
        .span = 10,
        .suggested = {{"step", 0.01}, {"sigma", 0.01}},
        .presets = {{"uniform", "constant density; q = 1 − t²/6", {{"n", 0}}, {}},
                    {"sine", "sin t/t, surface at π", {{"n", 1}}, {}},
                    {"convective", "a small cool star", {{"n", 1.5}}, {}},
                    {"plummer", "no surface: (1 + t²/3)^{−1/2}", {{"n", 5}}, {}}},
        .references = {"Chandrasekhar, An Introduction to the Study of Stellar Structure, 1939, chapter IV"},
    };
  }
};

}  // namespace least

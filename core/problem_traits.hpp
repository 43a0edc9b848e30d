// What a run needs of a scene beyond its mechanics: which state it carries, how a list of variables becomes a state,
// and what else the problem can say of itself to diagnostics. A problem may offer, as members,
//   section(q)                  a quantity whose zeros are reported
//   oscillates                  a flow in (x, v) whose limit cycle has a period and an amplitude
//   carries_slope               a flow in (x, v) whose slope dv/dx along a tangent direction can be carried
//   inside(q), bounded()        a quantity that must not become negative where bounded() says so
//   series(t), series_until     the regular solution from t = 0, where the equations of motion are singular there
//   entropy(y)                  never falls
//   moments(y), moment_names    averages over time along the orbit,
//   log_weight(y), log_rate(y)  with a weight, and over a physical time that passes at a rate, by their logarithms
//   stiffness_rate()            a run warns where a step is half its inverse
//   quantities(y, t)            further columns
//   gravitational_parameter()   μ of an orbit about the origin, p being the velocity: its elements are said
//   log_gradient(q, factor)     factor·∇ln|V|, where that is less to compute than V and ∇V
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "core/describe.hpp"
#include "core/equations.hpp"

namespace least {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

template <class P>
concept HasSection = requires(const P& m, const Vec<P::dof>& q) {
  m.section(q);
};
template <class P>
concept Oscillates = Flow<P> && requires {
  requires P::oscillates;
};
template <class P>
concept CarriesSlope = Flow<P> && requires {
  requires P::carries_slope;
};
template <class P>
concept HasDomain = requires(const P& m, const Vec<P::dof>& q) {
  m.inside(q);
  m.bounded();
};
template <class P>
concept HasSeries = requires(const P& m) {
  m.template series<double, true>(0.0);
  P::series_until;
};
template <class P>
concept HasEntropy = Flow<P> && requires(const P& m, const Vec<P::dim>& y) {
  m.entropy(y);
};
template <class P>
concept HasMoments = Flow<P> && requires(const P& m, const Vec<P::dim>& y) {
  m.moments(y);
  m.log_weight(y);
  m.log_rate(y);
};
template <class P>
concept HasQuantities = Flow<P> && requires(const P& m, const Vec<P::dim>& y) {
  m.quantities(y, 0.0);
};
template <class P>
concept TwoBody = requires(const P& m) {
  { m.gravitational_parameter() } -> std::convertible_to<double>;
};
template <class P, class T>
concept HasLogGradient = requires(const P& m, const Vec<P::dof, T>& q, const T& factor) {
  m.log_gradient(q, factor);
};

constexpr double value_of(double x) { return x; }
template <class T, int K>
constexpr double value_of(const Dual<T, K>& x) {
  return value_of(x.value);
}

/// A number with one direction of a tangent space: carries the slope of a flow.
using Slope = Dual<double, 1>;
template <class X>
concept Sloped = std::is_same_v<typename X::Number, Slope>;

/// The state a run carries when all that the caller can ask for is asked for.
template <class P>
using FullRunState =
    std::conditional_t<CarriesSlope<P>, typename StateOf<P>::template in<Slope, double>, FullStateOf<P>>;

/// The numbers of a state, without its tangent direction.
template <class X>
constexpr auto plain(const X& x) {
  typename X::template in<double, double> y;
  y.t = x.t;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = value_of(x[i]);
  return y;
}

/// Takes a tangent direction that has become very long or short to length 1: only its direction means something.
/// `count`: its components.
inline void normalise_slopes(double* slope, std::size_t count) {
  double size = 0;
  for (std::size_t i = 0; i < count; ++i) size = std::max(size, std::abs(slope[i]));
  if (size > 1e50 || (size > 0 && size < 1e-50))
    for (std::size_t i = 0; i < count; ++i) slope[i] /= size;
}
/// The same where slopes stand beside their values.
template <class X>
void normalise(X& x, std::size_t count) {
  double size = 0;
  for (std::size_t i = 0; i < count; ++i) size = std::max(size, std::abs(x[i].slope[0]));
  if (size > 1e50 || (size > 0 && size < 1e-50))
    for (std::size_t i = 0; i < count; ++i) x[i].slope[0] /= size;
}
template <Sloped X>
void normalise(X& x) {
  normalise(x, X::size);
}

/// The state that a list of the card's variables describes. A slope that is not a number is the flow's own.
template <class X, class P>
X start_of(const P& problem, const std::vector<double>& variables, double t) {
  X x;
  x.t = t;
  for (std::size_t i = 0; i < X::size; ++i) x[i] = variables[i];
  if constexpr (Sloped<X>) {
    const auto rate = derivative(problem, plain(x));
    const double slope = variables[X::size];
    for (std::size_t i = 0; i < X::size; ++i) x[i].slope[0] = std::isnan(slope) ? rate[i] : (i == 0 ? 1 : slope);
    normalise(x);
  }
  return x;
}

/// The i-th variable of the card at a state: unknown where the state does not carry it, or at a pole.
template <class X>
double variable(const X& x, std::size_t i) {
  if (i < X::size) return value_of(x[i]);
  if constexpr (Sloped<X>)
    if (const double slope = x[1].slope[0] / x[0].slope[0]; std::isfinite(slope)) return slope;
  return unknown;
}

/// The regular solution that begins at t = 0, at t ≤ series_until.
template <class X, HasSeries P>
X series_state(const P& problem, const typename X::Time& t) {
  X x;
  constexpr bool acting = X::size > StateOf<P>::size || StateOf<P>::acting;
  assign(x, problem.template series<typename X::Number, acting>(t));
  x.t = t;
  return x;
}
/// Whether x is on that solution, as far as the series reaches.
template <class P, class X>
bool starts_series(const P& problem, const X& x) {
  if constexpr (HasSeries<P>) {
    using S = typename X::Time;
    if (!(x.t >= S(0) && x.t <= S(P::series_until))) return false;
    const X regular = series_state<X>(problem, x.t);
    for (std::size_t i = 0; i < StateOf<P>::size; ++i)
      if (!(x[i] == regular[i])) return false;
    return true;
  } else {
    return false;
  }
}

/// Of the domain of the motion.
template <class P, class X>
bool outside([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
  if constexpr (HasDomain<P>) return problem.bounded() && !(problem.inside(position(x)) >= 0);
  return false;
}

/// The energy; at the singular start of a series its limit.
template <class P, class X>
double energy_of(const P& problem, const X& x) {
  if constexpr (HasSeries<P>)
    if (x.t == 0 && starts_series(problem, x)) return energy(problem, series_state<X>(problem, 1e-9));
  return energy(problem, x);
}

/// The quantities whose changes of sign are events.
template <class P, class X>
auto sections(const P& problem, const X& x) {
  if constexpr (HasSection<P>) {
    return std::array<double, 1>{problem.section(x.q)};
  } else if constexpr (Oscillates<P> && Sloped<X>) {
    return std::array<double, 3>{x.y[0].value, x.y[1].value, x.y[0].slope[0]};
  } else if constexpr (Oscillates<P>) {
    return std::array<double, 2>{x.y[0], x.y[1]};
  } else {
    return std::array<double, 0>{};
  }
}

}  // namespace least

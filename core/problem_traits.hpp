// What a run needs of a scene beyond its mechanics: the state that it carries, the conversion of a list of variables to
// a state, and what else the problem offers to diagnostics. A problem may offer, as members,
//   section(q)                  a quantity whose zeros are reported
//   oscillates                  a flow in (x, v) whose limit cycle has a period and an amplitude
//   carries_slope               a flow in (x, v) whose slope dv/dx along a tangent direction can be carried
//   inside(q), bounded()        a quantity that must not become negative if bounded() is true
//   series(t), series_until     the regular solution from t = 0, where the equations of motion are singular there
//   entropy(y)                  a quantity that never decreases
//   moments(y), moment_names    quantities whose averages along the orbit are reported,
//   log_weight(y), log_rate(y)  ln of their weight in an average over the run's time τ, and ln dt/dτ of the physical
//                               time t for an average over t
//   stiffness_rate()            a rate; a run warns where a step is longer than half its inverse
//   quantities(y, t)            further columns
//   gravitational_parameter()   μ of an orbit about the origin, where p is the velocity: a run reports its elements
//   log_gradient(q, factor)     factor·∇ln|V|, where that costs less than V and ∇V
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

/// Slope is a number with its derivative along one tangent direction.
using Slope = Dual<double, 1>;
template <class X>
concept Sloped = std::is_same_v<typename X::Number, Slope>;

/// FullRunState is the state of a run that is asked for everything.
template <class P>
using FullRunState =
    std::conditional_t<CarriesSlope<P>, typename StateOf<P>::template in<Slope, double>, FullStateOf<P>>;

/// plain(x) returns the state without its tangent direction.
template <class X>
constexpr auto plain(const X& x) {
  typename X::template in<double, double> y;
  y.t = x.t;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = value_of(x[i]);
  return y;
}

/// normalise_slopes scales a tangent vector of `count` components to largest component 1 once it has become very long
/// or very short; only its direction has a meaning.
inline void normalise_slopes(double* slope, std::size_t count) {
  double size = 0;
  for (std::size_t i = 0; i < count; ++i) size = std::max(size, std::abs(slope[i]));
  if (size > 1e50 || (size > 0 && size < 1e-50))
    for (std::size_t i = 0; i < count; ++i) slope[i] /= size;
}
/// The same for a state that carries the vector as the slopes of its first `count` components.
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

/// start_of returns the state at t with the values of the card's variables. The last variable of a Sloped state is the
/// slope dv/dx; NaN stands for the direction of the flow itself.
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

/// variable returns variable i of the card at a state: `unknown` where the state does not carry it, or where the slope
/// is infinite.
template <class X>
double variable(const X& x, std::size_t i) {
  if (i < X::size) return value_of(x[i]);
  if constexpr (Sloped<X>)
    if (const double slope = x[1].slope[0] / x[0].slope[0]; std::isfinite(slope)) return slope;
  return unknown;
}

/// series_state returns the regular solution from t = 0 at a time 0 ≤ t ≤ series_until.
template <class X, HasSeries P>
X series_state(const P& problem, const typename X::Time& t) {
  X x;
  constexpr bool acting = X::size > StateOf<P>::size || StateOf<P>::acting;
  assign(x, problem.template series<typename X::Number, acting>(t));
  x.t = t;
  return x;
}
/// starts_series returns whether x lies on that solution, exactly and at a time that the series covers.
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

/// outside returns whether x lies outside the domain of the motion.
template <class P, class X>
bool outside([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
  if constexpr (HasDomain<P>) return problem.bounded() && !(problem.inside(position(x)) >= 0);
  return false;
}

/// energy_of returns the energy; at the singular start t = 0 of a series that of the series at t = 1e-9.
template <class P, class X>
double energy_of(const P& problem, const X& x) {
  if constexpr (HasSeries<P>)
    if (x.t == 0 && starts_series(problem, x)) return energy(problem, series_state<X>(problem, 1e-9));
  return energy(problem, x);
}

/// sections returns the quantities whose zeros are events.
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

// States at which the laws are examined: the default start of a problem and points of its true orbit, spread over the
// default span.
#pragma once

#include <array>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/describe.hpp"
#include "core/reference/reference.hpp"
#include "core/schemes/list.hpp"

namespace laws {

using namespace least;

/// default_start() returns the card's start, as a state with every component that the problem can carry.
template <template <class> class P>
FullStateOf<P<double>> default_start() {
  FullStateOf<P<double>> x;
  const auto variables = About<P>::card().variables;
  for (std::size_t i = 0; i < x.size; ++i) x[i] = variables.at(i).value;
  return x;
}
template <template <class> class P>
using Orbit = Extrapolation<P<double>, typename FullStateOf<P<double>>::template in<Quad, Quad>>;

template <template <class> class P>
const std::array<FullStateOf<P<double>>, 4>& states() {
  static const auto points = [] {
    std::array<FullStateOf<P<double>>, 4> all;
    const P<double> problem{};
    Orbit<P> orbit(problem, convert<Quad, Quad>(default_start<P>()), 1e-22);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!orbit.advance(Quad(About<P>::card().span * (0.15 + 0.1 * double(i))), [] { return true; })) std::abort();
      all[i] = convert<double, double>(orbit.state());
    }
    return all;
  }();
  return points;
}

template <class X>
double distance(const X& a, const X& b) {
  double most = 0;
  for (std::size_t i = 0; i < X::size; ++i) most = std::max(most, std::abs(double(a[i] - b[i])));
  return most;
}
template <class X>
double size(const X& x) {
  return std::max(1.0, distance(x, X{}));
}

/// rhythm() returns the time in which the rate of change of the motion at x changes by about its own size.
template <class P, class X>
double rhythm(const P& problem, const X& x) {
  const double ahead = 1e-6;
  const auto rate = derivative(problem, x);
  auto later = shifted(x, ahead, rate);
  later.t += ahead;
  return ahead * distance(rate, X{}) / distance(derivative(problem, later), rate);
}

/// coarse_step() returns a step that resolves the default motion, but coarsely enough for errors to be seen.
template <template <class> class P>
double coarse_step() {
  double h = std::min(About<P>::card().span / 100, 0.5);
  for (const auto& x : states<P>()) h = std::min(h, 0.7 * rhythm(P<double>{}, x));
  return h;
}

/// Calls f(scheme) for every scheme of a tuple that fits and every composition it takes.
template <template <class> class P, class Schemes = SchemeList, class F>
void for_each_scheme(F&& f) {
  const auto one = [&]<class Scheme>(Scheme*) {
    if constexpr (FixedStepSchemeFor<Scheme, P<double>>) {
      Scheme scheme;
      if constexpr (requires { scheme.composition; }) {
        for (std::size_t i = 0; i < compositions::names.size(); ++i) {
          scheme.composition = static_cast<Composition>(i);
          f(scheme);
        }
        if constexpr (requires { scheme.splitting; }) {  // the splitting that the composed schemes above did not have
          scheme.composition = Composition::suzuki_4;
          scheme.splitting = QuadraticContact<P<double>> ? Splitting::plain : Splitting::merged;
          if (!SplitFlow<P<double>>) f(scheme);
          scheme.composition = Composition::none;
          for (std::size_t i = 0; i < splitting_names.size(); ++i) {
            scheme.splitting = static_cast<Splitting>(i);
            if (LinearContact<P<double>> && alternation_of(scheme.splitting)) f(scheme);
          }
        }
      } else if constexpr (requires { scheme.stages; }) {
        for (scheme.stages = 1; scheme.stages <= 3; ++scheme.stages) f(scheme);
      } else {
        f(scheme);
      }
    }
  };
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (one(static_cast<Scheme*>(nullptr)), ...);
  }(static_cast<Schemes*>(nullptr));
}

/// label() returns text such as "leapfrog kahan_li_6".
template <class Scheme>
std::string label(const Scheme& scheme) {
  std::string text(Scheme::card().id);
  const auto add = [&](std::string_view word) { text.append(" ").append(word); };
  if constexpr (requires { scheme.composition; })
    add(compositions::names[static_cast<std::size_t>(scheme.composition)]);
  if constexpr (requires { scheme.splitting; }) add(splitting_names[static_cast<std::size_t>(scheme.splitting)]);
  if constexpr (requires { scheme.stages; }) add(std::to_string(scheme.stages));
  return text;
}
template <class Scheme>
int order(const Scheme& scheme) {
  const auto orders = Scheme::card().orders;
  if constexpr (requires { scheme.splitting; })
    if (const auto named = alternation_of(scheme.splitting)) return alternations::named[*named].order;
  if constexpr (requires { scheme.composition; }) return orders[static_cast<std::size_t>(scheme.composition)].second;
  if constexpr (requires { scheme.stages; }) return orders[static_cast<std::size_t>(scheme.stages - 1)].second;
  return orders.at(0).second;
}

}  // namespace laws

// States at which the laws are examined: the default start of a problem and points of its true orbit, spread over the
// default span.
#pragma once

#include <array>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/describe.hpp"
#include "core/schemes/list.hpp"
#include "core/study/reference.hpp"

namespace laws {

using namespace least;

template <template <class> class P>
StateOf<P<double>> default_start() {
  const ProblemCard card = About<P>::card();
  StateOf<P<double>> x;
  constexpr std::size_t n = P<double>::dof;
  for (std::size_t i = 0; i < n; ++i) {
    x.q[i] = card.variables.at(i).value;
    x.p[i] = card.variables.at(n + i).value;
  }
  return x;
}

template <template <class> class P>
const std::array<StateOf<P<double>>, 4>& states() {
  static const auto points = [] {
    std::array<StateOf<P<double>>, 4> all;
    const P<double> problem{};
    Extrapolation<P<double>> orbit(problem, convert<Quad, Quad>(default_start<P>()), 1e-22);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!orbit.advance(Quad(About<P>::card().span * (0.15 + 0.1 * double(i))), [] { return true; })) std::abort();
      all[i] = convert<double, double>(orbit.state());
    }
    return all;
  }();
  return points;
}

/// A step that resolves the default motion, coarsely enough for errors to be seen.
template <template <class> class P>
double coarse_step() {
  return std::min(About<P>::card().span / 100, 0.5);
}

/// Calls f(scheme) for every scheme that fits and every composition it takes.
template <template <class> class P, class F>
void for_each_scheme(F&& f) {
  const auto one = [&]<class Scheme>(Scheme*) {
    if constexpr (SchemeFor<Scheme, P<double>>) {
      Scheme scheme;
      if constexpr (requires { scheme.composition; }) {
        for (std::size_t i = 0; i < compositions::names.size(); ++i) {
          scheme.composition = static_cast<Composition>(i);
          f(scheme);
        }
      } else {
        f(scheme);
      }
    }
  };
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (one(static_cast<Scheme*>(nullptr)), ...);
  }(static_cast<SchemeList*>(nullptr));
}

/// "leapfrog kahan_li_6"
template <class Scheme>
std::string label(const Scheme& scheme) {
  std::string text(Scheme::card().id);
  if constexpr (requires { scheme.composition; })
    text += " " + std::string(compositions::names[static_cast<std::size_t>(scheme.composition)]);
  return text;
}
template <class Scheme>
int order(const Scheme& scheme) {
  const auto orders = Scheme::card().orders;
  if constexpr (requires { scheme.composition; }) return orders[static_cast<std::size_t>(scheme.composition)].second;
  return orders.at(0).second;
}

template <class X>
double distance(const X& a, const X& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.q.size(); ++i)
    most = std::max({most, std::abs(double(a.q[i] - b.q[i])), std::abs(double(a.p[i] - b.p[i]))});
  return most;
}
template <class X>
double size(const X& x) {
  return std::max(1.0, distance(x, X{}));
}

}  // namespace laws

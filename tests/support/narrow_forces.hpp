// Random scenes whose forces are narrow: pulses in time, bumps in space, switches in velocity, with widths from a half
// to a thousandth of the span. The true end of the motion is from a quadrature, or from fine runs of another scheme.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/support/texts.hpp"

namespace narrow {

using namespace texts;

enum class Family { pulses, bumps, switches };
inline constexpr std::array families{Family::pulses, Family::bumps, Family::switches};
inline std::string_view name(Family family) {
  return family == Family::pulses  ? "pulses in time"
         : family == Family::bumps ? "bumps in space"
                                   : "switches in velocity";
}

/// Case is a scene that any scheme that fits may run; `right` is the true value of the first variable at the end.
struct Case {
  Definition definition;
  std::array<double, 2> start;  ///< of the first variable and its momentum or rate
  double end;
  double right;
  double fine = 0;  ///< a step that is short against the narrowest force

  std::string text() const {
    return definition.formula + (definition.equations.empty() ? "" : definition.equations.back().second) + " from " +
           std::to_string(start[0]) + ", " + std::to_string(start[1]) + " to " + std::to_string(end);
  }
};

inline Request ask(const Case& one, std::string_view scheme) {
  Request request = typed_as(runs::defaults("harmonic_oscillator", scheme), mechanics_of(one.definition));
  begin_at(request, one.start);
  runs::scene(request).start = 0;
  request.end = one.end;
  request.limits.seconds = 20;
  runs::only_final(request);
  return request;
}

/// Shape is a function of width w about a, as text and as C++.
struct Shape {
  std::string text;
  std::function<double(double)> at;
};
inline std::string text_of(double x) { return "(" + std::to_string(x) + ")"; }
/// rounded() returns x with as many digits as text_of() writes.
inline double rounded(double x) { return std::stod(std::to_string(x)); }
inline Shape shape(std::mt19937& random, std::string variable, double a, double w) {
  const std::string z = "((" + variable + "-" + text_of(a) + ")/" + text_of(w) + ")";
  const auto u = [a, w](double x) { return (x - a) / w; };
  switch (random() % 6) {
    case 0:
      return {"exp(-" + z + "^2)", [u](double x) { return std::exp(-u(x) * u(x)); }};
    case 1:
      return {"exp(-" + z + "^2)*cos(3*" + variable + ")",
              [u](double x) { return std::exp(-u(x) * u(x)) * std::cos(3 * x); }};
    case 2:
      return {"1/cosh(" + z + ")^2",
              [u](double x) { return std::pow(std::cosh(std::min(300.0, std::abs(u(x)))), -2); }};
    case 3:
      return {"exp(-" + z + "^4)", [u](double x) { return std::exp(-std::pow(u(x), 4)); }};
    case 4:
      return {"tanh(" + z + ")", [u](double x) { return std::tanh(u(x)); }};
    default:
      return {"(1-tanh(" + z + ")^2)", [u](double x) { return 1 - std::pow(std::tanh(u(x)), 2); }};
  }
}

/// integral() returns ∫ f dt from 0 to `end` by Gauss's formula of five points in panels that are short near a.
inline double integral(const std::function<double(double)>& f, double end, double a, double w) {
  constexpr double node[] = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  for (double t = 0; t < end;) {
    const double away = std::abs(t - a), panel = std::min({0.05, std::max(w / 4, (away - 20 * w) / 4), end - t});
    const double middle = t + panel / 2;
    double here = weight[0] * f(middle);
    for (int i = 1; i < 3; ++i) here += weight[i] * (f(middle - node[i] * panel / 2) + f(middle + node[i] * panel / 2));
    sum += here * panel / 2;
    t += panel;
  }
  return sum;
}

/// pulse() draws ẍ = −x or ẍ = 0 with a pulse in time as a force; its end is known from a quadrature.
inline Case pulse(std::mt19937& random) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const double end = rounded(between(5, 40)), w = rounded(end * std::pow(10, between(-3, -0.3)));
  const double a = rounded(between(0, end)), strength = rounded(between(0.1, 3) / std::min(1.0, std::max(w, 0.05)));
  const Shape g = shape(random, "t", a, w);
  const bool bound = random() % 2 == 0;
  const double x0 = random() % 2 == 0 ? 0 : rounded(between(-2, 2)),
               p0 = random() % 2 == 0 ? 0 : rounded(between(-1, 1));
  const double pushed =
      integral([&](double t) { return strength * g.at(t) * (bound ? std::sin(end - t) : end - t); }, end, a, w);
  return {of(Definition::Kind::lagrangian, {"x"}, {},
             std::string("vx^2/2") + (bound ? "-x^2/2" : "") + "+x*" + text_of(strength) + "*" + g.text),
          {x0, p0},
          end,
          pushed + (bound ? x0 * std::cos(end) + p0 * std::sin(end) : x0 + p0 * end)};
}
/// bump() draws a free or bound particle that meets a narrow bump, well or step of the potential.
inline Case bump(std::mt19937& random) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const bool bound = random() % 2 == 0;
  const double end = rounded(between(5, 40)), w = rounded((bound ? 3 : 20) * std::pow(10, between(-3, -0.5)));
  const double x0 = rounded(between(-2, 2)), p0 = rounded(between(0.3, 2));
  const double a = rounded(bound ? between(-2, 2) : x0 + p0 * end * between(0.05, 0.7));
  const double height = rounded(0.5 * p0 * p0 * std::pow(10, between(-1, 1)) * (random() % 2 == 0 ? 1 : -1));
  return {of(Definition::Kind::hamiltonian, {"x"}, {},
             std::string("px^2/2+") + (bound ? "x^2/2+" : "") + text_of(height) + "*" + shape(random, "x", a, w).text),
          {x0, p0},
          end,
          0,
          std::clamp(w / (5 * std::sqrt(p0 * p0 + x0 * x0 + 2 * std::abs(height))), 4e-4, 0.02)};
}
/// velocity_switch() draws an oscillator with friction that changes within a narrow range of velocities.
inline Case velocity_switch(std::mt19937& random) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const double steepness = std::pow(10, between(0, 2.7));
  const std::string k = text_of(steepness), c = text_of(between(0.05, 1));
  const std::string friction = random() % 2 == 0   ? "tanh(" + k + "*v)"
                               : random() % 2 == 0 ? "v*exp(-(" + k + "*v)^2)"
                                                   : "v/cosh(" + k + "*(v-0.3))^2";
  return {flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-x-" + c + "*" + friction}}),
          {rounded(between(0.5, 3)), rounded(between(-1, 1))},
          rounded(between(5, 30)),
          0,
          std::min(0.1 / steepness, 2e-3)};
}

/// fine_end() returns the first variable at the end by runs of equal steps; NaN where two step lengths do not agree
/// within 1e-9.
inline double fine_end(const Case& one, std::string_view scheme, double step) {
  const auto end = [&](double h) {
    Request request = ask(one, scheme);
    runs::set(request, "step", h);
    if (scheme == "leapfrog") runs::set(request, "composition", "kahan_li_8");
    request.limits.steps = 10'000'000;
    return runs::go(request).outcome.final.at(0);
  };
  const double coarse = end(step), fine = end(step / 2.2);
  return std::abs(fine - coarse) < 1e-9 * std::max(1.0, std::abs(fine)) ? fine : std::nan("");
}

/// draw() returns up to `count` cases of a family; it leaves out those whose end the fine runs cannot tell.
inline std::vector<Case> draw(Family family, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Case> all;
  for (int tries = 0; tries < 2 * count && static_cast<int>(all.size()) < count; ++tries) {
    Case one = family == Family::pulses  ? pulse(random)
               : family == Family::bumps ? bump(random)
                                         : velocity_switch(random);
    if (family == Family::bumps) one.right = fine_end(one, "leapfrog", one.fine);
    if (family == Family::switches) one.right = fine_end(one, "runge_kutta_4", one.fine);
    if (!std::isnan(one.right)) all.push_back(std::move(one));
  }
  return all;
}

/// error_of() returns the error of the first variable at the end, relative to max(1, |x|); NaN where the run did not
/// complete.
inline double error_of(const Case& one, const Solution& outcome) {
  if (outcome.stop.reason != ReturnCode::completed) return std::nan("");
  return std::abs(outcome.final.at(0) - one.right) / std::max(1.0, std::abs(one.right));
}

/// Count says how many runs are wrong (off by more than 1e4 tolerances), and whether their warnings say so.
struct Count {
  int runs = 0, wrong = 0, silent = 0, alarmed = 0;  ///< silent: wrong without a warning; alarmed: right with one
  std::string first_wrong;
};
inline Count count_of(const std::vector<Case>& cases, std::string_view scheme) {
  Count found;
  for (const Case& one : cases) {
    Request request = ask(one, scheme);
    request.control = true;
    const Solution outcome = runs::go(request).outcome;
    const double error = error_of(one, outcome);
    const bool wrong = !(error <= 1e4 * request.settings.at(0)), warned = !outcome.warnings.empty();
    ++found.runs;
    found.wrong += wrong;
    found.silent += wrong && !warned && outcome.stop.reason == ReturnCode::completed;
    found.alarmed += !wrong && warned;
    if (wrong && found.first_wrong.empty())
      found.first_wrong = one.text() + ": " + std::to_string(error) + outcome.stop.detail.text();
  }
  return found;
}

}  // namespace narrow

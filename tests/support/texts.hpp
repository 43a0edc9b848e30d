// Problems of the catalogue typed as text, and requests for them.
#pragma once

#include <algorithm>
#include <span>

#include "core/catalogue/custom.hpp"
#include "tests/support/runs.hpp"

namespace texts {

using namespace least;
using text::Definition;

struct Typed {
  const char* id;  ///< of the problem in the catalogue
  Definition definition;
  /// `definition.parameters` has the parameters of the catalogue's problem in its order, under the names of the text.
};
inline std::string name_of(const Typed& typed) {
  constexpr const char* kinds[] = {"lagrangian", "hamiltonian", "potential", "equations"};
  return std::string(typed.id) + "_" + kinds[std::size_t(typed.definition.kind)];
}

inline Definition of(Definition::Kind kind, std::vector<std::string> variables,
                     std::vector<std::pair<std::string, double>> parameters, std::string formula) {
  Definition d;
  d.kind = kind;
  d.variables = std::move(variables);
  d.parameters = std::move(parameters);
  d.formula = std::move(formula);
  return d;
}
inline Definition damped(Definition d, std::string alpha) {
  d.damping = std::move(alpha);
  return d;
}
inline Definition quadratic(Definition d, std::string gamma, std::string offset) {
  d.action_curvature = std::move(gamma);
  d.offset = std::move(offset);
  return d;
}
inline Definition flow(std::vector<std::string> variables, std::vector<std::pair<std::string, double>> parameters,
                       Definition::Named equations) {
  Definition d = of(Definition::Kind::equations, std::move(variables), std::move(parameters), "");
  d.equations = std::move(equations);
  return d;
}

/// all() returns every way of writing the problems as text, problem by problem.
inline std::vector<Typed> all() {
  constexpr auto L = Definition::Kind::lagrangian, H = Definition::Kind::hamiltonian, V = Definition::Kind::potential;
  const double pi = 3.141592653589793;
  return {
      {"kepler", of(L, {"x", "y"}, {{"mu", 1}}, "(vx^2 + vy^2)/2 + mu/sqrt(x^2 + y^2)")},
      {"kepler", of(H, {"x", "y"}, {{"mu", 1}}, "(px^2 + py^2)/2 - mu/sqrt(x^2 + y^2)")},
      {"kepler", of(V, {"x", "y"}, {{"mu", 1}}, "-mu/sqrt(x^2 + y^2)")},
      {"kepler_3d", of(L, {"x", "y", "z"}, {{"mu", 1}}, "(vx^2 + vy^2 + vz^2)/2 + mu/sqrt(x^2 + y^2 + z^2)")},
      {"pendulum", of(V, {"q"}, {{"g", 1}, {"l", 1}}, "-g/l*cos(q)")},
      {"harmonic_oscillator", of(H, {"q"}, {{"m", 1}, {"k", 1}}, "p^2/(2*m) + k*q^2/2")},
      {"henon_heiles", of(L, {"x", "y"}, {{"lambda", 1}}, "(vx^2 + vy^2)/2 - (x^2 + y^2)/2 - lambda*y*(x^2 - y^2/3)")},
      {"henon_heiles", of(H, {"x", "y"}, {{"lambda", 1}}, "(px^2 + py^2 + x^2 + y^2)/2 + lambda*y*(x^2 - y^2/3)")},
      {"damped_oscillator", of(L, {"q"}, {{"k", 1}, {"alpha", 0.1}}, "v^2/2 - k*q^2/2 - alpha*s")},
      {"damped_oscillator", of(H, {"q"}, {{"k", 1}, {"alpha", 0.1}}, "p^2/2 + k*q^2/2 + alpha*s")},
      {"damped_oscillator", damped(of(V, {"q"}, {{"k", 1}, {"alpha", 0.1}}, "k*q^2/2"), "alpha")},
      {"perturbed_kepler", of(L, {"x", "y"}, {{"gamma", -1}, {"alpha", 0.01}, {"omega", pi}},
                              "(vx^2 + vy^2)/2 - gamma/sqrt(x^2 + y^2) - alpha*sin(omega*t)*s")},
      {"perturbed_kepler", of(H, {"x", "y"}, {{"gamma", -1}, {"alpha", 0.01}, {"omega", pi}},
                              "(px^2 + py^2)/2 + gamma/sqrt(x^2 + y^2) + alpha*sin(omega*t)*s")},
      {"driven_oscillator", of(L, {"q"}, {{"k", 1}, {"alpha", 0.1}, {"a", 0.3}, {"w", pi / 3}, {"phase", -pi / 2}},
                               "v^2/2 - k*q^2/2 + a*cos(w*t + phase)*q - alpha*s")},
      {"driven_oscillator", of(H, {"q"}, {{"k", 1}, {"alpha", 0.1}, {"a", 0.3}, {"w", pi / 3}, {"phase", -pi / 2}},
                               "p^2/2 + k*q^2/2 - a*cos(w*t + phase)*q + alpha*s")},
      {"cosmological_oscillator", of(L, {"q"}, {{"gamma", 1}, {"r", 1}}, "v^2/2 - q^2/2 - gamma*s^2/2 + r")},
      {"cosmological_oscillator", of(H, {"q"}, {{"gamma", 1}, {"r", 1}}, "p^2/2 + q^2/2 + gamma*s^2/2 - r")},
      {"cosmological_oscillator", quadratic(of(V, {"q"}, {{"gamma", 1}, {"r", 1}}, "q^2/2"), "gamma", "r")},
      {"double_pendulum",
       of(L, {"theta1", "theta2"}, {{"m1", 1}, {"m2", 1}, {"l1", 1}, {"l2", 1}, {"g", 1}},
          "(m1 + m2)*l1^2*vtheta1^2/2 + m2*l2^2*vtheta2^2/2 + m2*l1*l2*cos(theta1 - theta2)*vtheta1*vtheta2"
          " + (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2)")},
      {"van_der_pol", flow({"x", "v"}, {{"epsilon", 1}, {"a", 0}, {"w", 1}},
                           {{"x", "v"}, {"v", "epsilon*(1 - x^2)*v - x + a*cos(w*t)"}})},
  };
}

/// mechanics_of() returns the mechanics of a definition; it throws where the definition has a fault.
inline std::shared_ptr<const Mechanics> mechanics_of(const Definition& definition) {
  auto made = custom_mechanics(definition);
  if (const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made))
    throw std::invalid_argument(faults->front().pointer + " " + faults->front().fault.detail);
  return std::get<std::shared_ptr<const Mechanics>>(made);
}

/// typed_as() returns the request with its scene replaced by typed mechanics, which begins at the same start.
inline Request typed_as(const Request& compiled, std::shared_ptr<const Mechanics> mechanics) {
  Request request = compiled;
  const ProblemCard &from = runs::card(compiled), &to = mechanics->card();
  Scene scene{mechanics, {}, {}, compiled.scene->start};
  for (const auto& parameter : to.parameters) scene.parameters.push_back(parameter.value);
  std::size_t next = 0;
  for (const auto& variable : to.variables)
    scene.initial.push_back(variable.hidden || next >= from.variables.size() ? 0 : compiled.scene->initial[next++]);
  request.scene = std::make_shared<const Scene>(std::move(scene));
  request.columns = {0};
  request.diagnostics.clear();
  return request;
}
/// begin_at() sets the start to these values of the variables that are not hidden, in their order; the rest are 0.
inline void begin_at(Request& request, std::span<const double> start) {
  auto& initial = runs::scene(request).initial;
  std::ranges::fill(initial, 0);
  const auto& variables = runs::card(request).variables;
  for (std::size_t i = 0, next = 0; i < variables.size() && next < start.size(); ++i)
    if (!variables[i].hidden) initial[i] = start[next++];
}

/// request_by() requests a run by a scheme with the defaults of its card, to the time `end`; only the final state is
/// kept.
inline Request request_by(std::string_view scheme, std::shared_ptr<const Mechanics> mechanics,
                          std::span<const double> start, double end) {
  Request request = typed_as(runs::defaults("kepler", "runge_kutta_4"), std::move(mechanics));
  request.scheme = find_scheme(scheme).value();
  request.settings.clear();
  for (const auto& setting : schemes()[request.scheme].parameters) request.settings.push_back(setting.value);
  begin_at(request, start);
  request.end = end;
  runs::only_final(request);
  return request;
}
/// final_of() returns the variables that are not hidden at the end of a run; it throws where the run does not complete.
inline std::vector<double> final_of(const Request& request) {
  const auto outcome = runs::go(request).outcome;
  if (outcome.stop.reason != ReturnCode::completed) throw std::runtime_error(outcome.stop.detail.text());
  std::vector<double> shown;
  for (std::size_t i = 0; i < runs::card(request).variables.size(); ++i)
    if (!runs::card(request).variables[i].hidden) shown.push_back(outcome.final[i]);
  return shown;
}

}  // namespace texts

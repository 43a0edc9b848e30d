// Scenes with terms that are linear in the momenta, or not linear in s, for lifted_splitting.
#pragma once

#include "tests/support/steps_of_text.hpp"

namespace lifted {

using namespace texts;
inline constexpr auto lagrangian = Definition::Kind::lagrangian, hamiltonian = Definition::Kind::hamiltonian;

struct Scene {
  const char* name;
  Definition definition;
  std::vector<double> start;  ///< q, p, and s where the equations of motion depend on it
  bool exact = false;         ///< the lifted motion is linear
};

/// restricted_three_bodies() is the restricted three-body problem in the frame that turns with the primaries, whose
/// masses are 1 − mu and mu.
inline Definition restricted_three_bodies() {
  return of(hamiltonian, {"x", "y"}, {{"mu", 0.012277471}},
            "(px^2 + py^2)/2 + y*px - x*py - (1-mu)/sqrt((x+mu)^2 + y^2) - mu/sqrt((x-1+mu)^2 + y^2)");
}
/// The same in space, with a mass ratio that has a row in Howell's table of halo orbits.
inline Definition restricted_three_bodies_in_space() {
  return of(hamiltonian, {"x", "y", "z"}, {{"mu", 0.04}},
            "(px^2 + py^2 + pz^2)/2 + y*px - x*py - (1-mu)/sqrt((x+mu)^2 + y^2 + z^2)"
            " - mu/sqrt((x-1+mu)^2 + y^2 + z^2)");
}
/// A charge in the field of a magnetic dipole m along z, given by its vector potential.
inline Definition charge_in_a_dipole() {
  return of(lagrangian, {"x", "y", "z"}, {{"m", 1}}, "(vx^2 + vy^2 + vz^2)/2 + m*(x*vy - y*vx)/(x^2 + y^2 + z^2)^1.5");
}
/// A charge in a uniform magnetic field b along z, with a potential in the plane.
inline Definition charge_in_a_uniform_field() {
  return of(hamiltonian, {"x", "y"}, {{"b", 2}, {"e", 0.1}}, "((px + b*y/2)^2 + (py - b*x/2)^2)/2 - e*x + x^4/20");
}
inline Definition foucaults_pendulum() {
  return of(lagrangian, {"x", "y"}, {{"omega", 0.3}, {"w", 1}},
            "(vx^2 + vy^2)/2 + omega*(x*vy - y*vx) - w^2*(x^2 + y^2)/2 + (x^2 + y^2)^2/24");
}
/// Friction that is neither linear in s nor the same everywhere.
inline Definition contact_prototype() {
  return of(hamiltonian, {"q"}, {}, "p^2/2 + 1 - cos(q) + 0.3*p*s*sin(q) + 0.2*s + 0.1*s^2*cos(q)");
}
/// A kinetic matrix that is not diagonal, a rotating frame, damping that depends on x, and a drive.
inline Definition driven() {
  return of(hamiltonian, {"x", "y"}, {{"c", 0.2}},
            "px^2/2 + py^2 + px*py/3 + (x^2 + y^2)/2 + 0.3*(y*px - x*py)*cos(t) + c*s*(1 + x^2/5) - 0.1*x*sin(2*t)");
}
/// A frame that turns and is shaken: its lifted motion is linear, but with coefficients that depend on time.
inline Definition shaken_frame() {
  return of(hamiltonian, {"x", "y"}, {{"omega", 0.5}},
            "(px^2 + py^2)/2 + omega*(y*px - x*py) + 0.4*px*cos(2*t) + x^4/4 + y^2/2");
}
/// Van der Pol's oscillator as H = p·X(q), which is ẋ = X(q): there is no other part to split off.
inline Definition van_der_pol() {
  return of(hamiltonian, {"x", "v"}, {{"epsilon", 1}}, "px*v + pv*(epsilon*(1 - x^2)*v - x)");
}

inline std::vector<Scene> scenes() {
  return {{"restricted_three_bodies", restricted_three_bodies(), {0.5, 0, 0, 1.2}, true},
          {"charge_in_a_dipole", charge_in_a_dipole(), {1, 0, 0.1, 0.1, 1.2, 0.2}},
          {"charge_in_a_uniform_field", charge_in_a_uniform_field(), {1, 0.3, 0.2, 0.5}, true},
          {"foucaults_pendulum", foucaults_pendulum(), {1, 0, 0, 0.2}, true},
          {"contact_prototype", contact_prototype(), {1, 0.5, 0.2}},
          {"driven", driven(), {0.8, -0.3, 0.2, 0.4, 0.1}},
          {"shaken_frame", shaken_frame(), {0.8, -0.3, 0.2, 0.4}},
          {"van_der_pol", van_der_pol(), {1, 0.2, 0.3, 0.2}}};
}

/// request_of() requests steps of one length from the scene's start to the time `end`; only the final state is kept.
inline Request request_of(const Scene& scene, const std::shared_ptr<const Mechanics>& mechanics, double step,
                          double end, const char* scheme = "lifted_splitting") {
  Request request = typed_as(runs::defaults("damped_oscillator", scheme), mechanics);
  begin_at(request, scene.start);
  request.end = end;
  if (schemes()[request.scheme].find("step")) runs::set(request, "step", step);
  runs::only_final(request);
  return request;
}
inline Request composed(Request request, const char* composition, const char* lift = "automatic") {
  runs::set(request, "composition", composition);
  runs::set(request, "lift", lift);
  return request;
}
/// end_of() returns the final state without hidden variables; it throws where the run does not complete.
inline std::vector<double> end_of(const Request& request) {
  const auto outcome = runs::go(request).outcome;
  if (outcome.stop.reason != ReturnCode::completed) throw std::runtime_error(outcome.stop.detail.text());
  std::vector<double> all;
  const auto& variables = runs::card(request).variables;
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (!variables[i].hidden) all.push_back(outcome.final[i]);
  return all;
}

}  // namespace lifted

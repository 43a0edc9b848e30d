// Charges in magnetic fields, and rotating frames, as text.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/steps_of_text.hpp"

namespace magnetic {

using namespace texts;
inline constexpr auto lagrangian = Definition::Kind::lagrangian, hamiltonian = Definition::Kind::hamiltonian;

struct Scene {
  const char* name;
  Definition definition;
  std::vector<double> start;  ///< q, p
  double step;                ///< a step at which the errors show order 2
};

/// A charge in the field of a dipole and of a uniform field along its axis.
inline Definition bottle() {
  return of(lagrangian, {"x", "y", "z"}, {{"M", 1}, {"B", 1}},
            "(vx^2 + vy^2 + vz^2)/2 + (x*vy - y*vx)*(M/(x^2+y^2+z^2)^1.5 + B/2)");
}
/// A field that changes along x, two different masses and a potential, as a Hamiltonian whose squares are multiplied
/// out.
inline Definition plane() {
  return of(hamiltonian, {"x", "y"}, {{"m", 2}, {"b", 1.5}},
            "px^2/(2*m) + py^2/(2*(m+1)) - py*(b*x + x^3/5)/(m+1) + (b*x + x^3/5)^2/(2*(m+1)) + x^2/3 + cos(y)");
}
/// Three charges of different masses in space: nine coordinates, more than any compiled class has.
inline Definition three() {
  Definition d = of(lagrangian, {}, {{"b", 0.8}}, "");
  const char* masses[] = {"1", "2", "1.5"};
  for (const std::string axis : {"x", "y", "z"})
    for (const std::string i : {"1", "2", "3"}) d.variables.push_back(axis + i);
  for (int k = 0; k < 3; ++k) {
    const std::string i = std::to_string(k + 1), m = masses[k];
    d.formula += std::string(k ? " + " : "") + m + "*(vx" + i + "^2 + vy" + i + "^2 + vz" + i + "^2)/2 + b*(1 + z" + i +
                 "^2/4)*(x" + i + "*vy" + i + " - y" + i + "*vx" + i + ") + x" + i + "*vz" + i + "/3";
  }
  d.formula +=
      " - 1/sqrt((x1-x2)^2+(y1-y2)^2+(z1-z2)^2) - 1/sqrt((x1-x3)^2+(y1-y3)^2+(z1-z3)^2)"
      " - 1/sqrt((x2-x3)^2+(y2-y3)^2+(z2-z3)^2)";
  return d;
}
/// A frame that turns, and a drive.
inline Definition driven_frame() {
  return of(hamiltonian, {"x", "y"}, {{"omega", 0.7}},
            "(px^2 + py^2)/2 + omega*(y*px - x*py) + x^4/4 + y^2/2 + 0.3*x*cos(2*t)");
}

inline std::vector<Scene> scenes() {
  return {{"bottle", bottle(), {1.5, 0, 0.1, 0, 1.2, 0.2}, 0.1},
          {"plane", plane(), {0.5, 0.2, 0.6, 0.1}, 0.1},
          {"three", three(), {0, 2, -1, 0, 0.3, 2, 0, 0.1, 0.2, 0.2, 0.5, -0.3, 0, 1, 0.4, 0.1, 0, 0.2}, 0.05},
          {"driven_frame", driven_frame(), {0.8, -0.3, 0.2, 0.4}, 0.1}};
}

inline Request request_of(const Scene& scene, std::string_view scheme, double step, double end) {
  Request request = request_by(scheme, mechanics_of(scene.definition), scene.start, end);
  if (schemes()[request.scheme].find("step")) runs::set(request, "step", step);
  return request;
}

inline constexpr double end_of_orders = 3;  ///< the time at which the errors are taken that show an order

/// true_end() returns the state at end_of_orders, from Taylor series to round-off.
inline std::vector<double> true_end(const Scene& scene) {
  Request truth = request_of(scene, "taylor", 0, end_of_orders);
  runs::set(truth, "tolerance", 1e-16);
  return final_of(truth);
}

struct Steps {
  double longest, shortest;
};

/// observed_order() returns the order that errors against the true end show as steps are halved: that of the last two
/// errors of which the first is below 1e-3 and the second above round-off, NaN where there are no such two. Steps with
/// which a run does not complete are too long.
inline double observed_order(const Scene& scene, const std::vector<double>& truth, std::string_view scheme,
                             std::string_view composition, Steps steps) {
  constexpr double small = 1e-3, round_off = 1e-11;
  double seen = unknown, before = 1;
  for (double step = steps.longest; step > steps.shortest && before > round_off; step /= 2) {
    Request request = request_of(scene, scheme, step, end_of_orders);
    runs::set(request, "composition", composition);
    double error = 0;
    try {
      error = distance(final_of(request), truth);
    } catch (const std::runtime_error&) {
      continue;
    }
    if (before < small && error > round_off) seen = std::log2(before / error);
    before = error;
  }
  return seen;
}

}  // namespace magnetic

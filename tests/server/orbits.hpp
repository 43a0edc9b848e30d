// Requests for closed orbits.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "tests/server/fixture.hpp"

namespace least::server::test {

class AskingForOrbits : public Asking {
 protected:
  static constexpr double pi = std::numbers::pi;

  static Json orbit(const Json& request) { return answer(request, "/v1/periodic"); }
  /// others() returns the multipliers after the first `trivial` ones, which time, invariants and symmetries explain.
  static std::vector<std::complex<double>> others(const Json& made, std::size_t trivial) {
    std::vector<std::complex<double>> all;
    const Json& multipliers = made["multipliers"];
    for (std::size_t i = trivial; i < multipliers.size(); ++i)
      all.emplace_back(multipliers[i]["re"], multipliers[i]["im"]);
    return all;
  }
  static std::vector<std::complex<double>> others(const Json& made) { return others(made, made["trivial"]); }
  /// after() returns the final state of a run by Taylor series from the start in an answer until the time `until`.
  static Json after(const Json& problem, const Json& initial, double until) {
    Json start = initial;
    for (auto it = start.begin(); it != start.end();) it = it->is_null() ? start.erase(it) : std::next(it);
    return answer({{"problem", problem},
                   {"initial", start},
                   {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                   {"until", until},
                   {"record", {{"every", 0}}},
                   {"diagnostics", Json::array()}})["final"];
  }
  static double distance(const Json& a, const Json& b, const Json& rows) {
    double sum = 0;
    for (const auto& row : rows) {
      const std::string name = row;
      sum += std::pow(a[name].get<double>() - b[name].get<double>(), 2);
    }
    return std::sqrt(sum);
  }

  static Json pendulum() { return custom(R"~({"variables": ["a"], "lagrangian": "va^2/2 + cos(a)"})~"); }
  /// restricted() is the restricted three-body problem in the rotating frame, in the plane ("xy") or in space.
  static Json restricted(const char* variables, double mu) {
    Json problem = custom(R"~({"definitions": {"r1": "sqrt((x+mu)^2+y^2+z^2)", "r2": "sqrt((x-1+mu)^2+y^2+z^2)"},
        "hamiltonian": "(px^2+py^2+pz^2)/2 + y*px - x*py - (1-mu)/r1 - mu/r2"})~");
    if (std::string(variables) == "xy")
      problem.update(Json::parse(R"~({"definitions": {"r1": "sqrt((x+mu)^2+y^2)", "r2": "sqrt((x-1+mu)^2+y^2)"},
          "hamiltonian": "(px^2+py^2)/2 + y*px - x*py - (1-mu)/r1 - mu/r2"})~"));
    problem["variables"] = variables == std::string("xy") ? Json({"x", "y"}) : Json({"x", "y", "z"});
    problem["parameters"] = {{"mu", mu}};
    return problem;
  }
};

}  // namespace least::server::test

// Forced scenes typed as text, and their runs.
#pragma once

#include <string>
#include <vector>

#include "tests/support/texts.hpp"

namespace forced {

using namespace texts;

constexpr auto typed_l = Definition::Kind::lagrangian, typed_h = Definition::Kind::hamiltonian,
               typed_v = Definition::Kind::potential;

inline Definition with(Definition d, Definition::Named forces, std::string dissipation = "") {
  d.forces = std::move(forces);
  if (!dissipation.empty()) d.dissipation = std::move(dissipation);
  return d;
}

/// Two pendulums of unit masses and lengths, g = 1, with friction c in the joint between them.
inline Definition double_pendulum() {
  return with(of(typed_l, {"a", "b"}, {{"c", 0.2}}, "va^2 + vb^2/2 + cos(a - b)*va*vb + 2*cos(a) + cos(b)"), {},
              "c*(vb - va)^2/2");
}

/// asked() requests a run from `start`, coordinates and then momenta, that keeps only its final state.
inline Request asked(const std::shared_ptr<const Mechanics>& mechanics, std::string_view scheme,
                     std::vector<double> start, double end) {
  Request request = typed_as(runs::defaults("kepler", scheme), mechanics);
  begin_at(request, start);
  runs::only_final(request);
  request.end = end;
  return request;
}
inline Request asked(const Definition& definition, std::string_view scheme, std::vector<double> start, double end) {
  return asked(mechanics_of(definition), scheme, std::move(start), end);
}

struct End {
  std::vector<double> state;
  double work = 0, balance = 0, final_energy = 0, initial_energy = 0;
};
inline End run(Request request) {
  runs::ask(request, "energy");
  const auto outcome = runs::go(request).outcome;
  if (outcome.stop.reason != ReturnCode::completed) throw std::runtime_error(outcome.stop.detail.text());
  const auto& said = outcome.diagnostics;
  return {outcome.final, runs::number(said, "energy/work"), runs::number(said, "energy/max_abs_error"),
          runs::number(said, "energy/final"), runs::number(said, "energy/initial")};
}
/// run() makes the run with steps of this length, and with the composition where it is not empty.
inline End run(Request request, double step, std::string_view composition) {
  runs::set(request, "step", step);
  if (!composition.empty()) runs::set(request, "composition", composition);
  return run(std::move(request));
}

}  // namespace forced

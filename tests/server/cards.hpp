// Cards with a parameter of every kind, for the decoder and the encoder.
#pragma once

#include <cmath>

#include "core/run/backend.hpp"
#include "server/shared/cards.hpp"

namespace least::server::test {

/// Described is a mechanics that consists of its cards only and cannot run.
class Described final : public Mechanics {
 public:
  Described(ProblemCard card, std::span<const SchemeCard> schemes) : card_(std::move(card)), schemes_(schemes) {}
  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return card_.id; }
  std::span<const SchemeCard> schemes() const override { return schemes_; }
  Solution run(const Request&, RowSink&, const std::atomic<bool>&) const override { return {}; }
  std::unique_ptr<const RunBackend> backend(const Request&) const override { return nullptr; }
  std::optional<RegularStart> regular_start(std::span<const double>, double) const override { return {}; }
  Truth truth(const Scene&, const std::vector<double>&, const KeepGoing&) const override { return {}; }
  Conditioning conditioning(const Scene&, double, const KeepGoing&) const override { return {}; }
  std::vector<PaceMark> pace(const Scene&, double, const KeepGoing&) const override { return {}; }
  double blow_up_time(const Scene&, double, double, const KeepGoing&) const override { return 0; }

 private:
  ProblemCard card_;
  std::span<const SchemeCard> schemes_;
};

inline Cards cards() {
  static const std::vector<SchemeCard> schemes = [] {
    const ParameterCard step{"step", "h", "s", "", Kind::number, 0.25, {0, 1e3, true, false}, {}, "step"};
    SchemeCard leapfrog;
    leapfrog.id = "leapfrog";
    leapfrog.orders = {{"none", 2}, {"yoshida_4", 4}};
    leapfrog.parameters = {step, {"composition", "", "", "", Kind::choice, 0, {0, 1}, {"none", "yoshida_4"}}};
    leapfrog.needs = "a separable Hamiltonian";
    SchemeCard field;
    field.id = "runge_kutta_4";
    field.orders = {{"", 4}};
    field.parameters = {step};
    field.needs = "a vector field";
    SchemeCard clock;
    clock.id = "own_clock";
    clock.orders = {{"", 2}};
    clock.parameters = {{"keep", "", "", "", Kind::flag, 1, {0, 1}},
                        {"critical", "", "", "", Kind::number, 2, {0, 9}, {}, "critical", true},
                        {"stages", "", "", "", Kind::integer, 2, {1, 8}, {}, {}, true},
                        {"kappa", "", "", "", Kind::number, 1, {0, 9, true}, {}, "kappa", true, "energy"},
                        step};
    clock.presets = {{"paper", "As published.", {{"critical", std::nan("")}, {"stages", 4}}},
                     {"kepler", "Exact orbits.", {{"kappa", std::nan("")}, {"keep", 0}}}};
    clock.own_clock = true;
    clock.conflicts = [](std::span<const double> settings, const ProblemCard& problem) {
      std::vector<Conflict> conflicts;
      if (settings[0] != 0 && settings[2] == 8)
        conflicts.push_back({"stages", "eight do not go with keep on " + problem.id, "[1, 7]"});
      return conflicts;
    };
    clock.needs = "a potential";
    return std::vector{leapfrog, field, clock};
  }();
  static const std::vector<std::shared_ptr<const Mechanics>> problems = [] {
    ProblemCard swing;
    swing.id = "swing";
    swing.variables = {{"q", "q", "m", "", 1}, {"p", "p", "", "", 0}};
    swing.parameters = {{"mass", "m", "kg", "", Kind::number, 1, {0, 1e3, true, false}},
                        {"level", "n", "", "", Kind::integer, 3, {0, 20}}};
    swing.span = 20;
    swing.suggested = {{"step", 0.1}, {"critical", 0.5}, {"kappa", std::nan("")}};
    swing.presets = {{"heavy", "", {{"mass", 10}}, {{"q", 2}, {"t", 5}}},
                     {"light", "", {}, {}, {{"critical", 0.25}, {"step", std::nan("")}}}};
    swing.columns = {{"t", true},
                     {"q", true},
                     {"p", true},
                     {"energy"},
                     {"mode", false, false, true, {"hamilton", "jacobi_maupertuis"}},
                     {"parameter", false, false, true, {"q", "p"}}};
    swing.diagnostics = {{"energy", "", true}, {"error", ""}};
    swing.schemes = {0, 1, 2};
    swing.offers = "a potential";
    ProblemCard flow = swing;
    flow.id = "flow";
    flow.presets.clear();
    flow.schemes = {1};
    flow.offers = "a vector field";
    return std::vector<std::shared_ptr<const Mechanics>>{std::make_shared<Described>(swing, schemes),
                                                         std::make_shared<Described>(flow, schemes)};
  }();
  return {problems, schemes};
}

}  // namespace least::server::test

// A problem with its parameters as a table of functions on plain numbers: the code of a run around its steps is
// compiled once for all problems and calls these. Each entry is the function of the same name of core/problem.hpp,
// core/problem_traits.hpp or core/equations.hpp; core/run/problem_entries.hpp makes the table of a problem.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/run_state.hpp"

namespace least {

/// ProblemTraits are the properties of a problem, and of the states of its runs, that do not depend on a run.
struct ProblemTraits {
  std::size_t components = 0;  ///< number of components of a state
  std::size_t numbers = 0;     ///< number of components with those of a tangent direction
  std::size_t moving = 0;      ///< number of components that the motion needs, the first ones
  std::size_t dof = 0;         ///< 0 for a flow
  bool acting = false;         ///< the state carries s
  bool forced = false;  ///< there are forces beside the mechanics, and their work is the last component of a state
  bool sloped = false;  ///< the state carries a tangent direction
  bool full = false;    ///< the state carries everything that can be asked for
  // Which mechanics it is, by the concepts of core/problem.hpp.
  bool flow = false, potential = false, general = false, general_lagrangian = false, conservative = false;
  bool configuration_metric = false, split_flow = false;
  bool contact = false, linear_contact = false, quadratic_contact = false;
  bool constant_damping = false, autonomous = false;
  bool has_energy = false, keeps_energy = false, has_frequency = false, constant_frequency = false;
  bool has_series = false, has_section = false, oscillates = false, carries_slope = false, has_entropy = false;
  std::size_t sections = 0, invariants = 0, quantities = 0, elements = 0, moments = 0;
  double series_until = 0;
  double careful_step = std::numeric_limits<double>::infinity();

  /// Whether the energy is a function of the state that the run carries.
  constexpr bool says_energy() const { return has_energy && (!contact || acting); }
};

/// work_of returns W = ∫F·q̇ dt of forces beside the mechanics since the start of the run; 0 without forces.
inline double work_of(const ProblemTraits& traits, StateView x) { return traits.forced ? x[traits.moving] : 0; }

/// EnergyTerms are H, its parts K and V, and H_s; NaN where the problem has none, or the state does not carry the
/// variables that it depends on.
struct EnergyTerms {
  double total, kinetic, potential, action_slope;
};

/// SectionValues are the values of the sections at a state, of which there are at most three.
using SectionValues = std::array<double, 3>;

class ProblemTable {
 public:
  /// `known` has to outlive it.
  explicit ProblemTable(const ProblemTraits& known) : traits(known) {}
  ProblemTable(const ProblemTable&) = delete;
  ProblemTable& operator=(const ProblemTable&) = delete;
  virtual ~ProblemTable() = default;

  const ProblemTraits& traits;

  /// The state with these values of the card's variables, at t.
  virtual RunState start(const std::vector<double>& variables, double t) const = 0;
  /// Writes ẋ, traits.numbers numbers.
  virtual void rates(StateView x, double* rates) const = 0;
  /// Writes ẋ, and its derivative along the direction (u, dt) of the state and the time.
  virtual void rates(StateView x, const double* u, double dt, double* rates, double* changes) const = 0;

  /// The energy at a state, also at the singular start of a series; NaN where the problem has none, or the state does
  /// not carry the variables that it depends on.
  virtual double energy_of(StateView x) const = 0;
  virtual EnergyTerms energy_terms(StateView x) const = 0;
  /// The same for each of the states.
  virtual void energy_terms(const StateRows& states, EnergyTerms* terms) const = 0;
  double energy(StateView x) const { return energy_terms(x).total; }
  virtual double mechanical_energy(StateView x) const = 0;

  /// α at a time, for linear contact mechanics.
  virtual double damping(double t) const = 0;
  /// H_s at s and t.
  virtual double action_slope(double s, double t) const = 0;
  virtual double action_curvature() const = 0;
  /// R for quadratic contact mechanics, else 0.
  virtual double offset() const = 0;
  /// The period of the problem; 0: it has none, or that is not known.
  virtual double period() const = 0;
  /// NaN where the problem has none.
  virtual double stiffness_rate() const = 0;
  virtual double frequency_squared(StateView x) const = 0;
  /// Whether the motion of general mechanics depends on s.
  virtual bool reads_action() const = 0;

  /// Whether x lies outside the domain of the motion.
  virtual bool outside(StateView x) const = 0;
  /// The quantity that is negative outside the domain.
  virtual double inside(StateView x) const = 0;

  virtual void sections(StateView x, double* values) const = 0;
  virtual void invariants(StateView x, double* values) const = 0;
  /// The same for each of the states, one row after the other.
  virtual void invariants(const StateRows& states, double* values) const = 0;
  virtual double quantity(StateView x, std::size_t index) const = 0;
  /// Orbital element `index` of two_body::element_names.
  virtual double element(StateView x, std::size_t index) const = 0;
  virtual double entropy(StateView x) const = 0;
  virtual std::span<const std::string_view> moment_names() const = 0;
  virtual void moments(StateView x, double* values) const = 0;
  virtual double log_weight(StateView x) const = 0;
  virtual double log_rate(StateView x) const = 0;
  virtual double gravitational_parameter() const = 0;

  virtual bool starts_series(StateView x) const = 0;
  virtual RunState series_state(double t) const = 0;
};

/// variable returns variable i of the card at a state: `unknown` where the state does not carry it, or where the slope
/// is infinite.
inline double variable(const ProblemTraits& traits, StateView x, std::size_t i) {
  const std::size_t n = traits.components;
  if (i < n) return x[i];
  if (traits.sloped)
    if (const double slope = x[n + 1] / x[n]; std::isfinite(slope)) return slope;
  return unknown;
}

}  // namespace least

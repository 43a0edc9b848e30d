// jacobi_maupertuis: a hybrid variational integrator. Where the motion is slow, Hamilton's principle with a step in
// time; where its kinetic energy exceeds K_c, the discrete Jacobi–Maupertuis principle with a coordinate for parameter
// and the time reconstructed (core/schemes/jacobi_maupertuis_step.hpp). The steps follow the orbit's shape through a
// fast passage at a length θ of the parameter coordinate q^σ, halved where the orbit turns:
//   α = √n θ √g_σσ |∇V|_{g⁻¹} / (2(E₀ − V)) ≤ alpha_max
// Enter where K > K_c, leave where E₀ − V < κ K_c. E₀ is that of the run's start: V does not depend on time. Orders 4
// and 6 by composition; they need the energy root, which gives p_σ back what its own equation would. Not symplectic or
// reversible on the whole phase space, and angular momentum drifts: at fixed q^σ each step is symplectic in the other
// variables. A step that cannot be solved is tried along the other coordinates, then at half the length, then in time.
// Source: Nair, Ober-Blöbaum, Marsden 2009; without energy root, step control and hysteresis that publication's scheme.
#pragma once

#include <tuple>

#include "core/schemes/jacobi_maupertuis_hybrid.hpp"
#include "core/schemes/jacobi_maupertuis_step.hpp"

namespace least {

/// The motion of a problem, as the hybrid takes steps with it.
template <Conservative P, class T>
struct JacobiMaupertuisMotion {
  using Number = T;
  using Site = StepEnd<P, T>;
  using Numbers = Vec<P::dof, T>;
  P problem;
  Quadrature quadrature;
  T energy;

  static constexpr std::size_t size() { return P::dof; }
  Site site() const { return {}; }
  Numbers numbers() const { return {}; }
  void look(Site& x, Work& work) const {
    x.here = Slopes<P, T>(problem, x.q);
    ++work.forces;
  }
  void velocity(const Site& x, Numbers& v) const { v = x.here.raise(problem, x.p); }
  T kinetic(const Site& x) const { return 0.5 * dot(x.p, least::velocity(problem, x.q, x.p)); }
  T scale(const Site& x, std::size_t i) const {
    using least::sqrt;
    Numbers unit{};
    unit[i] = T(1);
    return sqrt(x.here.lower(problem, unit)[i]);
  }
  T steepness(const Site& x) const {
    using least::sqrt;
    return sqrt(dot(x.here.gradient, x.here.raise(problem, x.here.gradient)));
  }
  T gap(const Site& x) const { return energy - x.here.potential; }
  StepStatus in_time(Site& x, const T& h, Work& work) const {
    return variational_step(problem, quadrature, x.q, x.p, x.here, h, work);
  }
  StepStatus along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const {
    return JacobiMaupertuisStep<P, T>(problem, quadrature, energy).step(x, sigma, delta, sign, work);
  }
  bool energy_root(Site& x, std::size_t sigma) const {
    return JacobiMaupertuisStep<P, T>(problem, quadrature, energy).energy_root(x, sigma);
  }
  T step_energy(const Site& x, const Site& y, const T& h) const {
    return least::step_energy(problem, quadrature, x, y, h);
  }
};

template <Conservative P, class X>
class JacobiMaupertuisStepper {
 public:
  using T = typename X::Number;

  template <class Settings>
  JacobiMaupertuisStepper(const P& problem, const X& x, const T& energy, const Settings& settings)
      : hybrid_({problem, settings.quadrature, energy}, settings) {
    put(x);
    hybrid_.look();
  }

  StepStatus step(X& x) noexcept {
    put(x);
    if (const StepStatus status = hybrid_.step(); status != StepStatus::ok) return status;
    x.q = hybrid_.here().q;
    x.p = hybrid_.here().p;
    x.t = x.t + hybrid_.here().elapsed;
    return StepStatus::ok;
  }
  const ActiveMethod& active_method() const { return hybrid_.active_method(); }
  void go_on(const ActiveMethod& course) { hybrid_.go_on(course); }
  Work work() const { return hybrid_.work(); }
  /// The discrete energy of the step from a to b, which was taken as `course` says.
  T discrete_energy(const X& a, const X& b, const ActiveMethod& course) const {
    return hybrid_.discrete_energy({a.q, a.p, {}, T(0)}, b.t - a.t, course);
  }
  std::int64_t fallback_steps() const { return hybrid_.fallback_steps(); }

 private:
  void put(const X& x) {
    hybrid_.here().q = x.q;
    hybrid_.here().p = x.p;
  }

  JacobiMaupertuisHybrid<JacobiMaupertuisMotion<P, T>> hybrid_;
};

struct JacobiMaupertuis {
  double step = 0.01, theta = 0.01, critical_kinetic_energy = std::numeric_limits<double>::quiet_NaN();
  Quadrature quadrature = Quadrature::trapezoid;
  ParameterRule parameter_rule = ParameterRule::automatic;
  double parameter_hysteresis = 1.25;
  Exit exit = Exit::nominal;
  bool energy_root = true;
  int order = 4;
  double alpha_max = 0.1, hysteresis = 0.9;

  using Self = JacobiMaupertuis;
  static constexpr bool own_clock = true;
  static constexpr std::tuple fields{
      step_field<Self>(),
      Field<Self>{"theta",
                  "θ",
                  "the parameter coordinate's",
                  "step of the parameter coordinate",
                  &Self::theta,
                  any_length,
                  {},
                  "theta"},
      Field<Self>{"critical_kinetic_energy",
                  "K_c",
                  "energy",
                  "kinetic energy above which a coordinate is the parameter; null: never",
                  &Self::critical_kinetic_energy,
                  {0, 1e300},
                  {},
                  "critical_kinetic_energy",
                  "null"},
      Field<Self, Quadrature>{
          "quadrature", "", "", "quadrature of the action", &Self::quadrature, {0, 0}, quadrature_names},
      Field<Self, ParameterRule>{"parameter_rule",
                                 "",
                                 "",
                                 "which coordinate is the parameter: the fastest one; or, in the plane, y where "
                                 "|dy/dx| > 2 (slope) or |dy/dt| > 2 (speed)",
                                 &Self::parameter_rule,
                                 {0, 0},
                                 parameter_rule_names},
      Field<Self>{"parameter_hysteresis",
                  "",
                  "1",
                  "how many times as fast another coordinate must be to take over",
                  &Self::parameter_hysteresis,
                  {1, 1e3}},
      Field<Self, Exit>{"exit",
                        "",
                        "",
                        "step in time after a fast passage: the nominal one, or one that keeps E_d = E₀",
                        &Self::exit,
                        {0, 0},
                        exit_names},
      Field<Self, bool>{"energy_root", "", "", "take the parameter's momentum from H = E₀; orders above 2 need it",
                        &Self::energy_root},
      Field<Self, int>{"order", "", "1", "2, or by composition 4 (suzuki_4) or 6 (kahan_li_6)", &Self::order, {2, 6}},
      Field<Self>{"alpha_max",
                  "α",
                  "rad",
                  "largest turn of the orbit in a step; null: no step control",
                  &Self::alpha_max,
                  {1e-6, 1},
                  {},
                  {},
                  "null"},
      Field<Self>{"hysteresis", "κ", "1", "leave where E₀ − V < κ K_c", &Self::hysteresis, {0, 1, true, false}},
  };
  static SchemeCard card() {
    constexpr double null = std::numeric_limits<double>::quiet_NaN();
    return {
        .id = "jacobi_maupertuis",
        .title = "Jacobi–Maupertuis hybrid",
        .summary =
            "Steps in time where the motion is slow, steps of a coordinate with time reconstructed where its "
            "kinetic energy is high: the discrete principles of Hamilton and of Jacobi and Maupertuis.",
        .orders = {{"2", 2}, {"4", 4}, {"6", 6}},
        .implicit = true,
        .structure = "none",
        .presets = {{"default", "order 4, energy root, step control", {}},
                    {"paper",
                     "as published by Nair, Ober-Blöbaum and Marsden: order 2, slope rule, no root, no step control",
                     {{"parameter_rule", 1},
                      {"exit", 1},
                      {"energy_root", 0},
                      {"order", 2},
                      {"alpha_max", null},
                      {"hysteresis", 1}}}},
        .good_for =
            "orbits that are slow but for short fast passages, as eccentric ellipses, at the step of the slow part",
        .fails_when =
            "long runs need angular momentum or reversibility (it keeps neither), or nothing is ever fast: "
            "time_transformed keeps both at less cost",
        .needs = "a Lagrangian without s: a kinetic metric and a potential that does not depend on time",
        .references = {"Nair, Ober-Blöbaum, Marsden, The Jacobi–Maupertuis principle in variational integrators, 2009",
                       "Marsden, West, Acta Numerica 10, 357 (2001), 4"}};
  }
  std::vector<Conflict> conflicts(const ProblemCard& problem) const {
    std::vector<Conflict> all;
    if (order % 2 != 0) all.push_back({"order", "there is no such order", "2, 4, 6"});
    if (exit == Exit::paper && energy_root)
      all.push_back(
          {"exit", "with the energy root the equation of the paper's exit has only the root h = 0", "nominal"});
    if (exit == Exit::paper && order > 2)
      all.push_back({"exit", "the paper's exit continues single steps, not compositions of them", "nominal"});
    if (parameter_rule != ParameterRule::automatic && problem.variables.size() > 4)
      all.push_back({"parameter_rule", "is for two degrees of freedom", "automatic"});
    return all;
  }
  /// The scheme without steps along a coordinate, so that the length of steps in time is bounded as with other schemes.
  JacobiMaupertuis in_time() const {
    auto slow = *this;
    slow.critical_kinetic_energy = std::numeric_limits<double>::quiet_NaN();
    return slow;
  }
  template <Conservative P, class X>
  requires Autonomous<P>
  auto bind(const P& problem, const X& x, const typename X::Number& energy) const {
    return JacobiMaupertuisStepper<P, X>(problem, x, energy, *this);
  }
};

}  // namespace least

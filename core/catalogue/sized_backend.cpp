#include "core/catalogue/sized_backend.hpp"

#include <array>
#include <string_view>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/sized_forced.hpp"
#include "core/catalogue/sized_implicit.hpp"
#include "core/catalogue/sized_steps.hpp"
#include "core/catalogue/sized_taylor.hpp"
#include "core/from_values.hpp"
#include "core/run/control_stepper.hpp"
#include "core/run/self_timed.hpp"
#include "core/schemes/contact_galerkin_4.hpp"
#include "core/schemes/contact_gauss.hpp"
#include "core/schemes/contact_midpoint.hpp"
#include "core/schemes/galerkin_4.hpp"
#include "core/schemes/variational_midpoint.hpp"
#include "core/tape/steep.hpp"

namespace least {
namespace {

/// A problem as schemes see it here: what a run asks of it.
struct SizedProblem {
  const RunBackend* backend;
};

/// taylor and the schemes of Odeint, bound to it.
struct SizedSeries {
  Taylor chosen;
  tape::Program program;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  SizedTaylorStepper bind(const SizedProblem&, const RunState&, double) const {
    return SizedTaylorStepper(std::make_shared<taylor::Expansion>(program, chosen.tolerance, chosen.order));
  }
};
struct SizedPair {
  AnyOdeintScheme chosen;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  ControlStepper bind(const SizedProblem& problem, const RunState&, double) const {
    return {*problem.backend, chosen.tolerance, chosen.method, true};
  }
};

struct Binding {
  const SizedBackend& backend;
  const text::SizedScene& scene;
  const Request& request;
  const RunState& x;
  const Grid& grid;
  double end;

  template <class Scheme>
  Scheme scheme() const {
    return from_values<Scheme>(Scheme::fields, request.settings);
  }
  template <class Stepper>
  std::unique_ptr<Integrator> equal_steps(Stepper stepper) const {
    return std::make_unique<SizedSteps<Stepper>>(backend.table(), std::move(stepper), x, grid);
  }
  template <class Scheme>
  std::unique_ptr<Integrator> own_clock(const Scheme& scheme) const {
    return std::make_unique<SelfTimedIntegrator<SizedProblem, Scheme, RunState>>(backend, SizedProblem{&backend},
                                                                                 scheme, x, end);
  }
};

template <class Scheme>
std::unique_ptr<Integrator> bind_kicks(const Binding& to) {
  if (to.scene.forced) return to.equal_steps(ForcedKickDrift(to.scene, pieces_of(to.scheme<Scheme>())));
  return to.equal_steps(SizedKickDrift<Scheme>(to.scene, to.scheme<Scheme>()));
}
template <class Scheme>
std::unique_ptr<Integrator> bind_stages(const Binding& to) {
  return to.equal_steps(SizedRungeKutta(to.scene, Scheme::tableau));
}
template <class Scheme>
std::unique_ptr<Integrator> bind_pair(const Binding& to) {
  return to.own_clock(SizedPair{to.scheme<Scheme>().compiled_as()});
}
std::unique_ptr<Integrator> bind_contact_leapfrog(const Binding& to) {
  return to.equal_steps(SizedContactLeapfrog(to.scene, to.scheme<ContactLeapfrog>()));
}
std::unique_ptr<Integrator> bind_lifted(const Binding& to) {
  return to.equal_steps(SizedLifted(to.scene, to.scheme<LiftedSplitting>()));
}
std::unique_ptr<Integrator> bind_series(const Binding& to) {
  return to.own_clock(SizedSeries{to.scheme<Taylor>(), to.scene.series()});
}

/// Where the middle of a step says all of it.
bool is_flat(const text::SizedScene& scene) {
  const bool flat = scene.kind == text::FormKind::separable || scene.kind == text::FormKind::contact_linear;
  return flat && !scene.forced;
}

/// Of a path of polynomials and a rule of quadrature.
template <class Scheme, SizedVariational::Path path>
std::unique_ptr<Integrator> bind_rule(const Binding& to) {
  const Scheme scheme = to.scheme<Scheme>();
  Composition composition = Composition::none;
  if constexpr (requires { scheme.composition; }) composition = scheme.composition;
  const bool is_straight = path == SizedVariational::Path::straight;
  if (is_flat(to.scene)) return to.equal_steps(SizedVariational(to.scene, path, composition, scheme.step));
  return to.equal_steps(StageRule(to.scene, is_straight ? StageRule::midpoint : StageRule::simpson, composition));
}
std::unique_ptr<Integrator> bind_gauss(const Binding& to) {
  const int stages = to.scheme<ContactGauss>().stages;
  return to.equal_steps(StageRule(to.scene, StageRule::gauss(stages), Composition::none));
}

using text::SizedScene;
bool on_all(const SizedScene&) { return true; }
/// With forces that momenta can be solved for.
bool on_separable(const SizedScene& scene) {
  return scene.kind == text::FormKind::separable && (!scene.forced || scene.forces.solvable());
}
/// Of order 3 with exact kicks alone: a symmetric error in each would not cancel.
bool with_exact_kicks(const SizedScene& scene) { return on_separable(scene) && (!scene.forced || scene.forces.linear); }
bool with_lift(const SizedScene& scene) { return scene.lift != nullptr; }
bool on_damped(const SizedScene& scene) { return scene.kind == text::FormKind::contact_linear; }
/// Forced ones, and those whose metric depends on the place, where a step's matrix is not too large.
bool with_path(const SizedScene& scene) {
  if (is_flat(scene)) return scene.kind == text::FormKind::separable;
  return (scene.forced || scene.kind == text::FormKind::metric) && scene.coordinates <= SizedScene::most_full;
}
bool without_action(const SizedScene& scene) {
  return scene.kind == text::FormKind::hamiltonian && !scene.acting && !scene.forced &&
         scene.coordinates <= SizedScene::most_full;
}
constexpr auto straight = SizedVariational::Path::straight, parabola = SizedVariational::Path::parabola;

/// A scheme that runs on scenes of any size, and on which of them.
struct SizedScheme {
  std::string_view id;
  bool (*fits)(const SizedScene& scene);
  std::unique_ptr<Integrator> (*bind)(const Binding& to);
};
constexpr std::array sized_schemes{
    SizedScheme{"explicit_euler", on_all, bind_stages<ExplicitEuler>},
    SizedScheme{"explicit_midpoint", on_all, bind_stages<ExplicitMidpoint>},
    SizedScheme{"runge_kutta_4", on_all, bind_stages<RungeKutta4>},
    SizedScheme{"symplectic_euler", on_separable, bind_kicks<SymplecticEuler>},
    SizedScheme{"leapfrog", on_separable, bind_kicks<Leapfrog>},
    SizedScheme{"ruth_3", with_exact_kicks, bind_kicks<Ruth3>},
    SizedScheme{"variational_midpoint", with_path, bind_rule<VariationalMidpoint, straight>},
    SizedScheme{"galerkin_4", with_path, bind_rule<Galerkin4, parabola>},
    SizedScheme{"contact_leapfrog", on_damped, bind_contact_leapfrog},
    SizedScheme{"contact_variational_midpoint", on_damped, bind_rule<ContactVariationalMidpoint, straight>},
    SizedScheme{"contact_galerkin_4", on_damped, bind_rule<ContactGalerkin4, parabola>},
    SizedScheme{"contact_gauss", without_action, bind_gauss},
    SizedScheme{"lifted_splitting", with_lift, bind_lifted},
    SizedScheme{"dormand_prince_5", on_all, bind_pair<DormandPrince5>},
    SizedScheme{"fehlberg_78", on_all, bind_pair<Fehlberg78>},
    SizedScheme{"bulirsch_stoer", on_all, bind_pair<BulirschStoer>},
    SizedScheme{"taylor", on_all, bind_series}};

}  // namespace

std::vector<std::size_t> schemes_of(const text::SizedScene& scene) {
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < schemes().size(); ++i) {
    const auto known = std::ranges::find(sized_schemes, schemes()[i].id, &SizedScheme::id);
    if (known != sized_schemes.end() && known->fits(scene)) fitting.push_back(i);
  }
  return fitting;
}

std::unique_ptr<Integrator> SizedBackend::bind(const Request& request, const RunState& x, const Grid& grid,
                                               double end) const {
  const auto known = std::ranges::find(sized_schemes, schemes()[request.scheme].id, &SizedScheme::id);
  return known->bind({*this, scene(), request, x, grid, end});
}

std::vector<tape::Index> SizedBackend::write_equations(tape::Tape& tape) const {
  tape = scene().equations;
  return {scene().rates.begin(), scene().rates.begin() + static_cast<std::ptrdiff_t>(scene().moving)};
}

std::shared_ptr<const tape::SteepForces> SizedBackend::steep_forces() const {
  auto found =
      std::make_shared<const tape::SteepForces>(scene().equations, std::span(scene().rates).first(scene().moving));
  return found->empty() ? nullptr : found;
}

void SizedBackend::velocity(StateView x, double* v) const {
  std::vector<double> rates(traits_.moving);
  motion_.rates(x, rates.data());
  std::copy_n(rates.begin(), traits_.dof, v);
}

void SizedBackend::velocity_slopes(StateView x, const double* u, double* slopes) const {
  std::vector<double> rates(traits_.moving), changes(rates);
  motion_.rates(x, u, 0, rates.data(), changes.data());
  std::copy_n(changes.begin(), traits_.dof, slopes);
}

}  // namespace least

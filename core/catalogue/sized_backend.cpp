#include "core/catalogue/sized_backend.hpp"

#include <array>
#include <string_view>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/equation_steps.hpp"
#include "core/catalogue/metric_clock.hpp"
#include "core/catalogue/metric_energy_momentum.hpp"
#include "core/catalogue/sized_clock_tangents.hpp"
#include "core/catalogue/sized_clocks.hpp"
#include "core/catalogue/sized_damped.hpp"
#include "core/catalogue/sized_energy_momentum.hpp"
#include "core/catalogue/sized_fits.hpp"
#include "core/catalogue/sized_forced.hpp"
#include "core/catalogue/sized_gauss.hpp"
#include "core/catalogue/sized_herglotz.hpp"
#include "core/catalogue/sized_implicit.hpp"
#include "core/catalogue/sized_jacobi_maupertuis.hpp"
#include "core/catalogue/sized_stages.hpp"
#include "core/catalogue/sized_steps.hpp"
#include "core/catalogue/sized_tangents.hpp"
#include "core/from_values.hpp"
#include "core/run/self_timed.hpp"
#include "core/schemes/contact_galerkin_4.hpp"
#include "core/schemes/contact_midpoint.hpp"
#include "core/schemes/galerkin_4.hpp"
#include "core/schemes/variational_midpoint.hpp"
#include "core/tape/steep.hpp"

namespace least {
namespace {

using text::SizedScene;

/// SizedProblem is a problem in the form that schemes with their own clock need.
struct SizedProblem {
  const RunBackend* backend;
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

/// completion_of computes the velocities that are found from momenta by iteration; they follow the state.
TaylorStepper::Completion completion_of(const SizedScene& scene) {
  if (scene.found() == 0) return {};
  return {[](const void* of, double t, double* variables) {
            static_cast<const SizedScene*>(of)->find_velocities(variables, t);
          },
          &scene};
}
/// series_of returns the series of all components, or only of those that move.
std::shared_ptr<taylor::Expansion> series_of(const SizedScene& scene, bool all, double tolerance, int order) {
  auto made = std::make_shared<taylor::Expansion>(scene.series(all), tolerance, order);
  if (scene.kind == text::FormKind::contact_linear && scene.constant_damping) made->limit(scene.damping_at(0));
  return made;
}

TangentSpace space_of(const text::SizedScene& scene) { return {scene.flow ? 0 : scene.coordinates, scene.components}; }

/// For explicit schemes, make<T>(scene, scheme, count) returns the stepper in numbers T of states with `count`
/// components.
struct Kicks {
  template <class T, class Scheme>
  static auto make(const text::SizedScene& scene, const Scheme& scheme, std::size_t) {
    return SizedKickDrift<Scheme, T>(scene, scheme);
  }
};
struct Stages {
  template <class T, class Scheme>
  static auto make(const text::SizedScene& scene, const Scheme&, std::size_t count) {
    return by<T>(scene, Scheme::tableau, count);
  }

 private:
  template <class T, int N>
  static SizedRungeKutta<N, T> by(const text::SizedScene& scene, const ExplicitTableau<N>& tableau, std::size_t count) {
    return {scene, tableau, count};
  }
};
struct DampedKicks {
  template <class T>
  static auto make(const text::SizedScene& scene, const ContactLeapfrog& scheme, std::size_t count) {
    return SizedContactLeapfrog<T>(scene, scheme, count);
  }
  template <class T>
  static auto make(const text::SizedScene& scene, const ContactSplitting& scheme, std::size_t count) {
    return SizedContactSplitting<T>(scene, scheme, count);
  }
  template <class T>
  static auto make(const text::SizedScene& scene, const ContactSymplecticEuler& scheme, std::size_t count) {
    return SizedContactEuler<T>(scene, scheme, count);
  }
};
struct Lifts {
  template <class T>
  static auto make(const text::SizedScene& scene, const LiftedSplitting& scheme, std::size_t) {
    return SizedLifted<T>(scene, scheme);
  }
};

template <class Scheme, class By>
std::unique_ptr<Integrator> bind_explicit(const Binding& to) {
  if constexpr (std::is_same_v<By, Kicks>)
    if (to.scene.forced) return to.equal_steps(ForcedKickDrift(to.scene, pieces_of(to.scheme<Scheme>())));
  return to.equal_steps(By::template make<double>(to.scene, to.scheme<Scheme>(), to.x.size()));
}
template <class Scheme, class By>
StepTangents tangents_explicit(const text::SizedScene& scene, const Request& request) {
  if (std::is_same_v<By, Kicks> && scene.forced) return {};
  const auto scheme = from_values<Scheme>(Scheme::fields, request.settings);
  return tangents_by(request, space_of(scene), scheme.step, By::template make<Slope>(scene, scheme, scene.components));
}
template <class Scheme>
std::unique_ptr<Integrator> bind_pair(const Binding& to) {
  return bind_odeint(to.backend, to.scheme<Scheme>().compiled_as(), to.x, to.end);
}
std::unique_ptr<Integrator> bind_series(const Binding& to) {
  const auto scheme = to.scheme<Taylor>();
  auto series = series_of(to.scene, to.x.size() == to.scene.components, scheme.tolerance, scheme.order);
  return bind_taylor(to.backend, std::move(series), to.x, to.end, completion_of(to.scene));
}

std::unique_ptr<Integrator> bind_adaptive_verlet(const Binding& to) {
  return bind_clock(to.backend, to.scene, to.scheme<AdaptiveVerlet>(), to.x, to.end);
}
std::unique_ptr<Integrator> bind_transformed(const Binding& to) {
  const auto scheme = to.scheme<TimeTransformed>();
  return (on_a_metric(to.scene) ? bind_metric_clock : bind_flat_clock)(to.backend, to.scene, scheme, to.x, to.end);
}
StepTangents tangents_transformed(const text::SizedScene& scene, const Request& request) {
  const auto scheme = from_values<TimeTransformed>(TimeTransformed::fields, request.settings);
  return (on_a_metric(scene) ? tangents_of_metric_clock : tangents_of_flat_clock)(scene, scheme, request);
}

template <class Scheme>
Composition composition_of(const Scheme& scheme) {
  if constexpr (requires { scheme.composition; }) return scheme.composition;
  return Composition::none;
}
const StageRule& rule_of(SizedPath path) {
  return path == SizedPath::straight ? StageRule::midpoint : StageRule::simpson;
}

/// bind_rule binds the scheme of a polynomial path and a quadrature rule.
template <class Scheme, SizedPath path>
std::unique_ptr<Integrator> bind_rule(const Binding& to) {
  const auto scheme = to.scheme<Scheme>();
  if (is_flat(to.scene))
    return to.equal_steps(SizedVariational<double>(to.scene, path, composition_of(scheme), scheme.step, to.x.size()));
  if (follows_herglotz(to.scene)) return to.equal_steps(SizedHerglotz<double>(to.scene, path, composition_of(scheme)));
  return to.equal_steps(SizedStages<double>(to.scene, rule_of(path), composition_of(scheme)));
}
template <class Scheme, SizedPath path>
StepTangents tangents_rule(const text::SizedScene& scene, const Request& request) {
  if (scene.forced) return {};
  const auto scheme = from_values<Scheme>(Scheme::fields, request.settings);
  if (is_flat(scene))
    return tangents_by(request, space_of(scene), scheme.step,
                       SizedVariational<Slope>(scene, path, composition_of(scheme), scheme.step, scene.components));
  if (follows_herglotz(scene))
    return tangents_by(request, space_of(scene), scheme.step,
                       SizedHerglotz<Slope>(scene, path, composition_of(scheme)));
  return tangents_by(request, space_of(scene), scheme.step,
                     SizedStages<Slope>(scene, rule_of(path), composition_of(scheme)));
}
std::unique_ptr<Integrator> bind_gauss(const Binding& to) {
  const auto scheme = to.scheme<ContactGauss>();
  if (is_flat(to.scene)) return to.equal_steps(SizedGauss<double>(to.scene, scheme, to.x.size()));
  return to.equal_steps(SizedStages<double>(to.scene, StageRule::gauss(scheme.stages), Composition::none));
}
StepTangents tangents_gauss(const text::SizedScene& scene, const Request& request) {
  const auto scheme = from_values<ContactGauss>(ContactGauss::fields, request.settings);
  if (is_flat(scene))
    return tangents_by(request, space_of(scene), scheme.step, SizedGauss<Slope>(scene, scheme, scene.components));
  return tangents_by(request, space_of(scene), scheme.step,
                     SizedStages<Slope>(scene, StageRule::gauss(scheme.stages), Composition::none));
}

/// bind_level binds a scheme with an energy level: Flat takes its steps if the metric is constant, Metric otherwise.
template <class Flat, class Metric>
std::unique_ptr<Integrator> bind_level(const Binding& to) {
  const auto scheme = to.scheme<decltype(Flat::chosen)>();
  return on_a_metric(to.scene) ? to.own_clock(Metric{scheme, &to.scene}) : to.own_clock(Flat{scheme, &to.scene});
}
StepTangents tangents_energy_momentum(const text::SizedScene& scene, const Request& request) {
  const auto scheme = from_values<EnergyMomentum>(EnergyMomentum::fields, request.settings);
  const EnergyLevel level = energy_of_first_step(scene, request.scene->initial.data(), scheme.step);
  if (on_a_metric(scene))
    return tangents_by_clock(request, space_of(scene), MetricEnergyMomentum<Slope>(scene, scheme, Slope(0)), level);
  return tangents_by_clock(request, space_of(scene), SizedEnergyMomentum<Slope>(scene, scheme, Slope(0)), level);
}
template <class Motion>
StepTangents tangents_jacobi(const text::SizedScene& scene, const Request& request) {
  const auto scheme = from_values<JacobiMaupertuis>(JacobiMaupertuis::fields, request.settings);
  return tangents_by_clock(request, space_of(scene), SizedJacobiMaupertuis<Motion>(scene, scheme, Slope(0)),
                           energy_of_start(scene, request.scene->initial.data()));
}
StepTangents tangents_jacobi_maupertuis(const text::SizedScene& scene, const Request& request) {
  return on_a_metric(scene) ? tangents_jacobi<MetricJacobiMotion<Slope>>(scene, request)
                            : tangents_jacobi<SizedJacobiMotion<Slope>>(scene, request);
}

constexpr auto straight = SizedPath::straight, parabola = SizedPath::parabola;

/// SizedScheme is a scheme that runs scenes of any size, with the condition on the scene. `tangents` is null if its
/// steps have none.
struct SizedScheme {
  std::string_view id;
  bool (*fits)(const SizedScene& scene);
  std::unique_ptr<Integrator> (*bind)(const Binding& to);
  StepTangents (*tangents)(const SizedScene& scene, const Request& request) = nullptr;
};
template <class Scheme, class By>
constexpr SizedScheme explicit_scheme(std::string_view id, bool (*fits)(const SizedScene& scene)) {
  return {id, fits, bind_explicit<Scheme, By>, tangents_explicit<Scheme, By>};
}
constexpr std::array sized_schemes{
    explicit_scheme<ExplicitEuler, Stages>("explicit_euler", on_all),
    explicit_scheme<ExplicitMidpoint, Stages>("explicit_midpoint", on_all),
    explicit_scheme<RungeKutta4, Stages>("runge_kutta_4", on_all),
    explicit_scheme<SymplecticEuler, Kicks>("symplectic_euler", on_separable),
    explicit_scheme<Leapfrog, Kicks>("leapfrog", on_separable),
    explicit_scheme<Ruth3, Kicks>("ruth_3", with_exact_kicks),
    SizedScheme{"variational_midpoint", with_path, bind_rule<VariationalMidpoint, straight>,
                tangents_rule<VariationalMidpoint, straight>},
    SizedScheme{"galerkin_4", with_path, bind_rule<Galerkin4, parabola>, tangents_rule<Galerkin4, parabola>},
    SizedScheme{"time_transformed", with_parameter, bind_transformed, tangents_transformed},
    SizedScheme{"adaptive_verlet", on_steady, bind_adaptive_verlet},
    explicit_scheme<ContactLeapfrog, DampedKicks>("contact_leapfrog", on_contact),
    explicit_scheme<ContactSplitting, DampedKicks>("contact_splitting", on_contact),
    explicit_scheme<ContactSymplecticEuler, DampedKicks>("contact_symplectic_euler", on_contact),
    SizedScheme{"contact_variational_midpoint", on_contact_path, bind_rule<ContactVariationalMidpoint, straight>,
                tangents_rule<ContactVariationalMidpoint, straight>},
    SizedScheme{"contact_galerkin_4", on_contact_path, bind_rule<ContactGalerkin4, parabola>,
                tangents_rule<ContactGalerkin4, parabola>},
    SizedScheme{"contact_gauss", with_gauss, bind_gauss, tangents_gauss},
    SizedScheme{"energy_momentum", with_level,
                bind_level<SizedEnergyMomentumScheme<SizedEnergyMomentum<double>>,
                           SizedEnergyMomentumScheme<MetricEnergyMomentum<double>>>,
                tangents_energy_momentum},
    SizedScheme{"jacobi_maupertuis", with_level,
                bind_level<SizedJacobiScheme<SizedJacobiMotion<double>>, SizedJacobiScheme<MetricJacobiMotion<double>>>,
                tangents_jacobi_maupertuis},
    explicit_scheme<LiftedSplitting, Lifts>("lifted_splitting", with_lift),
    SizedScheme{"dormand_prince_5", on_all, bind_pair<DormandPrince5>},
    SizedScheme{"fehlberg_78", on_all, bind_pair<Fehlberg78>},
    SizedScheme{"bulirsch_stoer", on_all, bind_pair<BulirschStoer>},
    SizedScheme{"taylor", with_series, bind_series}};

const SizedScheme* sized_scheme(std::size_t position) {
  const auto known = std::ranges::find(sized_schemes, schemes()[position].id, &SizedScheme::id);
  return known == sized_schemes.end() ? nullptr : &*known;
}

}  // namespace

std::vector<std::size_t> schemes_of(const text::SizedScene& scene) {
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < schemes().size(); ++i)
    if (const SizedScheme* known = sized_scheme(i); known && known->fits(scene)) fitting.push_back(i);
  return fitting;
}

std::unique_ptr<Integrator> SizedBackend::bind(const Request& request, const RunState& x, const Grid& grid,
                                               double end) const {
  return sized_scheme(request.scheme)->bind({*this, scene(), request, x, grid, end});
}

StepTangents SizedBackend::tangents(const Request& request) const {
  const SizedScheme* known = sized_scheme(request.scheme);
  StepTangents made = known && known->tangents ? known->tangents(scene(), request) : StepTangents();
  if (!request.until_steps) made.end = request.end;
  return made;
}

std::vector<tape::Index> SizedBackend::write_equations(tape::Tape& tape) const {
  const auto plain = scene().plain();
  tape = plain ? plain->tape : scene().equations;
  const auto rates = plain ? plain->rates : std::span<const tape::Index>(scene().rates);
  const auto moving = rates.first(scene().moving + scene().found());
  return {moving.begin(), moving.end()};
}

std::shared_ptr<const tape::SteepForces> SizedBackend::steep_forces() const {
  const auto plain = scene().plain();
  if (!plain) return nullptr;
  auto found =
      std::make_shared<const tape::SteepForces>(plain->tape, plain->rates.first(scene().moving + scene().found()));
  return found->empty() ? nullptr : found;
}

double SizedBackend::energy_after(StateView x, double t) const {
  if (!traits_.contact || !scene().plain()) return unknown;
  constexpr double tolerance = 1e-15;
  constexpr int order = 20;
  RunState at{x.t, StateNumbers(x.numbers, x.numbers + scene().components)};
  TaylorStepper flow(series_of(scene(), true, tolerance, order), completion_of(scene()));
  return flow.reach(at, t) == StepStatus::ok ? table_.energy_of(at) : unknown;
}

void SizedBackend::values_of(StateView x, double* values) const {
  std::copy_n(x.numbers, traits_.moving, values);
  scene().find_velocities(values, x.t);
}
void SizedBackend::values_of(StateView x, const double* u, double* values, double* slopes) const {
  std::vector<Slope> all(traits_.moving + scene().found());
  for (std::size_t i = 0; i < traits_.moving; ++i) all[i] = Slope(x[i], {u[i]});
  scene().find_velocities(all.data(), x.t);
  for (const Slope& value : all) {
    *values++ = value.value;
    *slopes++ = value.slope[0];
  }
}

void SizedBackend::velocity(StateView x, double* v) const {
  if (scene().has_constant_metric()) return scene().velocity(x.numbers + traits_.dof, v);
  std::vector<double> rates(traits_.moving);
  motion_.rates(x, rates.data());
  std::copy_n(rates.begin(), traits_.dof, v);
}

void SizedBackend::velocity_slopes(StateView x, const double* u, double* slopes) const {
  if (scene().has_constant_metric()) return scene().velocity(u + traits_.dof, slopes);
  std::vector<double> rates(traits_.moving), changes(rates);
  motion_.rates(x, u, 0, rates.data(), changes.data());
  std::copy_n(changes.begin(), traits_.dof, slopes);
}

}  // namespace least

// dormand_prince_5, fehlberg_78, bulirsch_stoer: Boost.Odeint's schemes with error control, as others use them.
// Controls without geometry that set their own clock: a step is as long as an estimate of its error allows, component
// by component |error| ≤ tolerance (1 + |y| + h|ẏ|), Odeint's own measure, in units in which the motion is
// neither small nor large (core/schemes/step_units.hpp). They need equations of motion and nothing else, read the
// time, keep no structure: energy drifts at a rate that the tolerance sets. The first step follows Hairer, Nørsett,
// Wanner, Solving Ordinary Differential Equations I, II.4. What a state carries beyond the motion, an action or a
// tangent direction, goes along with the steps and has no say in them: asking for more never changes a run. Odeint
// itself is seen by one file only, odeint.cpp: a step is a virtual call. Sources: Dormand & Prince, J. Comput. Appl.
// Math. 6, 19 (1980); Fehlberg, NASA TR R-287 (1968); Bulirsch & Stoer, Numer. Math. 8, 1 (1966); Ahnert & Mulansky,
// AIP Conf. Proc. 1389, 1586 (2011).
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>

#include "core/problem_traits.hpp"
#include "core/scheme.hpp"
#include "core/schemes/taylor.hpp"
#include "core/tape/steep.hpp"

namespace least {

namespace odeint {

enum class Method : std::uint8_t { dormand_prince_5, fehlberg_78, bulirsch_stoer };
/// Whether the method gives the state within its last step without further evaluations.
constexpr bool has_dense(Method method) { return method == Method::dormand_prince_5; }

/// Field is ẏ = f(t, y) of a problem of any type.
struct Field {
  void (*rate)(const void* problem, double t, const double* y, double* rate);
  const void* problem;
  const tape::SteepForces* steep = nullptr;  ///< what may hide between stages; null: nothing
  void (*complete)(const void* problem, double t, double* variables) = nullptr;  ///< as in tape::SteepStep
};

/// Integrator is a method with its memory, for a fixed number of components. It keeps no address of a problem.
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::unique_ptr<Integrator> clone() const = 0;
  /// Takes one accepted step from (t, y); trials that are refused or give values that are not finite are repeated with
  /// shorter steps. A failure leaves y and t unchanged: singular if trials of every length, or those of hundreds of
  /// steps, gave values that are not finite; underflow if t + h = t.
  virtual StepStatus step(const Field& field, double* y, double& t) noexcept = 0;
  /// Takes steps from (t, y) to the time `end` ≥ t; the first goes all the way if its error allows.
  virtual StepStatus reach(const Field& field, double* y, double& t, double end) noexcept = 0;
  /// Writes the state at the time t within the last step to y. Returns false where no step was taken, the last one
  /// failed, or the method has no dense output.
  virtual bool between(double t, double* y) const noexcept = 0;
  virtual const Work& work() const noexcept = 0;
};

/// Layout says what the components of a state are.
struct Layout {
  std::size_t count;        ///< all
  std::size_t moving;       ///< the first ones, which are the motion
  std::size_t coordinates;  ///< the first ones, which as many momenta follow; 0 for a flow
};
std::unique_ptr<Integrator> make_integrator(Method method, const Layout& layout, double tolerance);

/// States whose numbers are doubles, plain or with one tangent direction.
template <class X>
concept Flat = std::is_same_v<typename X::Time, double> &&(std::is_same_v<typename X::Number, double> || Sloped<X>);
template <Flat X>
inline constexpr std::size_t components = Sloped<X> ? 2 * X::size : X::size;

}  // namespace odeint

/// The steep functions in a problem's equations of motion; null where there are none. A thread keeps those of the last
/// problem of a type: controls and differences bind the same one many times.
template <VectorField P>
std::shared_ptr<const tape::SteepForces> steep_forces(const P& problem) {
  const auto look = [&]() -> std::shared_ptr<const tape::SteepForces> {
    tape::Tape tape;
    const auto rates = taylor::write_equations<StateOf<P>>(problem, tape);
    auto found = std::make_shared<const tape::SteepForces>(tape, rates);
    return found->empty() ? nullptr : found;
  };
  if constexpr (std::is_trivially_copyable_v<P>) {
    struct Left {
      P problem;
      std::shared_ptr<const tape::SteepForces> found;
    };
    thread_local std::optional<Left> left;
    // Different padding only causes a miss. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
    if (!left || std::memcmp(&left->problem, &problem, sizeof(P)) != 0) left = Left{problem, look()};
    return left->found;
  } else {
    return look();
  }
}

/// AnyOdeintStepper steps a problem by any of the methods.
template <VectorField P, odeint::Flat X>
class AnyOdeintStepper {
 public:
  /// Parts of a step in which changes of sign are looked for, as in TaylorStepper: steps of high order are so long that
  /// a quantity may change its sign more than once in one.
  static constexpr int parts = 16;

  AnyOdeintStepper(const P& problem, odeint::Method method, double tolerance)
      : problem_(problem),
        steep_(steep_forces(problem)),
        integrator_(odeint::make_integrator(method, {size, StateOf<P>::size, coordinates}, tolerance)) {}
  AnyOdeintStepper(const AnyOdeintStepper& other)
      : problem_(other.problem_), steep_(other.steep_), integrator_(other.integrator_->clone()) {}
  AnyOdeintStepper(AnyOdeintStepper&&) noexcept = default;
  AnyOdeintStepper& operator=(AnyOdeintStepper other) noexcept {
    problem_ = other.problem_;
    steep_ = std::move(other.steep_);
    integrator_ = std::move(other.integrator_);
    return *this;
  }

  /// x.t is the time itself. A state that is not the one the last step ended in costs an evaluation.
  StepStatus step(X& x) noexcept {
    return moved(x, [&](double* y, double& t) { return integrator_->step(field(), y, t); });
  }
  /// Moves x to the time t, which lies within one step from x, by a step that ends there: as accurate as other steps.
  StepStatus reach(X& x, double t) noexcept {
    return moved(x, [&](double* y, double& now) { return integrator_->reach(field(), y, now, t); });
  }
  /// Sets x to the state at t, which lies within the last step. Returns false where a step failed since, or where the
  /// method has no dense output: then `reach` gives the state from the start of the step.
  bool interpolate(X& x, double t) const noexcept {
    std::array<double, size> y;
    if (!integrator_->between(t, y.data())) return false;
    read(y.data(), x);
    x.t = t;
    return true;
  }
  const Work& work() const noexcept { return integrator_->work(); }

  static odeint::Field field_of(const P& problem, const tape::SteepForces* steep) {
    return {[](const void* of, double t, const double* y, double* rate) {
              X x;
              x.t = t;
              read(y, x);
              write(derivative(*static_cast<const P*>(of), x), rate);
            },
            &problem, steep};
  }

 private:
  static constexpr std::size_t size = odeint::components<X>;
  static constexpr std::size_t coordinates = [] {
    if constexpr (Flow<P>) return std::size_t(0);
    if constexpr (!Flow<P>) return std::size_t(P::dof);
  }();

  /// Values, then slopes.
  static void read(const double* y, X& x) {
    for (std::size_t i = 0; i < X::size; ++i) {
      if constexpr (Sloped<X>) {
        x[i] = {y[i], {y[X::size + i]}};
      } else {
        x[i] = y[i];
      }
    }
  }
  static void write(const X& x, double* y) {
    for (std::size_t i = 0; i < X::size; ++i) {
      y[i] = value_of(x[i]);
      if constexpr (Sloped<X>) y[X::size + i] = x[i].slope[0];
    }
  }
  odeint::Field field() const { return field_of(problem_, steep_.get()); }
  template <class Move>
  StepStatus moved(X& x, Move&& move) noexcept {
    std::array<double, size> y;
    write(x, y.data());
    double t = x.t;
    const StepStatus status = move(y.data(), t);
    if (status != StepStatus::ok) return status;
    read(y.data(), x);
    x.t = t;
    return status;
  }

  P problem_;
  std::shared_ptr<const tape::SteepForces> steep_;
  std::unique_ptr<odeint::Integrator> integrator_;
};

/// OdeintStepper steps a problem by the method M.
template <VectorField P, odeint::Flat X, odeint::Method M>
class OdeintStepper : public AnyOdeintStepper<P, X> {
 public:
  static constexpr bool has_dense = odeint::has_dense(M);
  OdeintStepper(const P& problem, double tolerance) : AnyOdeintStepper<P, X>(problem, M, tolerance) {}
};

/// Any of the three methods as a scheme, for which runs are compiled once.
struct AnyOdeintScheme {
  odeint::Method method = odeint::Method::dormand_prince_5;
  double tolerance = 1e-8;
  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  template <VectorField P, odeint::Flat X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return AnyOdeintStepper<P, X>(problem, method, tolerance);
  }
};

template <class C>
constexpr Field<C> tolerance_field() {
  return {"tolerance",
          "ε",
          "1",
          "error allowed in a step, absolute and relative alike; where coordinates, or momenta, start below 1e-3 or "
          "above 1e3, the absolute part is relative to their start",
          &C::tolerance,
          {1e-15, 1e-1, true, false}};
}

// `reads_time`: steps read x.t as the time itself, and do not only add to it. `asks_no_level`: steps do not need the
// energy level, which a flow does not have.

struct DormandPrince5 {
  double tolerance = 1e-8;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  static constexpr std::tuple fields{tolerance_field<DormandPrince5>()};
  AnyOdeintScheme compiled_as() const { return {odeint::Method::dormand_prince_5, tolerance}; }
  static SchemeCard card() {
    return {.id = "dormand_prince_5",
            .title = "Dormand–Prince 5(4)",
            .summary =
                "The Runge–Kutta pair behind most solvers, with error control and dense output of its own: "
                "Boost.Odeint's.",
            .orders = {{"", 5}},
            .structure = "none",
            .good_for = "smooth systems at moderate accuracy, and as what other schemes are to be measured against",
            .fails_when =
                "runs are long (energy drifts at every tolerance), the motion is stiff (steps stay short), "
                "or many digits are wanted (steps shrink like the fifth root of the tolerance)",
            .needs = "equations of motion",
            .references = {"Dormand, Prince, J. Comput. Appl. Math. 6, 19 (1980)",
                           "Ahnert, Mulansky, Odeint, AIP Conf. Proc. 1389, 1586 (2011)"}};
  }
  template <VectorField P, odeint::Flat X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return OdeintStepper<P, X, odeint::Method::dormand_prince_5>(problem, tolerance);
  }
};

struct Fehlberg78 {
  double tolerance = 1e-8;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  static constexpr std::tuple fields{tolerance_field<Fehlberg78>()};
  AnyOdeintScheme compiled_as() const { return {odeint::Method::fehlberg_78, tolerance}; }
  static SchemeCard card() {
    return {.id = "fehlberg_78",
            .title = "Runge–Kutta–Fehlberg 7(8)",
            .summary =
                "Thirteen stages of order 8 with error control: Boost.Odeint's. A state "
                "between two steps costs a step.",
            .orders = {{"", 8}},
            .structure = "none",
            .good_for = "smooth systems at high accuracy and few samples",
            .fails_when =
                "runs are long (energy drifts), the motion is stiff, or forces are not smooth; its estimate of the "
                "error does not see a plain integral over time, so steps are looked at a second time",
            .needs = "equations of motion",
            .references = {"Fehlberg, NASA TR R-287 (1968)",
                           "Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.5",
                           "Ahnert, Mulansky, Odeint, AIP Conf. Proc. 1389, 1586 (2011)"}};
  }
  template <VectorField P, odeint::Flat X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return OdeintStepper<P, X, odeint::Method::fehlberg_78>(problem, tolerance);
  }
};

struct BulirschStoer {
  double tolerance = 1e-8;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  static constexpr std::tuple fields{tolerance_field<BulirschStoer>()};
  AnyOdeintScheme compiled_as() const { return {odeint::Method::bulirsch_stoer, tolerance}; }
  static SchemeCard card() {
    return {.id = "bulirsch_stoer",
            .title = "Bulirsch–Stoer",
            .summary =
                "The explicit midpoint rule extrapolated in the square of the step, which chooses its order as "
                "well as its step: Boost.Odeint's. The order varies from step to step, 8 "
                "stands for what is usual at moderate tolerances. A state between two steps costs a step.",
            .orders = {{"", 8}},
            .structure = "none",
            .good_for = "very smooth systems at the highest accuracy: long steps of high order",
            .fails_when =
                "runs are long (energy drifts), the motion is stiff or has sudden turns, or many "
                "samples are asked for",
            .needs = "equations of motion",
            .references = {"Bulirsch, Stoer, Numer. Math. 8, 1 (1966)",
                           "Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.9",
                           "Ahnert, Mulansky, Odeint, AIP Conf. Proc. 1389, 1586 (2011)"}};
  }
  template <VectorField P, odeint::Flat X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return OdeintStepper<P, X, odeint::Method::bulirsch_stoer>(problem, tolerance);
  }
};

}  // namespace least

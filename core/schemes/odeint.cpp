#include "core/schemes/odeint.hpp"

#include <array>
#include <boost/numeric/odeint/algebra/range_algebra.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/util/odeint_error.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "core/schemes/fehlberg_check.hpp"
#include "core/schemes/plain_stepper.hpp"
#include "core/schemes/step_units.hpp"

namespace least::odeint {
namespace {

/// Components is a vector of a size known at run time. Up to `most_in_place` numbers are stored inside it, so that a
/// step does not allocate.
struct Components {
  using value_type = double;
  using iterator = double*;
  using const_iterator = const double*;

  Components() = default;
  Components(std::size_t size, std::size_t of_motion) { shape(size, of_motion); }
  Components(const Components& other) { *this = other; }
  Components& operator=(const Components& other) {
    if (this == &other) return *this;
    shape_like(other);
    std::copy_n(other.data(), count_, data());
    return *this;
  }
  void shape(std::size_t size, std::size_t of_motion) {
    count_ = size;
    moving = of_motion;
    if (size > most_in_place) elsewhere_.resize(size);
  }
  void shape_like(const Components& other) { shape(other.count_, other.moving); }
  std::size_t size() const { return count_; }
  bool operator==(const Components& other) const { return std::equal(begin(), end(), other.begin(), other.end()); }
  double& operator[](std::size_t i) { return data()[i]; }
  const double& operator[](std::size_t i) const { return data()[i]; }
  double* data() { return count_ > most_in_place ? elsewhere_.data() : here_.data(); }
  const double* data() const { return count_ > most_in_place ? elsewhere_.data() : here_.data(); }
  iterator begin() { return data(); }
  iterator end() { return data() + count_; }
  const_iterator begin() const { return data(); }
  const_iterator end() const { return data() + count_; }

  std::size_t moving = 0;  ///< how many, the first ones, are the motion

 private:
  static constexpr std::size_t most_in_place = 64;

  std::size_t count_ = 0;
  std::array<double, most_in_place> here_{};
  std::vector<double> elsewhere_;  ///< all components, where there are more
};

/// Returns the largest size of the first `moving` components; NaN is ignored.
template <class Vector>
double largest(const Vector& y, std::size_t moving) {
  double most = 0;
  for (std::size_t i = 0; i < moving; ++i) most = std::max(most, std::abs(y[i]));
  return most;
}

/// N components, for the shapes that are met most often: loops of known length save a tenth to a third of a step.
template <std::size_t N, std::size_t Moving = N>
struct Fixed {
  using Vector = std::array<double, N>;
  struct Algebra : library::array_algebra {
    static double norm_inf(const Vector& y) { return largest(y, Moving); }
  };
  static constexpr std::size_t count = N, moving = Moving;
  static Vector blank() { return {}; }
  static void shape(Vector&, const Vector&) {}
};
/// Any other shape.
struct Counted {
  using Vector = Components;
  struct Algebra : library::range_algebra {
    static double norm_inf(const Vector& y) { return largest(y, y.moving); }
  };
  std::size_t count, moving;
  Vector blank() const { return {count, moving}; }
  static void shape(Vector& to, const Vector& from) { to.shape_like(from); }
};

}  // namespace
}  // namespace least::odeint

namespace boost::numeric::odeint {
template <>
struct is_resizeable<least::odeint::Components> : boost::true_type {
  using type = boost::true_type;
};
template <>
struct resize_impl<least::odeint::Components, least::odeint::Components> {
  static void resize(least::odeint::Components& to, const least::odeint::Components& from) { to.shape_like(from); }
};
}  // namespace boost::numeric::odeint

namespace least::odeint {
namespace {

/// A Runge–Kutta pair with error control.
template <class Pair>
auto controlled(double tolerance) {
  using Controlled = library::controlled_runge_kutta<Pair>;
  static const Pair blank{};  // static, so that its scratch is zero and copies read initialized numbers
  return Controlled(typename Controlled::error_checker_type(tolerance, tolerance), {}, blank);
}

template <Method M, class Shape>
auto make_stepper(double tolerance) {
  using Y = typename Shape::Vector;
  using Algebra = typename Shape::Algebra;
  if constexpr (M == Method::dormand_prince_5) {
    const auto stepper = controlled<library::runge_kutta_dopri5<Y, double, Y, double, Algebra>>(tolerance);
    return library::dense_output_runge_kutta<std::remove_const_t<decltype(stepper)>>(stepper);
  } else if constexpr (M == Method::fehlberg_78) {
    const auto stepper = controlled<library::runge_kutta_fehlberg78<Y, double, Y, double, Algebra>>(tolerance);
    using Check = SixthDifference<Shape>;
    return Plain<std::remove_const_t<decltype(stepper)>, Check, Y>(Check(tolerance), stepper, stepper);
  } else {
    // With dense output (bulirsch_stoer_dense_out) a step takes ten to twenty times as long, and what it interpolates
    // is off by up to a thousand tolerances: a step to the time that is wanted is cheaper and better. Its estimate
    // compares two extrapolations of a step; both amplify the error of fast decaying components alike, which so is
    // twenty times as large as the estimate. The careful stepper therefore allows less.
    using Extrapolated = library::bulirsch_stoer<Y, double, Y, double, Algebra>;
    constexpr double less = 0.1, least = 1e-14;
    const double allowed = std::min(tolerance, std::max(less * tolerance, least));
    return Plain<Extrapolated, NoCheck, Y>({}, Extrapolated(tolerance, tolerance), Extrapolated(allowed, allowed));
  }
}
constexpr int order(Method method) { return method == Method::dormand_prince_5 ? 5 : 8; }

template <Method M, class Shape>
class Adaptive final : public Integrator {
 public:
  using Vector = typename Shape::Vector;

  Adaptive(Shape shape, std::size_t coordinates, double tolerance)
      : shape_(shape), coordinates_(coordinates), tolerance_(tolerance), stepper_(make_stepper<M, Shape>(tolerance)) {}

  std::unique_ptr<Integrator> clone() const override { return std::make_unique<Adaptive>(*this); }

  StepStatus step(const Field& field, double* y, double& t) noexcept override {
    const Vector start = settled(field, y, t);
    if (!(step_ > 0)) {
      if (const StepStatus status = choose_first_step(field, start, t); status != StepStatus::ok) return status;
      stepper_.initialize(start, t, step_);
    } else if (stepper_.current_time() != t || stepper_.current_state() != start) {
      stepper_.initialize(start, t, step_);
    }
    const double before = t;
    const StepStatus status = attempt(field, start, t);
    if (status == StepStatus::ok) {
      write(stepper_.current_state(), y);
      step_ = stepper_.current_time_step();
      start_ = before;
    } else {
      stepper_.initialize(start, t, step_);
    }
    dense_ = status == StepStatus::ok;
    return status;
  }

  StepStatus reach(const Field& field, double* y, double& t, double end) noexcept override {
    if (end == t) return StepStatus::ok;
    const StepStatus status = parts(field, settled(field, y, t), y, t, end);
    if (step_ > 0) stepper_.initialize(vector(y), t, step_);  // the steps of parts propose nothing for the next step
    dense_ = false;
    return status;
  }

  bool between(double t, double* y) const noexcept override {
    if constexpr (has_dense(M)) {
      // Outside the step it would be extrapolation.
      if (!dense_ || !(t >= start_ && t <= stepper_.current_time())) return false;
      Vector x = shape_.blank();
      stepper_.calc_state(t, x);
      write(x, y);
      return true;
    } else {
      return false;
    }
  }

  const Work& work() const noexcept override { return work_; }

 private:
  static constexpr int most_trials = 500, most_parts = 10'000;
  /// Steps that were shortened because values were not finite, in a stretch where three in four are. After so many, the
  /// motion has come to the edge of where its rates are defined and does not leave it.
  static constexpr int most_undefined = 300;

  /// The state y in the units of the integrator.
  Vector vector(const double* y) const {
    Vector x = shape_.blank();
    std::copy_n(y, shape_.count, x.data());
    if (units_) units_.enter(x);
    return x;
  }
  void write(const Vector& x, double* y) const {
    std::copy(x.begin(), x.end(), y);
    if (units_) units_.leave(y);
  }
  /// The same as vector(y); the first state that is asked for settles the units.
  Vector settled(const Field& field, const double* y, double t) {
    if (!std::exchange(settled_, true))
      units_.settle(vector(y), shape_.moving, coordinates_, tolerance_,
                    [&](const Vector& x, Vector& dx) { find_rates(field, x, dx, t); });
    return vector(y);
  }
  void find_rates(const Field& field, const Vector& x, Vector& dx, double t) {
    ++work_.forces;
    if (!units_) return field.rate(field.problem, t, x.data(), dx.data());
    Vector y = x;
    units_.leave(y);
    field.rate(field.problem, t, y.data(), dx.data());
    units_.enter(dx);
  }

  bool finite(const Vector& y) const {
    double zero = 0;
    for (std::size_t i = 0; i < shape_.moving; ++i) zero += 0 * y[i];
    return zero == 0;
  }

  StepStatus parts(const Field& field, Vector here, double* y, double& t, double end) {
    const double close = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), std::abs(end));
    double now = t, h = end - t;
    for (int count = 0; count < most_parts; ++count) {
      stepper_.initialize(here, now, h);
      if (const StepStatus status = attempt(field, here, now); status != StepStatus::ok) return status;
      here = stepper_.current_state();
      if (end - now <= close) {
        write(here, y);
        t = end;
        return StepStatus::ok;
      }
      h = std::min(stepper_.current_time_step(), end - now);
    }
    return StepStatus::solver_failed;
  }

  /// Takes one accepted step from (t, start), where the stepper is, and moves t and the stepper to its end. Odeint's
  /// measure of an error ignores NaN, so it accepts a step to values that are not finite; that step is undone here and
  /// tried again at a fifth of its length. Inlined in two places, the function would take twice as long to compile.
  [[gnu::noinline]] StepStatus attempt(const Field& field, const Vector& start, double& t) noexcept {
    const Vector* rate = nullptr;  // the last one evaluated: that at the end of the step
    const auto system = [&](const Vector& x, Vector& dx, double time) {
      Shape::shape(dx, x);
      find_rates(field, x, dx, time);
      rate = &dx;
    };
    bool undefined = false;  // a trial gave values that are not finite
    try {
      for (int trial = 0; trial < most_trials; ++trial) {
        const double h = stepper_.current_time_step();
        stepper_.do_step(system);
        const double reached = stepper_.current_time();
        const auto& end = stepper_.current_state();
        if (std::isfinite(reached) && finite(end) && finite(*rate)) {
          if (!(reached > t)) return StepStatus::underflow;
          if (const double part = resolved_part(field, start, t, end, *rate, reached); part < reached - t) {
            stepper_.initialize(start, t, part);
            continue;
          }
          if constexpr (requires { stepper_.met_undefined(); }) undefined = undefined || stepper_.met_undefined();
          undefined_ = std::max(undefined_ + (undefined ? 1 : -3), 0);
          if (undefined_ > most_undefined) break;
          t = reached;
          return StepStatus::ok;
        }
        undefined = true;
        const double shorter = 0.2 * std::min(h, reached - t);
        if (!(t + shorter > t)) break;
        stepper_.initialize(start, t, shorter);
      }
    } catch (const library::odeint_error&) {  // no step is short enough
      return StepStatus::underflow;
    } catch (...) {  // memory ran out
      return StepStatus::solver_failed;
    }
    return StepStatus::singular;
  }

  /// Returns how much of a step resolves the steep functions of the field, or somewhat less.
  double resolved_part(const Field& field, const Vector& start, double t, const Vector& reached, const Vector& rate,
                       double end) {
    if (!field.steep) return end - t;
    Vector from = start, to = reached, first_rate = shape_.blank(), last_rate = rate;
    find_rates(field, start, first_rate, t);
    if (units_)
      for (Vector* one : {&from, &to, &first_rate, &last_rate}) units_.leave(*one);
    return field.steep->resolved_part({{t, from.data(), first_rate.data()},
                                       {end, to.data(), last_rate.data()},
                                       shape_.moving,
                                       shape_.count,
                                       field.rate,
                                       field.complete,
                                       field.problem,
                                       least_size(largest(from, shape_.moving))},
                                      tolerance_, work_.forces);
  }

  /// Hairer, Nørsett, Wanner I, II.4: as long as an Euler step and a guess of ÿ allow. In the largest component, as
  /// Odeint measures errors.
  StepStatus choose_first_step(const Field& field, const Vector& y, double t) {
    Vector rate = shape_.blank(), other = rate, ahead = rate;
    find_rates(field, y, rate, t);
    if (!finite(y) || !finite(rate) || !std::isfinite(t)) return StepStatus::singular;
    const auto size = [&](const Vector& v) {
      double most = 0;
      for (std::size_t i = 0; i < shape_.moving; ++i)
        most = std::max(most, std::abs(v[i]) / (tolerance_ * (1 + std::abs(y[i]))));
      return most;
    };
    const double d0 = size(y), d1 = size(rate);
    const double guess = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * (d0 / d1);
    for (std::size_t i = 0; i < shape_.count; ++i) ahead[i] = y[i] + guess * rate[i];
    find_rates(field, ahead, other, t + guess);
    for (std::size_t i = 0; i < shape_.count; ++i) other[i] -= rate[i];
    const double d2 = finite(other) ? size(other) / guess : 0, most = std::max(d1, d2);
    const double h = most <= 1e-15 ? std::max(1e-6, 1e-3 * guess) : std::pow(0.01 / most, 1.0 / (order(M) + 1));
    const double step = std::min(100 * guess, h);
    if (!(t + step > t)) return StepStatus::underflow;
    step_ = step;
    return StepStatus::ok;
  }

  [[no_unique_address]] Shape shape_;
  std::size_t coordinates_;
  double tolerance_;
  StepUnits units_;
  bool settled_ = false;  ///< units_ are known
  decltype(make_stepper<M, Shape>(0)) stepper_;
  double step_ = 0;   ///< proposed for the next step; 0: not chosen yet
  double start_ = 0;  ///< when the last step began
  bool dense_ = false;
  int undefined_ = 0;  ///< steps that count towards `most_undefined`
  Work work_;
};

template <class Shape>
std::unique_ptr<Integrator> make(Method method, Shape shape, std::size_t coordinates, double tolerance) {
  switch (method) {
    case Method::dormand_prince_5:
      return std::make_unique<Adaptive<Method::dormand_prince_5, Shape>>(shape, coordinates, tolerance);
    case Method::fehlberg_78:
      return std::make_unique<Adaptive<Method::fehlberg_78, Shape>>(shape, coordinates, tolerance);
    default:
      return std::make_unique<Adaptive<Method::bulirsch_stoer, Shape>>(shape, coordinates, tolerance);
  }
}

}  // namespace

std::unique_ptr<Integrator> make_integrator(Method method, const Layout& layout, double tolerance) {
  std::unique_ptr<Integrator> integrator;
  const auto takes = [&](const auto& shape) {
    const bool same = layout.count == shape.count && layout.moving == shape.moving;
    if (same) integrator = make(method, shape, layout.coordinates, tolerance);
    return same;
  };
  // A second or two of compilation each, for what the catalogue meets: whole motions, mechanics with an action, a flow
  // in the plane with a tangent direction. Any other is counted.
#ifdef LEAST_FEW_SIZES
  takes(Fixed<2>{}) || takes(Counted{layout.count, layout.moving});
#else
  takes(Fixed<2>{}) || takes(Fixed<3>{}) || takes(Fixed<4>{}) || takes(Fixed<6>{}) || takes(Fixed<3, 2>{}) ||
      takes(Fixed<5, 4>{}) || takes(Fixed<4, 2>{}) || takes(Counted{layout.count, layout.moving});
#endif
  return integrator;
}

}  // namespace least::odeint

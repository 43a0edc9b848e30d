#include "core/schemes/odeint.hpp"

#include <array>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace least::odeint {
namespace {

namespace library = boost::numeric::odeint;

template <std::size_t N>
using Vector = std::array<double, N>;

/// Of vectors whose size is that of their first components.
template <std::size_t moving>
struct Leading : library::array_algebra {
  template <std::size_t N>
  static double norm_inf(const Vector<N>& y) {
    double most = 0;
    for (std::size_t i = 0; i < moving; ++i) most = std::max(most, std::abs(y[i]));
    return most;
  }
};

/// A stepper with error control and no dense output, with the calls of those that have it. The rate at the end of a
/// step is the next one's.
template <class Stepper, std::size_t N>
class Plain {
 public:
  template <class... Arguments>
  explicit Plain(const Arguments&... arguments) : stepper_(arguments...) {}

  void initialize(const Vector<N>& y, double t, double h) {
    y_ = y;
    t_ = t;
    h_ = h;
    rated_ = false;
  }
  template <class System>
  void do_step(System system) {
    if (!rated_) system(y_, rate_, t_);
    rated_ = true;
    library::failed_step_checker check;
    while (stepper_.try_step(system, y_, rate_, t_, next_, h_) == library::fail) check();
    y_ = next_;
    system(y_, rate_, t_);
  }
  const Vector<N>& current_state() const { return y_; }
  double current_time() const { return t_; }
  double current_time_step() const { return h_; }

 private:
  Stepper stepper_;
  Vector<N> y_{}, rate_{}, next_{};
  double t_ = 0, h_ = 0;
  bool rated_ = false;
};

/// A Runge–Kutta pair with error control.
template <class Pair>
auto controlled(double tolerance) {
  using Controlled = library::controlled_runge_kutta<Pair>;
  static const Pair blank{};  // static: its scratch is zero, and copies of it are of something
  return Controlled(typename Controlled::error_checker_type(tolerance, tolerance), {}, blank);
}

template <Method M, std::size_t N, std::size_t moving>
auto make_stepper(double tolerance) {
  using Y = Vector<N>;
  using Algebra = Leading<moving>;
  if constexpr (M == Method::dormand_prince_5) {
    const auto stepper = controlled<library::runge_kutta_dopri5<Y, double, Y, double, Algebra>>(tolerance);
    return library::dense_output_runge_kutta<std::remove_const_t<decltype(stepper)>>(stepper);
  } else if constexpr (M == Method::fehlberg_78) {
    const auto stepper = controlled<library::runge_kutta_fehlberg78<Y, double, Y, double, Algebra>>(tolerance);
    return Plain<std::remove_const_t<decltype(stepper)>, N>(stepper);
  } else {
    // With dense output (bulirsch_stoer_dense_out) a step takes ten to twenty times as long, and what it interpolates
    // is off by up to a thousand tolerances: a step to the time that is wanted is cheaper and better.
    return Plain<library::bulirsch_stoer<Y, double, Y, double, Algebra>, N>(tolerance, tolerance);
  }
}
constexpr int order(Method method) { return method == Method::dormand_prince_5 ? 5 : 8; }

template <Method M, std::size_t N, std::size_t moving>
class Adaptive final : public Integrator {
 public:
  explicit Adaptive(double tolerance) : tolerance_(tolerance), stepper_(make_stepper<M, N, moving>(tolerance)) {}

  std::unique_ptr<Integrator> clone() const override { return std::make_unique<Adaptive>(*this); }

  Status step(const Field& field, double* y, double& t) noexcept override {
    const Vector<N> start = vector(y);
    if (!(step_ > 0)) {
      if (const Status status = choose_first_step(field, start, t); status != Status::ok) return status;
      stepper_.initialize(start, t, step_);
    } else if (stepper_.current_time() != t || stepper_.current_state() != start) {
      stepper_.initialize(start, t, step_);
    }
    const double before = t;
    const Status status = attempt(field, start, y, t);
    if (status == Status::ok) {
      step_ = stepper_.current_time_step();
      start_ = before;
    } else {
      stepper_.initialize(start, t, step_);
    }
    dense_ = status == Status::ok;
    return status;
  }

  Status reach(const Field& field, double* y, double& t, double end) noexcept override {
    if (end == t) return Status::ok;
    const Status status = parts(field, y, t, end);
    if (step_ > 0) stepper_.initialize(vector(y), t, step_);  // parts say nothing of what comes next
    dense_ = false;
    return status;
  }

  bool between(double t, double* y) const noexcept override {
    if constexpr (has_dense(M)) {
      // Outside the step it would be extrapolation.
      if (!dense_ || !(t >= start_ && t <= stepper_.current_time())) return false;
      Vector<N> x;
      stepper_.calc_state(t, x);
      std::copy(x.begin(), x.end(), y);
      return true;
    } else {
      return false;
    }
  }

  const Work& work() const noexcept override { return work_; }

 private:
  static constexpr int most_trials = 500, most_parts = 10'000;

  static Vector<N> vector(const double* y) {
    Vector<N> x;
    std::copy(y, y + N, x.begin());
    return x;
  }

  static bool finite(const Vector<N>& y) {
    double zero = 0;
    for (std::size_t i = 0; i < moving; ++i) zero += 0 * y[i];
    return zero == 0;
  }

  Status parts(const Field& field, double* y, double& t, double end) {
    const double close = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), std::abs(end));
    Vector<N> here = vector(y);
    double now = t, h = end - t;
    for (int count = 0; count < most_parts; ++count) {
      stepper_.initialize(here, now, h);
      if (const Status status = attempt(field, here, here.data(), now); status != Status::ok) return status;
      if (end - now <= close) {
        std::copy(here.begin(), here.end(), y);
        t = end;
        return Status::ok;
      }
      h = std::min(stepper_.current_time_step(), end - now);
    }
    return Status::solver_failed;
  }

  /// One accepted step from (t, start), where the stepper stands. Odeint's measure of an error leaves out what is not a
  /// number, so that such a step is accepted: it is undone here and tried again at a fifth of its length. In line
  /// twice, it would take twice as long to compile.
  [[gnu::noinline]] Status attempt(const Field& field, const Vector<N>& from, double* y, double& t) noexcept {
    const Vector<N> start = from;     // y may be its place
    const Vector<N>* rate = nullptr;  // the last one evaluated: that at the end of the step
    const auto system = [&](const Vector<N>& x, Vector<N>& dx, double time) {
      ++work_.forces;
      field.rate(field.problem, time, x.data(), dx.data());
      rate = &dx;
    };
    try {
      for (int trial = 0; trial < most_trials; ++trial) {
        const double h = stepper_.current_time_step();
        stepper_.do_step(system);
        const double reached = stepper_.current_time();
        const auto& end = stepper_.current_state();
        if (std::isfinite(reached) && finite(end) && finite(*rate)) {
          if (!(reached > t)) return Status::underflow;
          std::copy(end.begin(), end.end(), y);
          t = reached;
          return Status::ok;
        }
        const double shorter = 0.2 * std::min(h, reached - t);
        if (!(t + shorter > t)) break;
        stepper_.initialize(start, t, shorter);
      }
    } catch (...) {  // Odeint gave up on finding a step, or memory ran out
      return Status::solver_failed;
    }
    return Status::singular;
  }

  /// Hairer, Nørsett, Wanner I, II.4: as long as an Euler step and a guess of ÿ allow. In the largest component, as
  /// Odeint measures errors.
  Status choose_first_step(const Field& field, const Vector<N>& y, double t) {
    Vector<N> rate, other, ahead;
    field.rate(field.problem, t, y.data(), rate.data());
    ++work_.forces;
    if (!finite(y) || !finite(rate) || !std::isfinite(t)) return Status::singular;
    const auto size = [&](const Vector<N>& v) {
      double most = 0;
      for (std::size_t i = 0; i < moving; ++i)
        most = std::max(most, std::abs(v[i]) / (tolerance_ * (1 + std::abs(y[i]))));
      return most;
    };
    const double d0 = size(y), d1 = size(rate);
    const double guess = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * (d0 / d1);
    for (std::size_t i = 0; i < N; ++i) ahead[i] = y[i] + guess * rate[i];
    field.rate(field.problem, t + guess, ahead.data(), other.data());
    ++work_.forces;
    for (std::size_t i = 0; i < N; ++i) other[i] -= rate[i];
    const double d2 = finite(other) ? size(other) / guess : 0, most = std::max(d1, d2);
    const double h = most <= 1e-15 ? std::max(1e-6, 1e-3 * guess) : std::pow(0.01 / most, 1.0 / (order(M) + 1));
    const double step = std::min(100 * guess, h);
    if (!(t + step > t)) return Status::underflow;
    step_ = step;
    return Status::ok;
  }

  double tolerance_;
  decltype(make_stepper<M, N, moving>(0)) stepper_;
  double step_ = 0;   ///< proposed for the next step; 0: not chosen yet
  double start_ = 0;  ///< when the last step began
  bool dense_ = false;
  Work work_;
};

}  // namespace

template <std::size_t N, std::size_t moving>
std::unique_ptr<Integrator> make_integrator(Method method, double tolerance) {
  switch (method) {
    case Method::dormand_prince_5:
      return std::make_unique<Adaptive<Method::dormand_prince_5, N, moving>>(tolerance);
    case Method::fehlberg_78:
      return std::make_unique<Adaptive<Method::fehlberg_78, N, moving>>(tolerance);
    default:
      return std::make_unique<Adaptive<Method::bulirsch_stoer, N, moving>>(tolerance);
  }
}

// A second or two of compilation each. A scene of another shape is missed by the linker: it is to be added here.
template std::unique_ptr<Integrator> make_integrator<1, 1>(Method, double);
template std::unique_ptr<Integrator> make_integrator<2, 2>(Method, double);
template std::unique_ptr<Integrator> make_integrator<3, 3>(Method, double);
template std::unique_ptr<Integrator> make_integrator<4, 4>(Method, double);
template std::unique_ptr<Integrator> make_integrator<6, 6>(Method, double);
// Mechanics with an action, a flow in the plane with a tangent direction.
template std::unique_ptr<Integrator> make_integrator<3, 2>(Method, double);
template std::unique_ptr<Integrator> make_integrator<5, 4>(Method, double);
template std::unique_ptr<Integrator> make_integrator<7, 6>(Method, double);
template std::unique_ptr<Integrator> make_integrator<4, 2>(Method, double);

}  // namespace least::odeint

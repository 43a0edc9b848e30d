#include "tests/bench/peers.hpp"

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "core/from_values.hpp"
#include "core/problem_traits.hpp"
#include "core/problems/damped_kepler.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/driven_oscillator.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/problems/kepler.hpp"
#include "core/problems/lane_emden.hpp"
#include "core/problems/pendulum.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "core/problems/scalar_field_cosmology.hpp"
#include "core/problems/spin_orbit.hpp"
#include "core/problems/van_der_pol.hpp"

#ifdef LEAST_HAS_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#endif

namespace {

using namespace least;
using namespace least::problems;
using bench::Peer;
using bench::Solver;
namespace odeint = boost::numeric::odeint;

constexpr std::int64_t most_forces = 2'000'000;

/// Setup configures a solver.
struct Setup {
  double first_step;
  double by_rate;  ///< errors are relative to |y| + by_rate h|ẏ|
  double tolerance = 0;
};

/// Motion is the problem's equations of motion on plain arrays, with only the variables that they depend on.
template <class P>
struct Motion {
  using X = StateOf<P>;
  using Y = std::array<double, X::size>;

  P problem;
  Y begin;
  double start;

  Motion(const P& of, const Request& scene) : problem(of) {
    X x = start_of<X>(problem, scene.scene->initial, scene.scene->start);
    if constexpr (HasSeries<P>)
      if (starts_series(problem, x)) x = series_state<X>(problem, P::series_until);
    start = x.t;
    for (std::size_t i = 0; i < X::size; ++i) begin[i] = x[i];
  }

  void rate(double t, const double* y, double* dy) const {
    X x;
    x.t = t;
    for (std::size_t i = 0; i < X::size; ++i) x[i] = y[i];
    const X d = derivative(problem, x);
    for (std::size_t i = 0; i < X::size; ++i) dy[i] = d[i];
  }
};

template <class Y>
using Fehlberg78 = odeint::runge_kutta_fehlberg78<Y>;
template <class Y>
using DormandPrince5 = odeint::runge_kutta_dopri5<Y>;

/// Out collects the states at the requested times.
class Out {
 public:
  Out(std::span<const double> times, double* states) : times_(times), begin_(states), end_(states) {}

  /// put() is called after a step from the time `from` to (t, y). It records the state at every requested time in this
  /// step: within the step by move(at, ahead), a shorter step aside, at its end by y itself. The run is not changed by
  /// it.
  template <class Y, class Move>
  void put(double from, double t, const Y& y, Move&& move) {
    for (; next_ < times_.size() && times_[next_] <= t; ++next_) {
      Y at = y;
      if (times_[next_] < t) move(at, times_[next_] - from);
      end_ = std::copy(at.begin(), at.end(), end_);
    }
  }
  /// good() says whether all states are there, and finite.
  bool good() const {
    return next_ == times_.size() && std::all_of(begin_, end_, [](double x) { return std::isfinite(x); });
  }

 private:
  std::span<const double> times_;
  std::size_t next_ = 0;
  double *begin_, *end_;
};

/// solve() drives Odeint's error control in a bare loop, the fastest way. `flatten` is needed: without it the compiler
/// does not inline the equations of motion, and the calls cost more than the equations.
template <template <class> class Pair, class P>
[[gnu::flatten]] std::int64_t solve(const Motion<P>& motion, const Setup& setup, std::span<const double> times,
                                    double* states) {
  using Y = typename Motion<P>::Y;
  using Stepper = odeint::controlled_runge_kutta<Pair<Y>>;
  static const Pair<Y> blank{};  // static: its scratch arrays are zero, so that copies of it read nothing uninitialized
  Stepper stepper(typename Stepper::error_checker_type(setup.tolerance, setup.tolerance, 1, setup.by_rate), {}, blank);
  std::int64_t forces = 0;
  const auto rate = [&](const Y& y, Y& dy, double t) { motion.rate(t, y.data(), dy.data()); };
  const auto counted = [&](const Y& y, Y& dy, double t) {
    ++forces;
    rate(y, dy, t);
  };
  Y y = motion.begin;
  double t = motion.start, h = setup.first_step;
  Out out(times, states);
  if constexpr (requires { stepper.initialize(counted, y, t); }) stepper.initialize(counted, y, t);
  while (t < times.back()) {
    if (forces > most_forces) return 0;
    const Y before = y;
    const double from = t;
    const bool last = !(t + h < times.back());
    if (last) h = times.back() - t;
    if (stepper.try_step(counted, y, t, h) != odeint::success) continue;
    if (last) t = times.back();
    out.put(from, t, y, [&](Y& at, double ahead) { Pair<Y>(blank).do_step(rate, before, from, at, ahead); });
  }
  return out.good() ? forces : 0;
}

template <template <class> class Pair, class P>
Solver with_odeint(const Motion<P>& motion, const Setup& setup) {
  return [motion, setup](std::span<const double> times, double* states) {
    return solve<Pair>(motion, setup, times, states);
  };
}

#ifdef LEAST_HAS_GSL
/// GslRun is GSL's driver, which a run resets instead of allocating it again.
template <class P>
class GslRun {
 public:
  GslRun(const Motion<P>& motion, const Setup& setup)
      : motion_(motion),
        first_step_(setup.first_step),
        driver_(gsl_odeiv2_driver_alloc_standard_new(&system_, gsl_odeiv2_step_rk8pd, setup.first_step, setup.tolerance,
                                                     setup.tolerance, 1, setup.by_rate)) {}
  GslRun(const GslRun&) = delete;
  GslRun& operator=(const GslRun&) = delete;

  std::int64_t solve(std::span<const double> times, double* states) {
    using Y = typename Motion<P>::Y;
    const auto& driver = *driver_;
    gsl_odeiv2_driver_reset(driver_.get());
    forces_ = 0;
    Y y = motion_.begin;
    double t = motion_.start, h = first_step_;
    Out out(times, states);
    while (t < times.back()) {
      const Y before = y;
      const double from = t;
      if (forces_ > most_forces || gsl_odeiv2_evolve_apply(driver.e, driver.c, driver.s, &system_, &t, times.back(), &h,
                                                           y.data()) != GSL_SUCCESS)
        return 0;
      out.put(from, t, y, [&](Y& at, double ahead) {
        Y error;
        const std::int64_t counted = forces_;
        at = before;
        gsl_odeiv2_step_apply(driver.s, from, ahead, at.data(), error.data(), nullptr, nullptr, &system_);
        forces_ = counted;
      });
    }
    return out.good() ? forces_ : 0;
  }

 private:
  [[gnu::flatten]] static int rate(double t, const double* y, double* dy, void* run) {
    auto& self = *static_cast<GslRun*>(run);
    ++self.forces_;
    self.motion_.rate(t, y, dy);
    return GSL_SUCCESS;
  }
  struct Free {
    void operator()(gsl_odeiv2_driver* driver) const { gsl_odeiv2_driver_free(driver); }
  };

  Motion<P> motion_;
  double first_step_;
  std::int64_t forces_ = 0;
  gsl_odeiv2_system system_{&GslRun::rate, nullptr, Motion<P>::X::size, this};
  std::unique_ptr<gsl_odeiv2_driver, Free> driver_;
};

template <class P>
Solver with_gsl(const Motion<P>& motion, const Setup& setup) {
  return [run = std::make_shared<GslRun<P>>(motion, setup)](std::span<const double> times, double* states) {
    return run->solve(times, states);
  };
}
#endif

template <template <class> class P>
std::vector<Peer> peers_of(const Request& scene) {
  const Motion<P<double>> motion(from_values<P<double>>(About<P>::fields, scene.scene->parameters), scene);
  std::vector<Peer> all;
  const auto add = [&](std::string_view name, auto* solver) {
    for (const double first_step : {1e-3, 1e-1})
      for (const double by_rate : {0, 1})
        all.push_back({name, [=](double tolerance) { return solver(motion, {first_step, by_rate, tolerance}); }});
  };
  add("fehlberg_78", &with_odeint<Fehlberg78, P<double>>);
  add("dormand_prince_5", &with_odeint<DormandPrince5, P<double>>);
#ifdef LEAST_HAS_GSL
  gsl_set_error_handler_off();  // else an error would end the process
  add("rk8pd", &with_gsl<P<double>>);
#endif
  return all;
}

}  // namespace

std::vector<Peer> bench::peers(const Request& scene) {
  const std::string_view id = scene.scene->card().id;
  if (id == "kepler") return peers_of<Kepler>(scene);
  if (id == "damped_kepler") return peers_of<DampedKepler>(scene);
  if (id == "damped_oscillator") return peers_of<DampedOscillator>(scene);
  if (id == "perturbed_kepler") return peers_of<PerturbedKepler>(scene);
  if (id == "lane_emden") return peers_of<LaneEmden>(scene);
  if (id == "van_der_pol") return peers_of<VanDerPol>(scene);
  if (id == "spin_orbit") return peers_of<SpinOrbit>(scene);
  if (id == "pendulum") return peers_of<Pendulum>(scene);
  if (id == "henon_heiles") return peers_of<HenonHeiles>(scene);
  if (id == "driven_oscillator") return peers_of<DrivenOscillator>(scene);
  if (id == "scalar_field_cosmology") return peers_of<ScalarFieldCosmology>(scene);
  throw std::out_of_range(std::string(id));
}

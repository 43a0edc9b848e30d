// JacobiMaupertuisHybrid chooses the steps of the scheme (core/schemes/jacobi_maupertuis.hpp) for any kind of problem,
// through a motion:
//   Motion::Number, Motion::Site    a Site has q, p, what is known of the mechanics there, and the time taken so far
//   motion.site(), motion.numbers() make a Site, and as many numbers as there are coordinates
//   motion.size()                   degrees of freedom
//   motion.look(x, work)            computes what is known of the mechanics at x
//   motion.velocity(x, v)           v = g⁻¹p
//   motion.kinetic(x)               K, from what is known at x
//   motion.scale(x, i)              √g_ii: a length along a coordinate
//   motion.steepness(x)             |∇V|_{g⁻¹}
//   motion.gap(x)                   E₀ − V
//   motion.in_time(x, h, work)      a variational step, see `variational_step`
//   motion.along(x, σ, δ, sign, work), motion.energy_root(x, σ)   see `JacobiMaupertuisStep`
//   motion.step_energy(x, y, h)     E_d of a step in time
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/composition.hpp"
#include "core/scheme.hpp"

namespace least {

enum class ParameterRule : std::uint8_t { automatic, slope, speed };
inline constexpr std::array<std::string_view, 3> parameter_rule_names{"automatic", "slope", "speed"};
enum class Exit : std::uint8_t { nominal, paper };
inline constexpr std::array<std::string_view, 2> exit_names{"nominal", "paper"};

/// Returns the step h in time near h₀ with E_d = E₀, which continues the last step of the Jacobi–Maupertuis principle.
/// excess(h, solved) returns E_d − E₀ of a step h, and clears `solved` where there is no such step. The secant method
/// starts from h₀ and 1.02 h₀; the result is empty where it finds no h within [h₀/4, 4h₀].
template <class T, class Excess>
std::optional<T> paper_exit_step(const T& h0, Excess&& excess) {
  using least::abs;
  const T tolerance = std::sqrt(Precision<T>::epsilon) * h0;  // the secant method squares it, or nearly
  bool solved = true;
  T before = h0, h = 1.02 * h0, f_before = excess(before, solved);
  for (int k = 0; k < 50 && solved; ++k) {
    const T f = excess(h, solved), change = f * (h - before) / (f - f_before);
    before = h;
    f_before = f;
    if (f < T(0) || f > T(0)) h = h - change;
    if (abs(h - before) <= tolerance) {
      const T ratio = h / h0;
      if (ratio >= T(0.25) && ratio <= T(4)) return h;
      break;
    }
  }
  return std::nullopt;
}

template <class Motion>
class JacobiMaupertuisHybrid {
 public:
  using T = typename Motion::Number;
  using Site = typename Motion::Site;

  template <class Settings>
  JacobiMaupertuisHybrid(const Motion& motion, const Settings& s);

  const Motion& motion() const { return motion_; }
  /// The state of the motion. Whoever changes it has to call `look` then.
  Site& here() { return here_; }
  const Site& here() const { return here_; }
  void look() { motion_.look(here_, work_); }
  /// Resets what steps remember, for a run with another energy.
  void start_anew(const T& energy) {
    motion_.energy = energy;
    length_ = T(step_);
    last_fast_ = T(0);
  }
  /// Takes a step: moves `here` to its end and sets here().elapsed to the time it took. A failure leaves `here`
  /// unchanged.
  StepStatus step();
  /// How the last step was taken.
  const ActiveMethod& active_method() const { return course_; }
  /// Goes on as after a step that was taken as `course` says.
  void go_on(const ActiveMethod& course) { course_ = course; }
  const Work& work() const { return work_; }
  /// Returns the discrete energy of a step that took the time h from x, as `course` says. Along a coordinate it is E₀,
  /// which determines h.
  T discrete_energy(Site x, const T& h, const ActiveMethod& course) const;
  /// The number of steps that were taken in time because none along a coordinate could be taken.
  std::int64_t fallback_steps() const { return rescues_; }

 private:
  using Scalar = typename Underlying<T>::type;
  using Numbers = decltype(std::declval<const Motion&>().numbers());

  StepStatus fast_step(Site& x, ActiveMethod& course);
  /// With θ halved k times.
  bool try_step(Site& x, std::size_t sigma, int k);
  StepStatus slow_step(Site& x, const T& h);
  StepStatus rescue(Site& x, ActiveMethod& course, int k);
  std::size_t parameter(int present) const;
  int halvings(const Site& x, std::size_t sigma);
  std::optional<T> exit_step(const Site& x);

  Motion motion_;
  bool midpoint_;
  ParameterRule rule_;
  Exit exit_;
  bool root_;
  double step_, theta_, critical_, hysteresis_, parameter_hysteresis_, alpha_max_;
  const Weights<Scalar>* weights_;
  Site here_, moved_, trial_;
  Numbers v_, weight_;  ///< velocities v_i, and √g_ii |v_i|
  T length_;            ///< length of a step in time
  T last_fast_{};       ///< time of the last fast step
  ActiveMethod course_;
  Work work_;
  std::int64_t rescues_ = 0;
};

template <class Motion>
template <class Settings>
JacobiMaupertuisHybrid<Motion>::JacobiMaupertuisHybrid(const Motion& motion, const Settings& s)
    : motion_(motion),
      midpoint_(s.quadrature == decltype(s.quadrature)::midpoint),
      rule_(s.parameter_rule),
      exit_(s.exit),
      root_(s.energy_root),
      step_(s.step),
      theta_(s.theta),
      critical_(std::isnan(s.critical_kinetic_energy) ? std::numeric_limits<double>::infinity()
                                                      : s.critical_kinetic_energy),
      hysteresis_(s.hysteresis),
      parameter_hysteresis_(s.parameter_hysteresis),
      alpha_max_(std::isnan(s.alpha_max) ? std::numeric_limits<double>::infinity() : s.alpha_max),
      weights_(&Weights<Scalar>::of(s.order == 2   ? Composition::none
                                    : s.order == 4 ? Composition::suzuki_4
                                                   : Composition::kahan_li_6)),
      here_(motion.site()),
      moved_(here_),
      trial_(here_),
      v_(motion.numbers()),
      weight_(v_),
      length_(s.step) {}

template <class Motion>
StepStatus JacobiMaupertuisHybrid<Motion>::step() {
  Site& y = moved_;
  y = here_;
  y.elapsed = T(0);
  ActiveMethod course = course_;
  T length = length_;
  if (course.mode == Mode::hamilton && motion_.kinetic(y) > T(critical_)) {
    course = {Mode::jacobi_maupertuis, -1};
    if (midpoint_) motion_.look(y, work_);  // which steps in time have no need to do
  } else if (course.mode == Mode::jacobi_maupertuis && motion_.gap(y) < T(hysteresis_) * T(critical_)) {
    course = {};
    length = T(step_);
    if (exit_ == Exit::paper)
      if (const auto h = exit_step(y)) length = *h;
  }
  const bool fast = course.mode == Mode::jacobi_maupertuis;
  const StepStatus status = fast ? fast_step(y, course) : slow_step(y, length);
  if (status != StepStatus::ok) return status;
  if (fast) last_fast_ = y.elapsed;
  course_ = course;
  length_ = length;
  std::swap(here_, moved_);
  return StepStatus::ok;
}

template <class Motion>
std::optional<typename Motion::Number> JacobiMaupertuisHybrid<Motion>::exit_step(const Site& x) {
  Site y = x;
  return paper_exit_step(last_fast_, [&](const T& h, bool& solved) {
    y = x;
    solved = solved && motion_.in_time(y, h, work_) == StepStatus::ok;
    return T(motion_.step_energy(x, y, h) - motion_.energy);
  });
}

template <class Motion>
StepStatus JacobiMaupertuisHybrid<Motion>::slow_step(Site& x, const T& h) {
  for (int i = 0; i < weights_->stages; ++i) {
    const T part = weights_->gamma[static_cast<std::size_t>(i)] * h;
    if (const StepStatus status = motion_.in_time(x, part, work_); status != StepStatus::ok) return status;
  }
  x.elapsed = x.elapsed + h;
  return StepStatus::ok;
}

template <class Motion>
std::size_t JacobiMaupertuisHybrid<Motion>::parameter(int present) const {
  using least::abs;
  if (motion_.size() == 2) {
    if (rule_ == ParameterRule::slope) return abs(v_[1]) > 2 * abs(v_[0]) ? 1 : 0;
    if (rule_ == ParameterRule::speed) return abs(v_[1]) > T(2) ? 1 : 0;
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < motion_.size(); ++i)
    if (weight_[i] > weight_[best]) best = i;
  if (present < 0) return best;
  const auto now = static_cast<std::size_t>(present);
  return weight_[best] > parameter_hysteresis_ * weight_[now] ? best : now;
}

/// Returns how often θ has to be halved so that the orbit turns by at most alpha_max. The way along the orbit is at
/// most √n times that of q^σ if σ is the fastest coordinate; √n is taken then, and the true ratio for others.
template <class Motion>
int JacobiMaupertuisHybrid<Motion>::halvings(const Site& x, std::size_t sigma) {
  using least::sqrt;
  if (!(alpha_max_ < 1e300)) return 0;
  const T slope = motion_.steepness(x), least_way = T(std::sqrt(static_cast<double>(motion_.size())));
  T way = sqrt(2 * motion_.kinetic(x)) / weight_[sigma];
  if (!(way > least_way)) way = least_way;
  T alpha = way * theta_ * motion_.scale(x, sigma) * slope / (2 * motion_.gap(x));
  int k = 0;
  for (; k <= 31 && !(alpha <= T(alpha_max_)); ++k) alpha = 0.5 * alpha;
  return alpha > T(0) || slope <= T(0) ? k : 32;  // E₀ − V ≤ 0: no step is short enough
}

/// Takes a step along q^σ of length θ/2ᵏ in the direction of motion, composed. Returns false where it fails, and leaves
/// x undefined.
template <class Motion>
bool JacobiMaupertuisHybrid<Motion>::try_step(Site& x, std::size_t sigma, int k) {
  motion_.velocity(x, v_);
  const double length = std::ldexp(theta_, -k);
  const T delta = v_[sigma] < T(0) ? T(-length) : T(length);
  if (motion_.size() == 1) return motion_.along(x, 0, delta, 1, work_) == StepStatus::ok;
  for (int i = 0; i < weights_->stages; ++i) {
    const Scalar gamma = weights_->gamma[static_cast<std::size_t>(i)];
    if (motion_.along(x, sigma, gamma * delta, gamma < Scalar(0) ? -1 : 1, work_) != StepStatus::ok) return false;
    if (root_ && !motion_.energy_root(x, sigma)) return false;
  }
  return x.elapsed > T(0);
}

template <class Motion>
StepStatus JacobiMaupertuisHybrid<Motion>::fast_step(Site& x, ActiveMethod& course) {
  using least::abs;
  motion_.velocity(x, v_);
  for (std::size_t i = 0; i < motion_.size(); ++i) weight_[i] = motion_.scale(x, i) * abs(v_[i]);
  const std::size_t first = parameter(course.parameter);
  const int k = halvings(x, first);
  if (k > 30) return StepStatus::underflow;
  trial_ = x;
  if (try_step(trial_, first, k)) {
    course.parameter = static_cast<int>(first);
    std::swap(x, trial_);
    return StepStatus::ok;
  }
  // Tries the other coordinates by weight, then all of them at half the length; of many, those that move most.
  constexpr std::size_t most_tried = 8;
  for (int shorter = 0; shorter < 2; ++shorter) {
    auto left = weight_;
    for (std::size_t tried = 0; tried < std::min(motion_.size(), most_tried); ++tried) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < motion_.size(); ++i)
        if (left[i] > left[best]) best = i;
      left[best] = T(-1);
      if (shorter == 0 && best == first) continue;
      trial_ = x;
      if (!try_step(trial_, best, halvings(x, best) + shorter)) continue;
      course.parameter = static_cast<int>(best);
      std::swap(x, trial_);
      return StepStatus::ok;
    }
  }
  return rescue(x, course, k);
}

/// One step in time, as short as the step along the orbit would have been.
template <class Motion>
StepStatus JacobiMaupertuisHybrid<Motion>::rescue(Site& x, ActiveMethod& course, int k) {
  using least::sqrt;
  T h = std::ldexp(theta_, -k) / sqrt(2 * motion_.kinetic(x));
  if (!(h < T(step_))) h = T(step_);
  course.parameter = -1;
  ++rescues_;
  const StepStatus status = slow_step(x, h);
  if (midpoint_) motion_.look(x, work_);
  return status;
}

template <class Motion>
typename Motion::Number JacobiMaupertuisHybrid<Motion>::discrete_energy(Site x, const T& h,
                                                                        const ActiveMethod& course) const {
  if (course.parameter >= 0) return motion_.energy;
  T sum(0);
  Work work;
  motion_.look(x, work);
  Site y = x;
  for (int i = 0; i < weights_->stages; ++i) {
    const Scalar gamma = weights_->gamma[static_cast<std::size_t>(i)];
    const T part = gamma * h;
    if (motion_.in_time(y, part, work) != StepStatus::ok) return T(std::numeric_limits<double>::quiet_NaN());
    sum = sum + gamma * motion_.step_energy(x, y, part);
    x = y;
  }
  return sum;
}

}  // namespace least

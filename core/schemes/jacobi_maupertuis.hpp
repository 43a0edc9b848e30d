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

#include "core/schemes/jacobi_maupertuis_step.hpp"

namespace least {

enum class ParameterRule : std::uint8_t { automatic, slope, speed };
inline constexpr std::array<std::string_view, 3> parameter_rule_names{"automatic", "slope", "speed"};
enum class Exit : std::uint8_t { nominal, paper };
inline constexpr std::array<std::string_view, 2> exit_names{"nominal", "paper"};

struct JacobiMaupertuis;

template <Conservative P, class X>
class JacobiMaupertuisStepper {
 public:
  using T = typename X::Number;
  static constexpr std::size_t n = P::dof;

  JacobiMaupertuisStepper(const P& problem, const X& x, const T& energy, const JacobiMaupertuis& settings);

  StepStatus step(X& x) noexcept;
  /// How the last step was taken.
  const ActiveMethod& active_method() const { return course_; }
  /// As after a step that was taken in this way.
  void go_on(const ActiveMethod& course) { course_ = course; }
  Work work() const { return work_; }
  /// Of the step from a to b, taken in this way: along a coordinate it is E₀ by the length that the step has.
  T discrete_energy(const X& a, const X& b, const ActiveMethod& course) const;
  /// Steps that had to be taken in time because none along a coordinate could be.
  std::int64_t fallback_steps() const { return rescues_; }

 private:
  using Site = StepEnd<P, T>;
  using Scalar = typename Underlying<T>::type;

  T kinetic(const Site& x) const { return 0.5 * dot(x.p, velocity(problem_, x.q, x.p)); }
  void look(Site& x) {
    x.here = Slopes<P, T>(problem_, x.q);
    ++work_.forces;
  }
  StepStatus fast_step(Site& x, ActiveMethod& course);
  /// With θ halved k times.
  bool try_step(Site& x, std::size_t sigma, int k);
  StepStatus slow_step(Site& x, const T& h);
  StepStatus rescue(Site& x, ActiveMethod& course, int k);
  std::size_t parameter(const Vec<P::dof, T>& weight, const Vec<P::dof, T>& v, int present) const;
  int halvings(const Site& x, std::size_t sigma, const Vec<P::dof, T>& weight) const;
  /// √g_σσ, by σ: lengths along the coordinates.
  Vec<P::dof, T> scales(const Site& x) const;

  P problem_;
  Quadrature quadrature_;
  ParameterRule rule_;
  Exit exit_;
  bool root_;
  double step_, theta_, critical_, hysteresis_, parameter_hysteresis_, alpha_max_;
  const Weights<Scalar>* weights_;
  T energy_;
  Slopes<P, T> here_;  ///< at the state's q
  T length_;           ///< of a step in time
  T last_fast_{};      ///< time of the last fast step
  ActiveMethod course_;
  Work work_;
  std::int64_t rescues_ = 0;
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
  /// The same without steps along a coordinate: their length in time is bounded, as that of other schemes.
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

template <Conservative P, class X>
JacobiMaupertuisStepper<P, X>::JacobiMaupertuisStepper(const P& problem, const X& x, const T& energy,
                                                       const JacobiMaupertuis& s)
    : problem_(problem),
      quadrature_(s.quadrature),
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
      energy_(energy),
      here_(problem, x.q),
      length_(s.step) {
  ++work_.forces;
}

template <Conservative P, class X>
StepStatus JacobiMaupertuisStepper<P, X>::step(X& x) noexcept {
  Site y{x.q, x.p, here_, T(0)};
  ActiveMethod course = course_;
  T length = length_;
  if (course.mode == Mode::hamilton && kinetic(y) > T(critical_)) {
    course = {Mode::jacobi_maupertuis, -1};
    if (quadrature_ == Quadrature::midpoint) look(y);  // which steps in time have no need to do
  } else if (course.mode == Mode::jacobi_maupertuis && energy_ - y.here.potential < T(hysteresis_) * T(critical_)) {
    course = {};
    length = T(step_);
    if (exit_ == Exit::paper)
      if (const auto h = paper_exit_step(problem_, quadrature_, y, energy_, last_fast_, work_)) length = *h;
  }
  const bool fast = course.mode == Mode::jacobi_maupertuis;
  const StepStatus status = fast ? fast_step(y, course) : slow_step(y, length);
  if (status != StepStatus::ok) return status;
  if (fast) last_fast_ = y.elapsed;
  course_ = course;
  length_ = length;
  here_ = y.here;
  x.q = y.q;
  x.p = y.p;
  x.t = x.t + y.elapsed;
  return StepStatus::ok;
}

template <Conservative P, class X>
StepStatus JacobiMaupertuisStepper<P, X>::slow_step(Site& x, const T& h) {
  for (int i = 0; i < weights_->stages; ++i) {
    const T part = weights_->gamma[static_cast<std::size_t>(i)] * h;
    if (const StepStatus status = variational_step(problem_, quadrature_, x.q, x.p, x.here, part, work_);
        status != StepStatus::ok)
      return status;
  }
  x.elapsed = x.elapsed + h;
  return StepStatus::ok;
}

template <Conservative P, class X>
Vec<P::dof, typename X::Number> JacobiMaupertuisStepper<P, X>::scales(const Site& x) const {
  using least::sqrt;
  Vec<P::dof, T> scale;
  for (std::size_t i = 0; i < n; ++i) {
    Vec<P::dof, T> unit{};
    unit[i] = T(1);
    scale[i] = sqrt(x.here.lower(problem_, unit)[i]);
  }
  return scale;
}

template <Conservative P, class X>
std::size_t JacobiMaupertuisStepper<P, X>::parameter(const Vec<P::dof, T>& weight, const Vec<P::dof, T>& v,
                                                     int present) const {
  using least::abs;
  if constexpr (n == 2) {
    if (rule_ == ParameterRule::slope) return abs(v[1]) > 2 * abs(v[0]) ? 1 : 0;
    if (rule_ == ParameterRule::speed) return abs(v[1]) > T(2) ? 1 : 0;
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < n; ++i)
    if (weight[i] > weight[best]) best = i;
  if (present < 0) return best;
  const auto now = static_cast<std::size_t>(present);
  return weight[best] > parameter_hysteresis_ * weight[now] ? best : now;
}

/// How often θ is to be halved for the orbit not to turn by more than alpha_max. The way that a step of q^σ leads along
/// the orbit is √n of that of q^σ at most, where σ is the fastest coordinate; for another it is what it is.
template <Conservative P, class X>
int JacobiMaupertuisStepper<P, X>::halvings(const Site& x, std::size_t sigma, const Vec<P::dof, T>& weight) const {
  using least::sqrt;
  if (!(alpha_max_ < 1e300)) return 0;
  const T slope = sqrt(dot(x.here.gradient, x.here.raise(problem_, x.here.gradient)));
  T way = sqrt(2 * kinetic(x)) / weight[sigma];
  if (!(way > T(std::sqrt(double(n))))) way = T(std::sqrt(double(n)));
  T alpha = way * theta_ * scales(x)[sigma] * slope / (2 * (energy_ - x.here.potential));
  int k = 0;
  for (; k <= 31 && !(alpha <= T(alpha_max_)); ++k) alpha = 0.5 * alpha;
  return alpha > T(0) || slope <= T(0) ? k : 32;  // E₀ − V ≤ 0: no step is short enough
}

/// A step along q^σ of length θ/2ᵏ in the direction of motion, composed; x is spoilt where it fails.
template <Conservative P, class X>
bool JacobiMaupertuisStepper<P, X>::try_step(Site& x, std::size_t sigma, int k) {
  const JacobiMaupertuisStep<P, T> principle(problem_, quadrature_, energy_);
  const T v = x.here.raise(problem_, x.p)[sigma];
  const double length = std::ldexp(theta_, -k);
  const T delta = v < T(0) ? T(-length) : T(length);
  if constexpr (n == 1) return principle.step(x, 0, delta, 1, work_) == StepStatus::ok;
  for (int i = 0; i < weights_->stages; ++i) {
    const Scalar gamma = weights_->gamma[static_cast<std::size_t>(i)];
    if (principle.step(x, sigma, gamma * delta, gamma < Scalar(0) ? -1 : 1, work_) != StepStatus::ok) return false;
    if (root_ && !principle.energy_root(x, sigma)) return false;
  }
  return x.elapsed > T(0);
}

template <Conservative P, class X>
StepStatus JacobiMaupertuisStepper<P, X>::fast_step(Site& x, ActiveMethod& course) {
  using least::abs;
  const auto v = x.here.raise(problem_, x.p), scale = scales(x);
  Vec<P::dof, T> weight;
  for (std::size_t i = 0; i < n; ++i) weight[i] = scale[i] * abs(v[i]);
  const std::size_t first = parameter(weight, v, course.parameter);
  const int k = halvings(x, first, weight);
  if (k > 30) return StepStatus::underflow;
  Site y = x;
  if (try_step(y, first, k)) {
    course.parameter = static_cast<int>(first);
    x = y;
    return StepStatus::ok;
  }
  // The other coordinates by weight, then all of them at half the length.
  for (int shorter = 0; shorter < 2; ++shorter) {
    auto left = weight;
    for (std::size_t tried = 0; tried < n; ++tried) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < n; ++i)
        if (left[i] > left[best]) best = i;
      left[best] = T(-1);
      if (shorter == 0 && best == first) continue;
      y = x;
      if (!try_step(y, best, halvings(x, best, weight) + shorter)) continue;
      course.parameter = static_cast<int>(best);
      x = y;
      return StepStatus::ok;
    }
  }
  return rescue(x, course, k);
}

template <Conservative P, class X>
typename X::Number JacobiMaupertuisStepper<P, X>::discrete_energy(const X& a, const X& b,
                                                                  const ActiveMethod& course) const {
  if (course.parameter >= 0) return energy_;
  Site x{a.q, a.p, Slopes<P, T>(problem_, a.q), T(0)};
  T sum(0);
  Work work;
  for (int i = 0; i < weights_->stages; ++i) {
    const Scalar gamma = weights_->gamma[static_cast<std::size_t>(i)];
    const T part = gamma * (b.t - a.t);
    Site y = x;
    if (variational_step(problem_, quadrature_, y.q, y.p, y.here, part, work) != StepStatus::ok)
      return T(std::numeric_limits<double>::quiet_NaN());
    sum = sum + gamma * step_energy(problem_, quadrature_, x, y, part);
    x = y;
  }
  return sum;
}

/// One step in time, as short as the step along the orbit would have been.
template <Conservative P, class X>
StepStatus JacobiMaupertuisStepper<P, X>::rescue(Site& x, ActiveMethod& course, int k) {
  using least::sqrt;
  T h = std::ldexp(theta_, -k) / sqrt(2 * kinetic(x));
  if (!(h < T(step_))) h = T(step_);
  course.parameter = -1;
  ++rescues_;
  const StepStatus status = slow_step(x, h);
  if (quadrature_ == Quadrature::midpoint) look(x);
  return status;
}

}  // namespace least

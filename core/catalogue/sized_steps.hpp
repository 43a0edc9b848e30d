// Steps of equal length of scenes whose size is known only at run time, by explicit schemes: the maps of
// core/schemes/splitting.hpp, core/schemes/contact_leapfrog.hpp and core/schemes/runge_kutta.hpp, operation by
// operation, on components in one contiguous list. A stepper is bound to a state by `begin`, and allocates nothing
// after it is made. T is the number type of the steps: dual numbers give their tangents.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "core/catalogue/sized_table.hpp"
#include "core/run/equal_steps.hpp"
#include "core/schemes/contact_leapfrog.hpp"
#include "core/schemes/lifted_splitting.hpp"
#include "core/schemes/runge_kutta.hpp"
#include "core/schemes/splitting.hpp"

namespace least {

/// SizedKickDrift takes kicks and drifts in the order of a scheme's sequence.
template <class Scheme, class T = double>
class SizedKickDrift {
 public:
  SizedKickDrift(const text::SizedScene& scene, const Scheme& scheme)
      : scene_(&scene),
        scheme_(scheme),
        sequence_(&scheme_.template sequence<double>()),
        slope_(scene.coordinates),
        velocity_(scene.coordinates),
        inverse_masses_(scene.inverse_mass().begin(), scene.inverse_mass().end()) {
    const std::size_t n = scene.coordinates;
    if (!scene.has_full_mass() || n > most_dense) return;
    inverse_masses_.assign(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (const auto& [j, share] : scene.inverse_mass_matrix()[i]) inverse_masses_[i * n + j] = share;
  }

  void begin(const T* x, double t) {
    work_ = {};
    force(x, t);
  }
  StepStatus step(T* x, double t, double h) noexcept {
    kick(x, h * sequence_->kick[0]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(sequence_->drifts); ++i) {
      drift(x, h * sequence_->drift[i]);
      force(x, t + h * sequence_->node[i]);
      kick(x, h * sequence_->kick[i + 1]);
    }
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }
  /// E_d of a step of length h from a state as these schemes define it: K of the drift, plus V at its start (symplectic
  /// Euler) or the mean of V at both ends (leapfrog).
  double step_energy(StateView from,
                     double h) requires(std::is_same_v<Scheme, Leapfrog> || std::is_same_v<Scheme, SymplecticEuler>) {
    constexpr bool both_ends = std::is_same_v<Scheme, Leapfrog>;
    std::vector<T> x(from.numbers, from.numbers + 2 * slope_.size());
    double gone = 0, sum = 0;
    force(x.data(), from.t);
    for (std::size_t i = 0; i < static_cast<std::size_t>(sequence_->drifts); ++i) {
      const double part = sequence_->drift[i], over = both_ends ? part / 2 : part;
      kick(x.data(), h * over);
      const double start = potential(x.data(), from.t + h * gone), kinetic = kinetic_energy(x.data());
      drift(x.data(), h * part);
      gone += part;
      if (both_ends) {
        force(x.data(), from.t + h * gone);
        kick(x.data(), h * over);
      }
      sum += part * (kinetic + (both_ends ? 0.5 * (start + potential(x.data(), from.t + h * gone)) : start));
    }
    return std::isfinite(sum) ? sum : unknown;
  }

 private:
  double potential(const T* q, double t) const {
    T value;
    scene_->potential.evaluate(q, t, &value);
    return plain_number(value);
  }
  double kinetic_energy(const T* x) {
    const T* const p = x + slope_.size();
    scene_->velocity(p, velocity_.data());
    T twice(0);
    for (std::size_t i = 0; i < slope_.size(); ++i) twice = twice + p[i] * velocity_[i];
    return 0.5 * plain_number(twice);
  }
  void force(const T* q, double t) {
    scene_->gradient.evaluate(q, t, slope_.data());
    ++work_.forces;
  }
  void kick(T* x, double h) const {
    T* const p = x + scene_->coordinates;
    for (std::size_t i = 0; i < slope_.size(); ++i) p[i] = p[i] - h * slope_[i];
  }
  void drift(T* x, double h) {
    const std::size_t n = slope_.size();
    const T* const p = x + n;
    const double* row = inverse_masses_.data();
    if (!scene_->has_full_mass()) {
      for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + (h * row[i]) * p[i];
      return;
    }
    if (n > most_dense) {
      scene_->velocity(p, velocity_.data());
      for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
      return;
    }
    for (std::size_t i = 0; i < n; ++i, row += n) {
      T velocity = row[0] * p[0];
      for (std::size_t j = 1; j < n; ++j) velocity = velocity + row[j] * p[j];
      x[i] = x[i] + h * velocity;
    }
  }

  /// The largest number of coordinates for which a metric that is not diagonal is stored as a dense matrix.
  static constexpr std::size_t most_dense = 16;

  const text::SizedScene* scene_;
  Scheme scheme_;  ///< keeps the sequence
  const Sequence<double>* sequence_;
  std::vector<T> slope_;  ///< ∇V at the state's q
  std::vector<T> velocity_;
  std::vector<double> inverse_masses_;  ///< of each coordinate, or the dense matrix, row-major
  Work work_;
};

/// SizedContactLeapfrog is for H = K + V + α(t) s, or K + V + γs²/2 − R.
template <class T = double>
class SizedContactLeapfrog {
 public:
  SizedContactLeapfrog(const text::SizedScene& scene, const ContactLeapfrog& scheme, std::size_t components)
      : scene_(&scene),
        acts_(components == scene.components),
        composition_(scheme.composition),
        weights_(&Weights<double>::of(composition_)),
        slope_(scene.coordinates),
        v_(scene.coordinates),
        velocity_(scene.coordinates) {}

  void begin(const T* x, double t) {
    work_ = {};
    look(x, t);
    if (!scene_->is_quadratic()) damping_ = scene_->damping_at(t);
  }
  /// If a step fails, the state and the stepper are undefined.
  StepStatus step(T* x, double t, double h) noexcept {
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i)
      if (!stage(x, weights_->gamma[i] * h, t + weights_->end[i] * h)) return StepStatus::singular;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  double flips_from() const { return least::flips_from(composition_); }
  /// E_d of a step of length h from a state, with V and s at both ends.
  double step_energy(StateView from, double h) {
    const std::size_t n = slope_.size();
    if (!acts_) return unknown;
    std::vector<T> x(from.numbers, from.numbers + scene_->components);
    begin(x.data(), from.t);
    double sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
      const T before = potential_ + action_energy(x[2 * n]);
      if (!stage(x.data(), weights_->gamma[i] * h, from.t + weights_->end[i] * h)) return unknown;
      T twice(0);  // p·v of the drift
      for (std::size_t k = 0; k < n; ++k) twice = twice + v_[k] * velocity_[k];
      sum += 0.5 * weights_->gamma[i] * plain_number(twice + before + potential_ + action_energy(x[2 * n]));
    }
    return std::isfinite(sum) ? sum : unknown;
  }

 private:
  void look(const T* q, double t) {
    if (acts_)
      potential_ = scene_->potential_with_gradient(q, t, slope_.data());
    else
      scene_->gradient.evaluate(q, t, slope_.data());
    ++work_.forces;
  }
  /// The part of H that depends on s, with α at the present time.
  T action_energy(const T& s) const { return scene_->is_quadratic() ? scene_->action_energy(s, 0) : T(damping_ * s); }
  bool stage(T* x, double h, double end) {
    if (scene_->is_quadratic()) return quadratic_stage(x, h, end);
    const std::size_t n = slope_.size();
    const double next = scene_->damping_at(end), before = 1 - (h / 2) * damping_, under = 1 + (h / 2) * next;
    if (!(under > least_denominator)) return false;
    const double after = 1 / under;
    const T lagrangian = to_end(x, before, h, end);
    T* const p = x + n;
    for (std::size_t i = 0; i < n; ++i) p[i] = (v_[i] - (h * 0.5) * slope_[i]) * after;
    damping_ = next;
    if (acts_) x[2 * n] = (before * x[2 * n] + h * lagrangian) * after;
    return true;
  }
  bool quadratic_stage(T* x, double h, double end) {
    using least::sqrt;
    const std::size_t n = slope_.size();
    const double gamma = scene_->action_curvature;
    T& s = x[2 * n];
    const T lagrangian = to_end(x, T(1 - (h / 2) * (gamma * s)), h, end);
    const T r = s - (h / 4) * (gamma * (s * s)) + h * (lagrangian + scene_->offset), under = 1 + h * (gamma * r);
    if (!(under > T(0))) return false;
    s = 2 * r / (1 + sqrt(under));
    const T after = 1 + (h / 2) * (gamma * s);
    if (!(after > T(least_denominator))) return false;
    T* const p = x + n;
    for (std::size_t i = 0; i < n; ++i) p[i] = (v_[i] - (h * 0.5) * slope_[i]) / after;
    return true;
  }
  /// to_end takes half a kick and the drift; returns the mean of K − V over the ends.
  template <class Factor>
  T to_end(T* x, const Factor& before, double h, double end) {
    const std::size_t n = slope_.size();
    const T* const p = x + n;
    const T potential = potential_;
    for (std::size_t i = 0; i < n; ++i) v_[i] = before * p[i] - (h * 0.5) * slope_[i];
    scene_->velocity(v_.data(), velocity_.data());
    T work = v_[0] * velocity_[0];
    for (std::size_t i = 1; i < n; ++i) work = work + v_[i] * velocity_[i];
    for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
    look(x, end);
    return 0.5 * (work - (potential + potential_));
  }

  const text::SizedScene* scene_;
  bool acts_;                ///< states carry s
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::vector<T> slope_;  ///< ∇V at the state's q
  std::vector<T> v_, velocity_;
  T potential_{};       ///< V at the state's q
  double damping_ = 0;  ///< α at its time
  Work work_;
};

/// SizedRungeKutta is for explicit tableaux in which each stage depends on the one before alone, with weights at the
/// end.
template <int Stages, class T = double>
class SizedRungeKutta {
 public:
  static constexpr bool of_rates_alone = true;
  SizedRungeKutta(const text::SizedScene& scene, const ExplicitTableau<Stages>& tableau, std::size_t components)
      : rate_(components == scene.components ? &scene.rate : &scene.motion()),
        tableau_(tableau),
        slope_(components),
        sum_(slope_),
        y_(slope_) {}

  void begin(const T*, double) { work_ = {}; }
  StepStatus step(T* x, double t, double h) noexcept {
    const std::size_t size = slope_.size();
    rate_->evaluate(x, t, slope_.data());
    for (std::size_t k = 0; k < size; ++k) sum_[k] = tableau_.weight[0] * slope_[k];
    for (int i = 1; i < Stages; ++i) {
      const double part = h * tableau_.node[i];
      for (std::size_t k = 0; k < size; ++k) y_[k] = x[k] + part * slope_[k];
      rate_->evaluate(y_.data(), t + part, slope_.data());
      for (std::size_t k = 0; k < size; ++k) sum_[k] = sum_[k] + tableau_.weight[i] * slope_[k];
    }
    const double whole = h / tableau_.divisor;
    for (std::size_t k = 0; k < size; ++k) x[k] = x[k] + whole * sum_[k];
    work_.forces += Stages;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  const text::StateFormula* rate_;
  ExplicitTableau<Stages> tableau_;
  std::vector<T> slope_, sum_, y_;
  Work work_;
};

/// SizedLifted is for a general Hamiltonian that has a lift.
template <class T = double>
class SizedLifted {
 public:
  SizedLifted(const text::SizedScene& scene, const LiftedSplitting& scheme)
      : scene_(&scene), map_(scene.lift, scheme.composition, scheme.lift), slope_(scene.coordinates + 1) {}

  void begin(const T* x, double t) { map_.begin(x, t, slope_.data()); }
  /// If a step fails, the state and the stepper are undefined.
  StepStatus step(T* x, double t, double h) noexcept {
    const std::size_t n = scene_->coordinates;
    return map_.step({x, x + n, scene_->acting ? x + 2 * n : nullptr, slope_.data()}, t, h);
  }
  const Work& work() const { return map_.work(); }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  const text::SizedScene* scene_;
  LiftedMap<T> map_;
  std::vector<T> slope_;  ///< ∇V and V at the state
};

template <class Stepper>
class SizedSteps final : public EqualSteps {
 public:
  SizedSteps(const ProblemTable& table, Stepper stepper, const RunState& x, const Grid& grid)
      : EqualSteps(table, x, grid),
        stepper_(std::move(stepper)),
        left_stepper_(stepper_),
        trial_(stepper_),
        has_domain_(!std::isnan(table.inside({x.t, x.numbers.data()}))) {
    stepper_.begin(x.numbers.data(), x.t);
  }
  std::string unsupported_reason() const override {
    if constexpr (requires { stepper_.unsupported_reason(); }) return stepper_.unsupported_reason();
    return {};
  }

 private:
  BlockResult block(IntegrationState& state, std::int64_t count, StepGuard& guard, double* rows) override {
    double* const x = state.x.numbers.data();
    const std::size_t size = state.x.size();
    const bool with_pole = problem_.traits.quadratic_contact && !of_rates_alone();
    const double* const s = with_pole ? x + 2 * problem_.traits.dof : nullptr;
    double lowest = 0;
    bool left = false;
    StepStatus status = StepStatus::ok;
    const std::int64_t end = state.n + count;
    while (state.n < end) {
      status = stepper_.step(x, state.x.t, grid_.step);
      if (status != StepStatus::ok) return BlockResult::failed(status);
      state.x.t = grid_.time(++state.n);
      if (s) lowest = std::min(lowest, *s);
      if (has_domain_) left = left || problem_.outside({state.x.t, x});
      if (!rows) continue;
      *rows++ = state.x.t;
      rows = std::copy_n(x, size, rows);
    }
    if (state.n == grid_.steps && grid_.tail == 0) state.x.t = grid_.end;
    if (s && -problem_.action_curvature() * lowest * grid_.step > 2) return BlockResult::failed(StepStatus::singular);
    if (!is_finite_state(problem_.traits, state.x)) return {BlockEnd::not_finite};
    if (left) return {BlockEnd::left_domain};
    return guard.exceeded() ? BlockResult{BlockEnd::too_fast} : BlockResult{};
  }
  StepStatus last_step(RunState& x, double h) override { return stepper_.step(x.numbers.data(), x.t, h); }
  StepStatus trial_step(StepperAt stands, RunState& x, double h) const override {
    trial_ = stands == StepperAt::here ? stepper_ : left_stepper_;
    return trial_.step(x.numbers.data(), x.t, h);
  }
  StepStatus bound_step(RunState& x, double h) const override {
    trial_.begin(x.numbers.data(), x.t);
    return trial_.step(x.numbers.data(), x.t, h);
  }
  void bind_stepper(StateView x) override { stepper_.begin(x.numbers, x.t); }
  void keep_stepper() override { left_stepper_ = stepper_; }
  void take_stepper_back() override { stepper_ = left_stepper_; }
  Work stepper_work() const override { return stepper_.work(); }
  bool starts_at_singularity() const override { return false; }
  bool of_rates_alone() const override { return OfRatesAlone<Stepper>; }
  double energy_of_step([[maybe_unused]] StateView from, [[maybe_unused]] double h) const override {
    if constexpr (requires { trial_.step_energy(from, h); }) return trial_.step_energy(from, h);
    return unknown;
  }
  DampingLimits damping_limits() const override {
    DampingLimits limits;
    limits.flips = stepper_.flips_from();
    if constexpr (requires { stepper_.stiff_from(); }) limits.stiff = stepper_.stiff_from();
    return limits;
  }

  Stepper stepper_, left_stepper_;  ///< at the state, and where the last block (or step) began
  mutable Stepper trial_;
  bool has_domain_;  ///< whether the motion has a domain that steps may leave
};

}  // namespace least

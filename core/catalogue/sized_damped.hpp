// Steps of equal length of contact scenes H = K + V + α(t) s, or K + V + γs²/2 − R, whose size is known only at run
// time: the maps of core/schemes/contact_splitting.hpp and core/schemes/contact_symplectic_euler.hpp, operation by
// operation, on components in one contiguous list. As in core/catalogue/sized_steps.hpp nothing is allocated after a
// stepper is made, and T is the number type of the steps: dual numbers give their tangents.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "core/run/run_state.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "core/schemes/contact_symplectic_euler.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// SizedContactSplitting alternates drifts with kicks and damping.
template <class T = double>
class SizedContactSplitting {
 public:
  /// `components` of the states, with or without s.
  SizedContactSplitting(const text::SizedScene& scene, const ContactSplitting& scheme, std::size_t components)
      : scene_(&scene),
        acts_(components == scene.components),
        merged_(takes_as_one(scene, scheme)),
        scheme_(scheme),
        turns_(&turns_of(scheme_)),
        slope_(scene.coordinates),
        velocity_(scene.coordinates) {}

  void begin(const T*, double) { work_ = {}; }
  StepStatus step(T* x, double t, double h) noexcept {
    const auto stages = static_cast<std::size_t>(turns_->stages);
    const bool steady = scene_->constant_damping || scene_->is_quadratic();
    if (steady && h != prepared_) {
      prepared_ = h;
      for (std::size_t i = 0; i < stages; ++i) flows_[i] = flow(turns_->kick[i] * h, t);
    }
    for (std::size_t i = 0; i < stages; ++i) {
      drift(x, turns_->drift[i] * h);
      const double part = turns_->kick[i] * h, middle = t + turns_->middle[i] * h;
      if (!push(x, part, middle, steady ? flows_[i] : flow(part, middle))) return StepStatus::singular;
    }
    drift(x, turns_->drift[stages] * h);
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }
  /// The merged flow of damping and force is exact.
  double stiff_from() const { return merged_ ? std::numeric_limits<double>::infinity() : 2; }

 private:
  using Flow = ActionFlow<double>;

  static const Alternation<double>& turns_of(const ContactSplitting& scheme) {
    if (const auto i = alternation_of(scheme.splitting)) return Alternation<double>::named(*i);
    return Alternation<double>::of(scheme.composition);
  }
  static bool takes_as_one(const text::SizedScene& scene, const ContactSplitting& scheme) {
    if (scheme.splitting != Splitting::automatic) return scheme.splitting >= Splitting::merged;
    if (scene.is_quadratic()) return true;
    return scene.constant_damping && scene.damping_at(0) * scheme.step > 0.5;
  }
  /// The flow over h of the part of H that depends on s, with α at the time t.
  Flow flow(double h, double t) const {
    if (scene_->is_quadratic()) {
      if (!merged_) return {1, h};
      return quadratic_flow(scene_->action_curvature * scene_->offset / 2, h);
    }
    const double z = -(h * scene_->damping_at(t));
    return {std::exp(z), merged_ ? h * phi1(z) : h};
  }

  /// B½ A B½, or merged AB, of a momentum x with the slope of V as `push`, or of s with V.
  T pushed(const T& x, const T& push, double h, const Flow& c) const {
    const double half = h * 0.5;
    return merged_ ? T(c.e * x - c.f * push) : T(c.e * (x - half * push) - half * push);
  }
  /// Damping and kick over h. False: the flow of s has a pole on the way.
  bool push(T* x, double h, double t, const Flow& c) {
    const std::size_t n = slope_.size();
    scene_->gradient.evaluate(x, t, slope_.data());
    ++work_.forces;
    T potential(0);
    if (acts_) scene_->potential.evaluate(x, t, &potential);
    if (scene_->is_quadratic()) return push_quadratic(x, potential, h, c);
    T* const p = x + n;
    for (std::size_t i = 0; i < n; ++i) p[i] = pushed(p[i], slope_[i], h, c);
    if (acts_) x[2 * n] = pushed(x[2 * n], potential, h, c);
    return true;
  }
  bool push_quadratic(T* x, T potential, double h, const Flow& c) {
    const double half = h * 0.5, offset = scene_->offset;
    const std::size_t n = slope_.size();
    if (!merged_) potential = potential - offset;
    T& s = x[2 * n];
    s = s - half * potential;
    const T d = c.e + (0.5 * scene_->action_curvature) * (s * c.f);
    if (!(d > T(0))) return false;
    T* const p = x + n;
    for (std::size_t i = 0; i < n; ++i) p[i] = (p[i] - half * slope_[i]) / (d * d) - half * slope_[i];
    s = (merged_ ? T(s * c.e + offset * c.f) : T(s * c.e)) / d - half * potential;
    return true;
  }
  void drift(T* x, double h) {
    const std::size_t n = slope_.size();
    const T* const p = x + n;
    scene_->velocity(p, velocity_.data());
    for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
    if (!acts_) return;
    T work = p[0] * velocity_[0];
    for (std::size_t i = 1; i < n; ++i) work = work + p[i] * velocity_[i];
    x[2 * n] = x[2 * n] + (h * 0.5) * work;
  }

  const text::SizedScene* scene_;
  bool acts_;                ///< states carry s
  bool merged_;              ///< the flow of A + B is taken as one
  ContactSplitting scheme_;  ///< keeps the turns
  const Alternation<double>* turns_;
  std::vector<T> slope_, velocity_;
  double prepared_ = std::numeric_limits<double>::quiet_NaN();  ///< the step that flows_ are for
  std::array<Flow, compositions::most_stages> flows_{};         ///< for every stage if α is constant
  Work work_;
};

/// SizedContactEuler evaluates L at the start of the step.
template <class T = double>
class SizedContactEuler {
 public:
  /// `components` of the states, with or without s.
  SizedContactEuler(const text::SizedScene& scene, const ContactSymplecticEuler&, std::size_t components)
      : scene_(&scene),
        acts_(components == scene.components),
        slope_(scene.coordinates),
        velocity_(scene.coordinates) {}

  void begin(const T*, double) { work_ = {}; }
  StepStatus step(T* x, double t, double h) noexcept {
    const std::size_t n = slope_.size();
    if (scene_->is_quadratic()) {
      const T factor = 1 - h * scene_->action_slope(x[2 * n], t);
      if (!(factor > T(least_denominator))) return StepStatus::singular;
      kick(x, factor, t, h);
    } else {
      kick(x, 1 - h * scene_->damping_at(t), t, h);
    }
    scene_->velocity(x + n, velocity_.data());
    if (acts_) {
      T& s = x[2 * n];
      s = s + h * (0.5 * twice_kinetic(x + n) - potential(x, t) - scene_->action_energy(s, t));
    }
    for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  double flips_from() const { return 1; }
  /// E_d of a step of length h from a state: K of its momentum at the end, V and s at the start.
  double step_energy(StateView from, double h) {
    if (!acts_) return unknown;
    const std::size_t n = slope_.size();
    std::vector<T> x(from.numbers, from.numbers + scene_->components);
    if (step(x.data(), from.t, h) != StepStatus::ok) return unknown;
    return 0.5 * twice_kinetic(x.data() + n) + potential(from.numbers, from.t) +
           scene_->action_energy(from[2 * n], from.t);
  }

 private:
  template <class Factor>
  void kick(T* x, const Factor& factor, double t, double h) {
    scene_->gradient.evaluate(x, t, slope_.data());
    ++work_.forces;
    T* const p = x + slope_.size();
    for (std::size_t i = 0; i < slope_.size(); ++i) p[i] = factor * p[i] - h * slope_[i];
  }
  T potential(const T* q, double t) const {
    T v;
    scene_->potential.evaluate(q, t, &v);
    return v;
  }
  /// p·v; velocity_ has to be that of p.
  T twice_kinetic(const T* p) const {
    T sum = p[0] * velocity_[0];
    for (std::size_t i = 1; i < velocity_.size(); ++i) sum = sum + p[i] * velocity_[i];
    return sum;
  }

  const text::SizedScene* scene_;
  bool acts_;  ///< states carry s
  std::vector<T> slope_, velocity_;
  Work work_;
};

}  // namespace least

// Scenes with a constant metric whose size is known only at run time, as problems and states for schemes that are
// written for fixed types: vectors are views of numbers stored elsewhere. A problem owns the vectors that it returns;
// each is valid until the next one of its kind is asked for, and a copy has its own.
#pragma once

#include <cstddef>
#include <vector>

#include "core/problem.hpp"
#include "core/schemes/damping_integral.hpp"
#include "core/schemes/transformed_stepper.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

template <class T>
struct VectorView {
  using value_type = T;
  T* first = nullptr;
  std::size_t count = 0;

  T& operator[](std::size_t i) const { return first[i]; }
  std::size_t size() const { return count; }
  T* begin() const { return first; }
  T* end() const { return first + count; }
};
template <class T>
T dot(const VectorView<T>& a, const VectorView<T>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < a.size(); ++i) sum = sum + a[i] * b[i];
  return sum;
}

/// ViewedState has views for q and p, and owns time and s.
template <class T, bool Acts>
struct ViewedState {
  using Number = T;
  using Time = T;
  static constexpr bool acting = Acts;

  T t{};
  VectorView<T> q, p;
  [[no_unique_address]] std::conditional_t<Acts, Action<T>, NoAction> action{};
};

/// ViewedScene is H = ½ pᵀg⁻¹p + V(q); T is the number type of its vectors.
template <class T>
class ViewedScene {
 public:
  using Number = T;
  static constexpr int dof = 0;  ///< not known at compile time
  static constexpr bool reads_time = false;

  explicit ViewedScene(const text::SizedScene& scene)
      : scene_(&scene), velocity_(scene.coordinates), slope_(scene.coordinates + 1) {}

  template <class V, class S>
  typename V::value_type potential(const V& q, const S& t) const {
    typename V::value_type v;
    scene_->potential.evaluate(&q[0], t, &v);
    return v;
  }
  template <class V, class S>
  V gradient(const V& q, const S& t) const {
    scene_->gradient.evaluate(&q[0], t, slope_.data());
    return {slope_.data(), velocity_.size()};
  }
  template <class S>
  PotentialAt<VectorView<T>> potential_and_gradient(const VectorView<T>& q, const S& t) const {
    if (scene_->potential_and_gradient.outputs() == 0) return {potential(q, t), gradient(q, t)};
    scene_->potential_and_gradient.evaluate(q.first, t, slope_.data());
    return {slope_[0], {slope_.data() + 1, velocity_.size()}};
  }
  VectorView<T> velocity(const VectorView<T>& p) const {
    scene_->velocity(p.first, velocity_.data());
    return {velocity_.data(), velocity_.size()};
  }
  const text::SizedScene& scene() const { return *scene_; }

 protected:
  const text::SizedScene* scene_;
  mutable std::vector<T> velocity_, slope_;  ///< slope_ has room for V as well
};
template <class P, class T>
requires std::derived_from<P, ViewedScene<T>> VectorView<T> velocity(const P& problem, const VectorView<T>&,
                                                                     const VectorView<T>& p) {
  return problem.velocity(p);
}
template <class P, class T, class S>
requires std::derived_from<P, ViewedScene<T>> PotentialAt<VectorView<T>> potential_at(const P& problem,
                                                                                      const VectorView<T>& q,
                                                                                      const S& t) {
  return problem.potential_and_gradient(q, t);
}

/// ViewedDamped is H = ½ pᵀg⁻¹p + V(q, t) + α s.
template <class T>
struct ViewedDamped : ViewedScene<T> {
  static constexpr bool reads_time = true;
  using ViewedScene<T>::ViewedScene;
  double damping() const { return this->scene().damping_at(0); }
};
/// ViewedTimedDamped is the same with α(t).
template <class T>
struct ViewedTimedDamped : ViewedScene<T> {
  static constexpr bool reads_time = true;
  using ViewedScene<T>::ViewedScene;
  template <class S>
  S damping(const S& t) const {
    S alpha;
    const S* const none = nullptr;
    this->scene().damping.evaluate(none, t, &alpha);
    return alpha;
  }
};

/// potential_rate returns ∂V/∂t at q.
template <class P, class T>
requires std::derived_from<P, ViewedScene<T>> T potential_rate(const P& problem, const VectorView<T>& q, const T& t) {
  using D = Dual<T, 1>;
  if (problem.scene().constant_damping && problem.scene().autonomous) return T(0);
  thread_local std::vector<D> fixed;
  fixed.assign(q.begin(), q.end());
  return problem.potential(fixed, D(t, {T(1)})).slope[0];
}

}  // namespace least

// Parts of steps on scenes whose kinetic metric depends on q, where the length of a step follows from the energy: the
// Lagrangian L(q, v) = ½ vᵀg(q)v − V(q) with its derivatives at a point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "core/catalogue/sized_newton.hpp"
#include "core/problem_traits.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// LagrangianLook evaluates L and its derivatives at a place and a velocity, in the number U.
template <class U>
class LagrangianLook {
 public:
  explicit LagrangianLook(const text::SizedScene& scene)
      : scene_(&scene), n_(scene.coordinates), at_(2 * n_ + 1), all_(2 * n_ + 2) {}

  /// Evaluates everything; place(i) and velocity(i) return component i.
  template <class Place, class Velocity>
  void look(Place&& place, Velocity&& velocity) {
    put(place, velocity);
    scene_->lagrangian.evaluate(at_.data(), 0.0, all_.data());
  }
  /// The same without `force`, which becomes undefined.
  template <class Place, class Velocity>
  void look_lightly(Place&& place, Velocity&& velocity) {
    put(place, velocity);
    scene_->lowered.evaluate(at_.data(), 0.0, &all_[n_]);  // overwrites the last component of the force with L
    all_[0] = all_[n_];
  }
  const U& velocity(std::size_t i) const { return at_[n_ + i]; }
  const U& force(std::size_t i) const { return all_[1 + i]; }          ///< ∂L/∂q
  const U& momentum(std::size_t i) const { return all_[1 + n_ + i]; }  ///< g v
  /// vᵀg v
  U twice_kinetic() const {
    U sum = velocity(0) * momentum(0);
    for (std::size_t i = 1; i < n_; ++i) sum = sum + velocity(i) * momentum(i);
    return sum;
  }
  U potential() const { return 0.5 * twice_kinetic() - all_[0]; }
  /// Writes ∇V, n numbers.
  void gradient(U* slope) const { scene_->gradient.evaluate(at_.data(), 0.0, slope); }

 private:
  template <class Place, class Velocity>
  void put(Place&& place, Velocity&& velocity) {
    for (std::size_t i = 0; i < n_; ++i) {
      at_[i] = place(i);
      at_[n_ + i] = velocity(i);
    }
  }

  const text::SizedScene* scene_;
  std::size_t n_;
  std::vector<U> at_, all_;
};

/// raise writes v = g⁻¹p at q, n numbers; hamiltonian_at returns H at x = (q, p).
template <class T>
void raise(const text::SizedScene& scene, const T* q, const T* p, T* v) {
  thread_local std::vector<T> x;
  const std::size_t n = scene.coordinates;
  x.assign(q, q + n);
  x.insert(x.end(), p, p + n);
  scene.raised.evaluate(x.data(), 0.0, v);
}
template <class T>
T hamiltonian_at(const text::SizedScene& scene, const T* x) {
  std::array<T, 2> h;
  scene.hamiltonian.evaluate(x, 0.0, h.data());
  return h[0];
}

/// LastKnown caches values that were computed last for a place, or for a place and a momentum.
template <class T>
class LastKnown {
 public:
  explicit LastKnown(std::size_t count) : values(count) {}

  std::vector<T> values;

  /// Returns whether `values` are those of this place and momentum. If not, the caller has to compute them, and they
  /// count as such from now on. Always false for dual numbers, since a comparison does not see their derivatives.
  bool is_of(const std::vector<T>& place, const std::vector<T>& momentum = {}) {
    if constexpr (std::is_same_v<T, double>) {
      if (place == place_ && momentum == momentum_) return true;
      place_ = place;
      momentum_ = momentum;
    }
    return false;
  }

 private:
  std::vector<T> place_, momentum_;
};

/// small_part returns the size of an update after which the next one is below round-off, for a quantity of this size
/// and a Jacobian that is exact in this round.
inline double small_part(double size) { return std::pow(std::numeric_limits<double>::epsilon(), 0.75) * size; }

/// plain_numbers writes the values without derivatives.
template <class T>
void plain_numbers(const std::vector<T>& all, std::vector<double>& plain) {
  plain.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) plain[i] = plain_number(all[i]);
}

}  // namespace least

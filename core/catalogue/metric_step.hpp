// What steps on scenes of few coordinates whose kinetic metric depends on the place are made of, where the length of a
// step follows from the energy: L(q, v) = ½ vᵀg(q)v − V(q) with its derivatives at a point, and Newton's method for a
// few equations that are made of them.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "core/number/linear.hpp"
#include "core/problem_traits.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// L at a place and a velocity, in the number U.
template <class U>
class LagrangianLook {
 public:
  explicit LagrangianLook(const text::SizedScene& scene)
      : scene_(&scene), n_(scene.coordinates), at_(2 * n_ + 1), all_(2 * n_ + 2) {}

  /// place(i), velocity(i) → the i-th component.
  template <class Place, class Velocity>
  void look(Place&& place, Velocity&& velocity) {
    put(place, velocity);
    scene_->lagrangian.evaluate(at_.data(), 0.0, all_.data());
  }
  /// The same without the force.
  template <class Place, class Velocity>
  void look_lightly(Place&& place, Velocity&& velocity) {
    put(place, velocity);
    scene_->lowered.evaluate(at_.data(), 0.0, &all_[n_]);  // L in the place of the last force
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
  /// ∇V, to n numbers.
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

/// v = g⁻¹p at a place, to n numbers; H there with p for momentum.
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

/// Directions that a matrix is made of at a time.
using FewDirections = Dual<double, 4>;
/// The derivatives of `equations(z, values)` by n unknowns, row by row; `trial` and `values` have room for n numbers.
template <class T, class Equations>
void fill_jacobian(std::size_t n, const T* z, std::vector<FewDirections>& trial, std::vector<FewDirections>& values,
                   double* jacobian, Equations&& equations) {
  constexpr std::size_t width = std::tuple_size_v<decltype(FewDirections::slope)>;
  for (std::size_t first = 0; first < n; first += width) {
    for (std::size_t i = 0; i < n; ++i) {
      trial[i] = FewDirections(plain_number(z[i]));
      if (i >= first && i < first + width) trial[i].slope[i - first] = 1;
    }
    equations(trial.data(), values.data());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = first; k < std::min(n, first + width); ++k) jacobian[i * n + k] = values[i].slope[k - first];
  }
}

/// Newton's method in numbers T, with a matrix of plain numbers: derivatives that ride along settle a round after the
/// numbers.
template <class T>
class SmallNewton {
 public:
  explicit SmallNewton(std::size_t unknowns)
      : update(unknowns),
        n_(unknowns),
        wrong_(unknowns),
        inverse_(unknowns * unknowns),
        trial_(unknowns),
        row_(unknowns) {}

  std::vector<T> update;  ///< by how much the unknowns are off

  /// `in_numbers(z, wrong)`: the equations in T at z; `in_rows`: the same of plain numbers in a few directions, of
  /// which a matrix is made.
  template <class Numbers, class Rows>
  void look(const T* z, Numbers&& in_numbers, Rows&& in_rows) {
    fill_jacobian(n_, z, trial_, row_, inverse_.data(), in_rows);
    detail::invert(n_, inverse_.data());
    look_again(z, in_numbers);
  }
  /// With the matrix that there is.
  template <class Numbers>
  void look_again(const T* z, Numbers&& in_numbers) {
    in_numbers(z, wrong_.data());
    for (std::size_t i = 0; i < n_; ++i) {
      update[i] = inverse_[i * n_] * wrong_[0];
      for (std::size_t j = 1; j < n_; ++j) update[i] = update[i] + inverse_[i * n_ + j] * wrong_[j];
    }
  }

 private:
  std::size_t n_;
  std::vector<T> wrong_;
  std::vector<double> inverse_;
  std::vector<FewDirections> trial_, row_;
};

/// Rounds that go on once the solution is there.
template <class T>
inline constexpr int late_rounds = std::is_same_v<T, double> ? 0 : 1;

/// The plain numbers of some.
template <class T>
void plain_numbers(const std::vector<T>& all, std::vector<double>& plain) {
  plain.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) plain[i] = plain_number(all[i]);
}

}  // namespace least

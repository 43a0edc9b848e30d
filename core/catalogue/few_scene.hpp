// Scenes of few coordinates with a constant metric as problems of a fixed type: schemes written for such types keep the
// states in registers, and loops over coordinates are unrolled.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/catalogue/frequency_floor.hpp"
#include "core/number/vector.hpp"
#include "core/run/problem_table.hpp"
#include "core/schemes/transformed_stepper.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// FewScene is H = ½ pᵀg⁻¹p + V(q) with N coordinates, in doubles. The scene has to outlive it.
template <int N>
class FewScene {
  static_assert(N <= tape::SparseJacobian::few);

 public:
  static constexpr int dof = N;
  static constexpr bool reads_time = false;

  explicit FewScene(const text::SizedScene& scene) : scene_(&scene), full_(scene.has_full_mass()) {
    for (std::size_t i = 0; i < N; ++i) {
      if (full_) {
        for (const auto& [j, share] : scene.inverse_mass_matrix()[i]) inverse_mass_[i][j] = share;
      } else {
        inverse_mass_[i][i] = scene.inverse_mass()[i];
      }
    }
  }

  // Formulas read their arguments from memory: they get copies, so that the states themselves may stay in registers.
  double potential(const Vec<N>& q, double t) const {
    const Vec<N> at = q;
    double v;
    scene_->potential.evaluate(at.data(), t, &v);
    return v;
  }
  Vec<N> gradient(const Vec<N>& q, double t) const {
    const Vec<N> at = q;
    Vec<N> slope;
    scene_->gradient.evaluate(at.data(), t, slope.data());
    return slope;
  }
  PotentialAt<Vec<N>> potential_and_gradient(const Vec<N>& q, double t) const {
    const Vec<N> at = q;
    Vec<N + 1> both;
    scene_->potential_and_gradient.evaluate(at.data(), t, both.data());
    PotentialAt<Vec<N>> here;
    here.potential = both[0];
    for (std::size_t i = 0; i < N; ++i) here.slope[i] = both[i + 1];
    return here;
  }
  /// follow_from chooses the local frequency along a motion that starts at q with the energy `level`: the estimate of
  /// the problem, whose `table` has to outlive this scene, where it has one, as those of the catalogue that go
  /// backward; else that of V″ with a FrequencyFloor. `unit` is an energy of the scene.
  void follow_from(const Vec<N>& q, double level, double unit, const ProblemTable& table) {
    known_ = &table;
    if (std::isfinite(known_frequency_squared(q))) return;
    known_ = nullptr;
    const Vec<N> slope = gradient(q, 0);
    floor_ = {bent_at(q), dot(slope, velocity(slope)), level - potential(q, 0), unit, level};
  }
  /// The squared local frequency along that motion.
  double frequency_squared(const Vec<N>& q) const {
    return known_ ? known_frequency_squared(q) : floor_(bent_at(q), potential(q, 0));
  }
  Vec<N> velocity(const Vec<N>& p) const {
    Vec<N> v;
    for (std::size_t i = 0; i < N; ++i) {
      v[i] = inverse_mass_[i][i] * p[i];
      if (!full_) continue;
      v[i] = inverse_mass_[i][0] * p[0];
      for (std::size_t j = 1; j < N; ++j) v[i] += inverse_mass_[i][j] * p[j];
    }
    return v;
  }

 private:
  /// bent_at returns the Frobenius norm of g⁻¹V″.
  double bent_at(const Vec<N>& q) const {
    const Vec<N> at = q;
    Mat<N> bent{};
    scene_->curvature().evaluate(scene_->gradient, at.data(), 0.0, [&](std::size_t row, std::size_t column, double v) {
      if (!full_) {
        bent[row][column] = inverse_mass_[row][row] * v;
        return;
      }
      for (std::size_t i = 0; i < N; ++i) bent[i][column] += inverse_mass_[i][row] * v;
    });
    double sum = 0;
    for (const Vec<N>& line : bent)
      for (const double entry : line) sum += entry * entry;
    return std::sqrt(sum);
  }

  double known_frequency_squared(const Vec<N>& q) const {
    std::array<double, 2 * N> at_rest{};
    std::copy(q.begin(), q.end(), at_rest.begin());
    return known_->frequency_squared({0, at_rest.data()});
  }

  const text::SizedScene* scene_;
  const ProblemTable* known_ = nullptr;  ///< null where the problem has no estimate of its frequency
  FrequencyFloor floor_;
  bool full_;
  Mat<N> inverse_mass_{};
};
template <int N>
Vec<N> velocity(const FewScene<N>& problem, const Vec<N>&, const Vec<N>& p) {
  return problem.velocity(p);
}
template <int N>
PotentialAt<Vec<N>> potential_at(const FewScene<N>& problem, const Vec<N>& q, double t) {
  return problem.potential_and_gradient(q, t);
}

}  // namespace least

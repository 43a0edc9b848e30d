// Scenes of few coordinates given as text, as problems: one class for each form, generic in the number type as every
// problem is. The degrees of freedom N are a capacity: coordinates that the text does not have rest at zero with unit
// mass and influence no other. Steps of lanes are traced from these classes, and so are references of motions without
// series; ordinary runs use core/text/sized_scene.hpp. Copies of a value share its formulas.
#pragma once

#include <memory>
#include <span>

#include "core/number/linear.hpp"
#include "core/problem.hpp"
#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// Numbers of the variables on the tapes of compiled forms.
inline constexpr int first_momentum = Numbering{}.momentum, action_variable = Numbering{}.action,
                     first_parameter = Numbering{}.parameter;

/// Formulas is a form with numbers in the place of its parameters.
struct Formulas {
  Formulas(const Form& form, std::span<const double> parameters);

  std::size_t coordinates = 0;
  bool reads_action = false;
  tape::Formula potential, gradient, damping, metric, rates, invariants;
  tape::Formula force;                ///< ∂L/∂q as a function of (q, v), where the metric depends on q
  tape::Formula hamiltonian, slopes;  ///< functions of (q, p, s): H; and (H_q, H_p, H_s)
  std::shared_ptr<const Lift> lift;   ///< of a general Hamiltonian that has a lift, else null
  std::array<double, compiled_coordinates> inverse_mass{};
  /// Where g is constant and not diagonal: g and its inverse, in the first `coordinates` rows and columns.
  bool full_mass = false;
  Mat<compiled_coordinates> mass_matrix{}, inverse_mass_matrix{};
  double alpha = 0, gamma = 0, offset = 0;

 private:
  /// set_full_mass takes ∂²L/∂v² (`of_velocities`) or ∂²H/∂p², row-major.
  void set_full_mass(std::vector<double> given, bool of_velocities);
};

/// Mechanical is the common part of all mechanics with a potential.
template <int N>
struct Mechanical {
  static constexpr int dof = N;
  std::shared_ptr<const Formulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  template <class T, class S>
  T potential(const Vec<dof, T>& q, const S& t) const {
    T v;
    formulas->potential.evaluate(q.data(), t, &v);
    return v;
  }
  template <class T, class S>
  Vec<dof, T> gradient(const Vec<dof, T>& q, const S& t) const {
    Vec<dof, T> slope{};
    formulas->gradient.evaluate(q.data(), t, slope.data());
    return slope;
  }
  template <class T, class S>
  std::array<T, most_invariants> invariants(const Vec<dof, T>& q, const Vec<dof, T>& p, const S& t) const {
    std::array<T, std::size_t(action_variable)> x{};
    for (std::size_t i = 0; i < N; ++i) x[i] = q[i], x[first_momentum + i] = p[i];
    std::array<T, most_invariants> values{};
    formulas->invariants.evaluate(x.data(), t, values.data());
    return values;
  }
};

/// ConstantMass has a constant metric: a mass for every coordinate, or a full matrix.
template <int N>
struct ConstantMass : Mechanical<N> {
  Vec<N> inverse_mass() const {
    Vec<N> inverse;
    for (std::size_t i = 0; i < N; ++i) inverse[i] = this->formulas->inverse_mass[i];
    return inverse;
  }
  bool has_full_mass() const { return this->formulas->full_mass; }
  template <class T>
  Vec<N, T> times_inverse_mass(const Vec<N, T>& p) const {
    return times(this->formulas->inverse_mass_matrix, p);
  }
  template <class T>
  Vec<N, T> times_mass(const Vec<N, T>& v) const {
    return times(this->formulas->mass_matrix, v);
  }

 private:
  /// Coordinates that the scene does not have keep their unit mass.
  template <class T>
  Vec<N, T> times(const Mat<compiled_coordinates>& matrix, const Vec<N, T>& x) const {
    Vec<N, T> y = x;
    const std::size_t n = N == 2 ? N : this->coordinates();  // one coordinate has no full matrix
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = matrix[i][0] * x[0];
      for (std::size_t j = 1; j < n; ++j) y[i] = y[i] + matrix[i][j] * x[j];
    }
    return y;
  }
};

/// H = ½ pᵀg⁻¹p + V(q), or V(q, t).
template <int N>
struct SeparableScene : ConstantMass<N> {
  static constexpr bool reads_time = true;
};

/// H = ½ pᵀg⁻¹p + V(q) + α s, or with V(q, t)
template <int N>
struct DampedScene : ConstantMass<N> {
  static constexpr bool reads_time = true;
  double damping() const { return this->formulas->alpha; }
};
/// H = ½ pᵀg⁻¹p + V(q, t) + α(t) s
template <int N>
struct TimedDampedScene : ConstantMass<N> {
  static constexpr bool reads_time = true;
  template <class S>
  S damping(const S& t) const {
    S alpha;
    const S* const none = nullptr;
    this->formulas->damping.evaluate(none, t, &alpha);
    return alpha;
  }
};
/// H = ½ pᵀg⁻¹p + V(q) + γs²/2 − R
template <int N>
struct QuadraticScene : ConstantMass<N> {
  static constexpr bool reads_time = false;
  double action_curvature() const { return this->formulas->gamma; }
  double offset() const { return this->formulas->offset; }
};

/// H = ½ pᵀg(q)⁻¹p + V(q)
template <int N>
struct MetricScene : Mechanical<N> {
  static constexpr bool reads_time = false;
  template <class T>
  Mat<N, T> metric(const Vec<N, T>& q) const {
    std::array<T, std::size_t(N * N)> entries;
    this->formulas->metric.evaluate(q.data(), 0.0, entries.data());
    Mat<N, T> g{};
    const std::size_t n = this->formulas->coordinates;
    for (std::size_t i = 0; i < N; ++i) g[i][i] = T(1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) g[i][j] = entries[i * n + j];
    return g;
  }
  /// Forces is ∂L/∂q as a function of (q, v). It must not outlive its scene.
  struct Forces {
    const Formulas* formulas = nullptr;
    template <class T>
    Vec<N, T> operator()(const Vec<N, T>& q, const Vec<N, T>& v) const {
      std::array<T, std::size_t(action_variable)> x{};
      for (std::size_t i = 0; i < N; ++i) x[i] = q[i], x[first_momentum + i] = v[i];
      Vec<N, T> force{};
      formulas->force.evaluate(x.data(), 0.0, force.data());
      return force;
    }
  };
  Forces forces() const { return {this->formulas.get()}; }
};

/// joined returns (q, p, s) in the numbering of the forms' tapes.
template <class T>
std::array<T, std::size_t(first_parameter)> joined(const Vec<compiled_coordinates, T>& q,
                                                   const Vec<compiled_coordinates, T>& p, const T& s) {
  std::array<T, std::size_t(first_parameter)> x;
  for (std::size_t i = 0; i < q.size(); ++i) x[i] = q[i], x[first_momentum + i] = p[i];
  x[action_variable] = s;
  return x;
}

/// GeneralScene is the common part of forms of which H alone is known.
struct GeneralScene {
  static constexpr int dof = compiled_coordinates;
  static constexpr bool reads_time = true;
  std::shared_ptr<const Formulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  bool reads_action() const { return formulas->reads_action; }
  template <class T, class S>
  std::array<T, most_invariants> invariants(const Vec<dof, T>& q, const Vec<dof, T>& p, const S& t) const {
    std::array<T, most_invariants> values{};
    formulas->invariants.evaluate(joined(q, p, T(0)).data(), t, values.data());
    return values;
  }
};

/// Any H(q, p, s, t)
struct HamiltonianScene : GeneralScene {
  const std::shared_ptr<const Lift>& lift() const { return formulas->lift; }
  template <class T, class S>
  T hamiltonian(const Vec<dof, T>& q, const Vec<dof, T>& p, const T& s, const S& t) const {
    T h;
    formulas->hamiltonian.evaluate(joined(q, p, s).data(), t, &h);
    return h;
  }
  template <class T, class S>
  HamiltonianSlopes<dof, T> slopes(const Vec<dof, T>& q, const Vec<dof, T>& p, const T& s, const S& t) const {
    std::array<T, 2 * dof + 1> all;
    formulas->slopes.evaluate(joined(q, p, s).data(), t, all.data());
    HamiltonianSlopes<dof, T> slopes{};
    const std::size_t n = coordinates();
    for (std::size_t i = 0; i < n; ++i) {
      slopes.by_q[i] = all[i];
      slopes.by_p[i] = all[n + i];
    }
    slopes.by_s = all[2 * n];
    return slopes;
  }
};

/// ẏ = f(y, t)
struct FlowScene {
  static constexpr int dim = compiled_variables;
  static constexpr bool reads_time = true;
  std::shared_ptr<const Formulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  template <class T, class S>
  Vec<dim, T> field(const Vec<dim, T>& y, const S& t) const {
    Vec<dim, T> rate{};
    formulas->rates.evaluate(y.data(), t, rate.data());
    return rate;
  }
  template <class T, class S>
  std::array<T, most_invariants> invariants(const Vec<dim, T>& y, const S& t) const {
    std::array<T, most_invariants> values{};
    formulas->invariants.evaluate(y.data(), t, values.data());
    return values;
  }
};

}  // namespace least::text

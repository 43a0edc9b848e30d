// Scenes along a direction of their parameters, as problems for schemes: one class for each form, like those of
// core/text/scenes.hpp, with a parameter that is a dual number. A step of a scheme in dual numbers then gives the
// derivative of the scheme's own map by start and parameters.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/number/linear.hpp"
#include "core/problem.hpp"
#include "core/problem_traits.hpp"
#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::variations {

/// VariedFormulas is a form with numbers in the place of all parameters but the moved one. On the tapes of mechanics q
/// begins at 0, p at `room`, s is variable 2 room, and the moved parameter 2 room + 1; on that of a flow the parameter
/// follows the variables.
struct VariedFormulas {
  /// `moved` is the moved parameter, none where only the start changes; `room` the number of coordinates of the class.
  VariedFormulas(const text::Form& form, std::span<const double> parameters, std::optional<std::size_t> moved,
                 std::size_t room);

  std::size_t coordinates;
  bool reads_action;
  Slope parameter = 0;
  tape::Formula potential, gradient, damping, metric, rates;
  tape::Formula hamiltonian, slopes;       ///< functions of (q, p, s): H; and (H_q, H_p, H_s)
  std::shared_ptr<const text::Lift> lift;  ///< of a general Hamiltonian that has a lift, else null
  std::vector<Slope> inverse_mass;
  bool full_mass = false;
  std::vector<Slope> mass_matrix, inverse_mass_matrix;  ///< where the metric is not diagonal, row-major
  Slope alpha = 0, gamma = 0, offset = 0;
};

/// number_as<T> returns x with its slope where T has slopes, else the value alone.
template <class T>
T number_as(const Slope& x) {
  if constexpr (std::is_convertible_v<Slope, T>) {
    return T(x);
  } else {
    return T(x.value);
  }
}

/// VariedMechanics is the common part of all mechanics with a potential.
template <int N>
struct VariedMechanics {
  static constexpr int dof = N;
  static constexpr bool reads_time = true;
  std::shared_ptr<const VariedFormulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  template <class T, class S>
  T potential(const Vec<dof, T>& q, const S& t) const {
    T v;
    formulas->potential.evaluate(variables(q).data(), t, &v);
    return v;
  }
  template <class T, class S>
  Vec<dof, T> gradient(const Vec<dof, T>& q, const S& t) const {
    Vec<dof, T> slope{};
    formulas->gradient.evaluate(variables(q).data(), t, slope.data());
    return slope;
  }

 protected:
  template <class T>
  std::array<T, std::size_t(2 * N + 2)> variables(const Vec<dof, T>& q) const {
    std::array<T, std::size_t(2 * N + 2)> x{};
    for (std::size_t i = 0; i < N; ++i) x[i] = q[i];
    x.back() = number_as<T>(formulas->parameter);
    return x;
  }
};

/// VariedMasses has a mass for every coordinate.
template <int N>
struct VariedMasses : VariedMechanics<N> {
  Vec<N, Slope> inverse_mass() const {
    Vec<N, Slope> inverse;
    for (std::size_t i = 0; i < N; ++i) inverse[i] = this->formulas->inverse_mass[i];
    return inverse;
  }
};
/// VariedFullMass has a full constant mass matrix.
template <int N>
struct VariedFullMass : VariedMechanics<N> {
  Vec<N> inverse_mass() const { return {}; }  // a full matrix has no masses by coordinate
  bool has_full_mass() const { return true; }
  template <class T>
  Vec<N, T> times_inverse_mass(const Vec<N, T>& p) const {
    return times(this->formulas->inverse_mass_matrix, p);
  }
  template <class T>
  Vec<N, T> times_mass(const Vec<N, T>& v) const {
    return times(this->formulas->mass_matrix, v);
  }

 private:
  template <class T>
  Vec<N, T> times(const std::vector<Slope>& matrix, const Vec<N, T>& x) const {
    Vec<N, T> y = x;
    const std::size_t n = this->formulas->coordinates;
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = number_as<T>(matrix[i * n]) * x[0];
      for (std::size_t j = 1; j < n; ++j) y[i] = y[i] + number_as<T>(matrix[i * n + j]) * x[j];
    }
    return y;
  }
};

/// H = ½ pᵀg⁻¹p + V(q, t), with `Mass` giving g, and the forms that add terms to it.
template <class Mass>
struct VariedSeparable : Mass {};
template <class Mass>
struct VariedDamped : Mass {
  Slope damping() const { return this->formulas->alpha; }
};
template <class Mass>
struct VariedTimedDamped : Mass {
  template <class S>
  auto damping(const S& t) const {
    using T = std::conditional_t<std::is_same_v<S, double>, Slope, S>;
    T alpha;
    std::array<T, std::size_t(2 * Mass::dof + 2)> x{};
    x.back() = number_as<T>(this->formulas->parameter);
    this->formulas->damping.evaluate(x.data(), T(t), &alpha);
    return alpha;
  }
};
template <class Mass>
struct VariedQuadratic : Mass {
  Slope action_curvature() const { return this->formulas->gamma; }
  Slope offset() const { return this->formulas->offset; }
};
template <int N>
struct VariedMetric : VariedMechanics<N> {
  template <class T>
  Mat<N, T> metric(const Vec<N, T>& q) const {
    std::array<T, std::size_t(N * N)> entries;
    this->formulas->metric.evaluate(this->variables(q).data(), 0.0, entries.data());
    Mat<N, T> g{};
    const std::size_t n = this->formulas->coordinates;
    for (std::size_t i = 0; i < N; ++i) g[i][i] = T(1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) g[i][j] = entries[i * n + j];
    return g;
  }
};

/// Any H(q, p, s, t)
template <int N>
struct VariedHamiltonian {
  static constexpr int dof = N;
  static constexpr bool reads_time = true;
  std::shared_ptr<const VariedFormulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  bool reads_action() const { return formulas->reads_action; }
  const std::shared_ptr<const text::Lift>& lift() const { return formulas->lift; }
  template <class T, class S>
  T hamiltonian(const Vec<dof, T>& q, const Vec<dof, T>& p, const T& s, const S& t) const {
    T h;
    formulas->hamiltonian.evaluate(joined(q, p, s).data(), t, &h);
    return h;
  }
  template <class T, class S>
  HamiltonianSlopes<dof, T> slopes(const Vec<dof, T>& q, const Vec<dof, T>& p, const T& s, const S& t) const {
    std::array<T, std::size_t(2 * N + 1)> all;
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

 private:
  template <class T>
  std::array<T, std::size_t(2 * N + 2)> joined(const Vec<dof, T>& q, const Vec<dof, T>& p, const T& s) const {
    std::array<T, std::size_t(2 * N + 2)> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = q[i], x[N + i] = p[i];
    x[2 * N] = s;
    x.back() = number_as<T>(formulas->parameter);
    return x;
  }
};

/// ẏ = f(y, t)
template <int N>
struct VariedFlow {
  static constexpr int dim = N;
  static constexpr bool reads_time = true;
  std::shared_ptr<const VariedFormulas> formulas;

  std::size_t coordinates() const { return formulas->coordinates; }
  template <class T, class S>
  Vec<dim, T> field(const Vec<dim, T>& y, const S& t) const {
    std::array<T, std::size_t(N + 1)> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = y[i];
    x.back() = number_as<T>(formulas->parameter);
    Vec<dim, T> rate{};
    formulas->rates.evaluate(x.data(), t, rate.data());
    return rate;
  }
};

}  // namespace least::variations

// contact_variational_midpoint and contact_galerkin_4 of scenes whose number of coordinates is known only at run time,
// from their Lagrangian L(q, v, s, t) alone: the discrete Herglotz equations. With L, L_q, L_v = π and L_s at
// m = q₀ + hv/2, σ = (s₁ − s₀)/h, s̄ = s₀ + hσ/2, t + h/2:
//   π − (h/2)L_q = (1 + (h/2)L_s) p₀,  σ = L,  p₁ = ((1 + (h/2)L_s) p₀ + h L_q)/(1 − (h/2)L_s)
// in (v, σ), and those of the path of core/schemes/contact_galerkin_4.hpp in its two velocities. If L does not depend
// on s, then s is constant and not among the unknowns, and the maps are symplectic. Sources: those of the two schemes.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "core/catalogue/metric_step.hpp"
#include "core/catalogue/sized_implicit.hpp"
#include "core/simplified_newton.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution.
template <class T>
class SizedHerglotz {
 public:
  /// The scene needs a Lagrangian.
  SizedHerglotz(const text::SizedScene& scene, SizedPath path, const Composition& composition);

  void begin(const T*, double) { work_ = {}; }
  /// If a step fails, x is undefined.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }
  /// E_d of a step of length h from a state, the mean of v·L_v − L over its nodes; NaN if the step fails.
  double step_energy(StateView from, double h);

 private:
  /// Nodes holds L, L_q, L_v and L_s at each node of a step, in the number U.
  template <class U>
  struct Nodes {
    std::vector<U> at;  ///< q, v, s
    std::array<std::vector<U>, 4> node;
    // For a parabola: derivatives of s₁ with respect to its middle, to q₀, to a shift of the whole path and (factor) to
    // s₀; and (gain) s₁ − s₀.
    std::vector<U> by_middle, by_start, by_shift;
    U factor{}, gain{};

    explicit Nodes(std::size_t n);
  };

  /// Solver solves the equations of a step. In dual numbers the same step is solved for one direction after the other:
  /// the matrix at its guess is kept, so that it is computed once.
  struct Solver {
    SimplifiedNewton<T> newton;
    std::vector<double> start;
    double t = 0, h = 0;
    bool at_guess = false;

    explicit Solver(std::size_t unknowns) : newton(unknowns) {}
  };

  StepStatus stage(T* x, double t, double h);
  /// prepare_at_guess does the same for the guess from `start_`, unless the solver has that matrix already.
  bool prepare_at_guess(double t, double h);
  /// prepare computes and factors the matrix at z. False: the computation is to end (AskedByThread).
  bool prepare(double t, double h, const T* z);
  StepStatus solve_closely(const T* x, double t, double h);
  /// equations writes the residual of the step from x at z.
  template <class A, class U>
  void equations(const A* x, double t, double h, const U* z, Nodes<U>& nodes, U* wrong) const;
  /// Evaluates L and its derivatives at nodes.at.
  template <class U>
  void look(Nodes<U>& nodes, std::size_t j, double t) const {
    scene_->lagrangian.evaluate(nodes.at.data(), t, nodes.node[j].data());
  }
  template <class A, class U>
  void look_in_the_middle(const A* x, double t, double h, const U* z, Nodes<U>& nodes) const;
  template <class A, class U>
  void walk(const A* x, double t, double h, const U* z, Nodes<U>& nodes) const;
  /// v·L_v − L at node j, where v = of_u·u + of_w·w.
  T energy_at(std::size_t j, double of_u, double of_w) const;
  StepStatus end_straight(T* x, double t, double h);
  StepStatus end_parabola(T* x, double t, double h);

  const text::SizedScene* scene_;
  SizedPath path_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t n_, unknowns_;
  int looks_;  ///< evaluations of L by the equations
  std::vector<T> z_, guess_;
  std::vector<double> start_, rate_;  ///< the state at the start of a step and its rates, in plain numbers
  Nodes<T> nodes_;
  Nodes<FewDirections> rows_;  ///< for the matrix
  std::vector<FewDirections> trial_, wrong_;
  std::shared_ptr<Solver> solver_;  ///< shared by copies: what it keeps changes no step
  bool asks_energy_ = false;
  T energy_{};  ///< E_d of the last step, if that is asked for
  Work work_;
};

extern template class SizedHerglotz<double>;
extern template class SizedHerglotz<Slope>;

}  // namespace least

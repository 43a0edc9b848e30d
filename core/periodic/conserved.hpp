// What a motion keeps, and the symmetries that go with it: both make unit multipliers, and rows of a closed orbit's
// equations that say nothing. Beside H, and what a text declares, they are looked for among the polynomials of degree
// one and two in the components: momenta, angular momenta, the energies of parts. Of damped mechanics, dI/dt = −αI: the
// form dq∧dp decays as I does, so that the field I generates stays as it is, and where the damping of a period is 0 in
// the mean, I is kept over it. Source: McLachlan, Perlmutter, J. Geometry and Physics 39, 276 (2001), conformal
// Hamiltonian systems.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/periodic/motion.hpp"

namespace least::periodic {

class Conserved {
 public:
  /// Around a point and as far as `extents` from it, from the time t over a time dt.
  Conserved(const Motion& motion, const Scene& scene, std::span<const double> x, std::span<const double> extents,
            double t, double dt);

  /// Gradients at a point, as columns; some may depend on others. Of components in units of `extents`, in units in
  /// which they have the length 1 at the point it was made with.
  Matrix gradients(std::span<const double> x, double t) const;
  /// Directions in which the motion through a point may be moved and stays one: ẋ first, of a motion that does not read
  /// the time, and of mechanics what the kept quantities generate. In the same units.
  Matrix symmetries(std::span<const double> x, double t) const;
  /// The values of those that are declared.
  std::vector<std::pair<std::string, double>> declared(std::span<const double> x, double t) const;

 private:
  void read_declared(const Scene& scene, double t);
  void find(double t, double dt);
  void find_decaying(double t, double dt);
  double damping_between(double from, double to, bool absolute) const;
  void find_felt(double t);
  /// Of coefficients of monomials, at a place that is scaled.
  std::vector<double> gradient_at(std::span<const double> y, std::span<const double> coefficients, double factor) const;
  std::vector<double> scaled(std::span<const double> x) const;
  std::vector<double> point(Spread& spread) const;
  Matrix raw_gradients(std::span<const double> x, double t) const;
  Matrix raw_symmetries(std::span<const double> x, double t) const;

  const Motion& motion_;
  std::vector<double> center_, extents_;
  std::vector<double> gradient_sizes_, symmetry_sizes_;  ///< at the center
  std::vector<std::string> declared_names_;
  std::vector<bool> kept_;  ///< of the declared ones: that they are
  std::vector<bool> felt_;  ///< of all gradients: that they do not vanish at the center; empty: not yet known
  tape::Formula declared_, declared_gradients_;
  std::vector<std::vector<double>> found_;     ///< coefficients of the monomials, as `monomials` has them
  std::vector<std::vector<double>> decaying_;  ///< the same, of what decays with the damping
  double start_ = 0;                           ///< of the period
};

}  // namespace least::periodic

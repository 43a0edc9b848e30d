// Kicks and drifts of forced scenes, H with forces F(q, p, t): ṗ = −H_q + F. Each carries the work W = ∫ F·q̇ dt by its
// own quadrature, as the component after the momenta. No form is conserved; for F = 0 the maps are those of
// core/schemes/splitting.hpp. Sources: Marsden & West, Acta Numerica 10, 357 (2001), part 3; Hairer, Lubich, Wanner
// 2006, V.3.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/catalogue/turned_momenta.hpp"
#include "core/number/exponential.hpp"
#include "core/run/run_state.hpp"
#include "core/schemes/splitting.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// ForcedKick is the kick over a time h for H = K(p) + V(q, t) at fixed place and time, ṗ = −∇V + F(q, p, t): exact if
/// F is linear in p, otherwise by the implicit midpoint rule in p, which is symmetric. A force that jumps with the sign
/// of the momentum on which it acts, and with no other, as dry friction, is solved for on one side of 0. If the
/// momentum comes to 0 and the forces on both sides drive it back, it stays at 0 until they no longer do (Filippov's
/// solution). For friction between bodies the same holds in the momenta in which the force jumps (TurnedMomenta).
class ForcedKick {
 public:
  explicit ForcedKick(const text::SizedScene& scene);

  /// Kicks the state x; `slope` is ∇V at its place.
  StepStatus kick(double* x, const double* slope, double t, double h, Work& work);

 private:
  StepStatus kick_along(double* x, const double* slope, double t, double h, Work& work);
  void velocity_of(const double* p, double* v) const;
  double inverse_mass(std::size_t i) const { return turned_ ? turned_->inverse_mass[i] : scene_->inverse_mass()[i]; }
  bool jumps(std::size_t i) const { return turned_ ? turned_->jumping[i] : scene_->forces.jumping[i]; }
  /// look evaluates F and ∂F/∂p at the place of x and the momenta p; null: at rest.
  void look(const double* x, const double* p, double t);
  void exact(const double* x, const double* slope, double t, double h);
  StepStatus midpoint(const double* x, const double* slope, double t, double h, Work& work);
  /// through_rest is the kick if momenta come to 0, or rest there.
  StepStatus through_rest(const double* x, const double* slope, double t, double h, Work& work);
  void look_beside_rest(const double* x, const double* slope, double t, std::size_t which);
  template <class Rests, class Inside>
  void solve_on_sides(double h, bool diagonal, const Rests& rests, const Inside& inside);
  const MatrixPhi& phi_of(double h);

  const text::SizedScene* scene_;
  std::size_t n_;
  bool diagonal_ = true;        ///< ∂F/∂p is diagonal in the momenta of kicks
  std::vector<double> at_;      ///< q and p at which forces are evaluated
  std::vector<double> looked_;  ///< F and ∂F/∂p there
  std::vector<double> rate_;    ///< ṗ at the start of the kick
  std::vector<double> change_;  ///< change of p over the kick
  std::vector<double> middle_;  ///< the mean of p over the kick, or its midpoint
  std::vector<double> velocity_, matrix_;
  std::vector<double> above_, below_;            ///< ṗ on either side of 0
  bool looked_beside_ = false;                   ///< whether above_ and below_ are known for all momenta in this kick
  std::vector<double> side_;                     ///< side of 0 of each momentum, 1 or −1; 0 if it rests
  double work_ = 0;                              ///< work of F in the kick
  std::shared_ptr<const TurnedMomenta> turned_;  ///< the momenta of kicks, if they are not those of the scene
  std::vector<double> state_, slope_, given_;    ///< scratch for turned momenta
  double beside_rest_ = std::numeric_limits<double>::min();  ///< |p| at which forces on either side of 0 are evaluated

  /// φ functions of h·∂F/∂p by the length h of kicks; copies of a stepper share them.
  struct Known {
    double h = std::numeric_limits<double>::quiet_NaN();
    MatrixPhi phi;
  };
  std::shared_ptr<std::vector<Known>> known_;
};

/// ForcedKickDrift alternates kicks and drifts. Two kicks that meet are not merged if they are not exact, so that a
/// composition of symmetric maps stays symmetric.
class ForcedKickDrift {
 public:
  using Piece = Sequence<double>::Piece;

  ForcedKickDrift(const text::SizedScene& scene, std::vector<Piece> pieces);

  void begin(const double* x, double t);
  /// If a step fails, the state and the stepper are undefined.
  StepStatus step(double* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  void look(const double* q, double t);

  const text::SizedScene* scene_;
  std::vector<Piece> pieces_;  ///< in fractions of the step
  ForcedKick kick_;
  std::vector<double> slope_;  ///< ∇V at the state's q
  std::vector<double> velocity_;
  Work work_;
};

std::vector<ForcedKickDrift::Piece> pieces_of(const Leapfrog& scheme);
template <class Scheme>
std::vector<ForcedKickDrift::Piece> pieces_of(const Scheme& scheme) {
  const auto& sequence = scheme.template sequence<double>();
  std::vector<ForcedKickDrift::Piece> all;
  for (std::size_t i = 0; i < static_cast<std::size_t>(sequence.drifts); ++i)
    all.push_back({i == 0 ? sequence.kick[0] : 0, sequence.drift[i], sequence.kick[i + 1]});
  return all;
}

}  // namespace least

// Steps of equal length of forced scenes, H and forces F(q, p, t) beside it: ṗ = −H_q + F. Each carries the work
// W = ∫ F·q̇ dt by its own quadrature, as the component after the momenta. No form is kept; where F = 0 the maps are
// those of core/schemes/splitting.hpp, variational_midpoint.hpp and galerkin_4.hpp. Sources: Marsden & West, Acta
// Numerica 10, 357 (2001), part 3; Hairer, Lubich, Wanner 2006, II.2.1 and V.3.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "core/number/exponential.hpp"
#include "core/run/run_state.hpp"
#include "core/schemes/splitting.hpp"
#include "core/simplified_newton.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// Of H = K(p) + V(q, t) the kick over a time h at a fixed place and time, ṗ = −∇V + F(q, p, t): exact where F is
/// linear in p, else the implicit midpoint rule in p alone, which is symmetric. Where a force jumps with the momentum
/// that it acts on, as dry friction does, this is solved for on its own side of 0; where it comes to 0 and the forces
/// on either side lead back to it, it stays there until they no longer do (Filippov's solution).
class ForcedKick {
 public:
  explicit ForcedKick(const text::SizedScene& scene);

  /// Of the state x with ∇V at its place.
  StepStatus kick(double* x, const double* slope, double t, double h, Work& work);

 private:
  /// Writes F and ∂F/∂p at the place of x and some momenta p; null: at rest.
  void look(const double* x, const double* p, double t);
  void exact(const double* x, const double* slope, double t, double h);
  StepStatus midpoint(const double* x, const double* slope, double t, double h, Work& work);
  /// Of momenta that come to 0, or rest there.
  StepStatus through_rest(const double* x, const double* slope, double t, double h, Work& work);
  const MatrixPhi& phi_of(double h);

  const text::SizedScene* scene_;
  std::size_t n_;
  std::vector<double> at_;      ///< q and p, where forces are looked at
  std::vector<double> looked_;  ///< F and ∂F/∂p there
  std::vector<double> rate_;    ///< ṗ at the start of the kick
  std::vector<double> change_;  ///< of p
  std::vector<double> middle_;  ///< the mean of p over the kick, or its midpoint
  std::vector<double> velocity_, matrix_;
  std::vector<double> above_, below_;  ///< ṗ on either side of 0
  std::vector<double> side_;           ///< of 0, 1 or −1; 0 of what rests
  double work_ = 0;                    ///< of the kick

  /// Of matrices of numbers, by the length of kicks; steppers that are copied share them.
  struct Known {
    double h = std::numeric_limits<double>::quiet_NaN();
    MatrixPhi phi;
  };
  std::shared_ptr<std::vector<Known>> known_;
};

/// Kicks and drifts. Kicks that meet stay two where they are not exact, so that a composition of symmetric maps is one.
class ForcedKickDrift {
 public:
  using Piece = Sequence<double>::Piece;

  ForcedKickDrift(const text::SizedScene& scene, std::vector<Piece> pieces);

  void begin(StateView x);
  /// A step that fails leaves neither the state nor the stepper as they were.
  StepStatus step(double* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  void look(const double* q, double t);

  const text::SizedScene* scene_;
  std::vector<Piece> pieces_;  ///< as fractions of the step
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

/// The discrete Lagrange–d'Alembert principle of a path of polynomials and a rule of quadrature, for any regular H,
/// with F beside −H_q: as a pair of Runge–Kutta methods, one for q and one for p. Collocation at Gauss' nodes is such a
/// pair, too, and of an H without s the map of core/schemes/hamiltonian_gauss.hpp. Of few coordinates.
class StageRule {
 public:
  static constexpr std::size_t most_stages = 3;
  struct Rule {
    std::size_t stages;
    std::array<std::array<double, most_stages>, most_stages> of_places, of_momenta;
    std::array<double, most_stages> weight, node;
    bool parabolas = false;
  };
  static const Rule midpoint;  ///< of straight paths: the implicit midpoint rule
  static const Rule simpson;   ///< of parabolas: Lobatto's pair IIIA–IIIB, with velocities that are linear in time
  static Rule gauss(int stages);

  StageRule(const text::SizedScene& scene, const Rule& rule, const Composition& composition);

  void begin(StateView) { work_ = {}; }
  StepStatus step(double* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  using Newton = SimplifiedNewton<double, most_stages * 2 * text::SizedScene::most_full>;

  StepStatus stage(double* x, double t, double h);
  /// (1 − h A ⊗ J)⁻¹ with J at the point y.
  void prepare(const double* y, double t, double h);
  const auto& part(std::size_t i) const { return i < width_ / 2 ? rule_.of_places : rule_.of_momenta; }
  bool is_bent(std::size_t i) const { return rule_.parabolas && i >= width_ / 2; }

  const text::SizedScene* scene_;
  Rule rule_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t width_;                 ///< of q and p
  std::vector<double> at_, rates_;    ///< a stage; the rates of all components at the stages
  std::vector<double> z_;             ///< stages less the start
  std::array<double, 2> weighs_{};    ///< what brings places and momenta to one unit
  std::vector<Slope> along_, moved_;  ///< a point and the rates there, with their changes in a direction
  std::shared_ptr<Newton> newton_;    ///< shared by copies: it keeps nothing from one step to the next
  Work work_;
};

}  // namespace least

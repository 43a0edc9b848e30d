#include "core/schemes/lifted_splitting.hpp"

namespace least {

SchemeCard LiftedSplitting::card() {
  return {
      .id = "lifted_splitting",
      .title = "Lifted splitting",
      .summary =
          "A splitting of what is not separable: terms linear in the momenta, and any s, move the coordinates by "
          "a method of their own, and the momenta go along by its exact derivative.",
      .orders = orders_from(2),
      .symmetric = true,
      .structure = "contact",
      .recommended = "kahan_li_6",
      .good_for =
          "rotating frames (exact), magnetic fields, Foucault's pendulum, friction that is not linear in s: "
          "explicit where the part linear in the momenta is; a linear one costs a fraction of contact_gauss; equations "
          "alone, as of van der Pol or Lorenz: automatic goes part by part, each exact where its rates are linear in "
          "their own variables",
      .fails_when =
          "forces call for short steps (ωh ≥ 2); a vector potential is large against the momentum, so that large "
          "parts cancel; with the lift extrapolation a step back does not return",
      .needs =
          "a Hamiltonian given as text, of no simpler form, whose terms beyond the linear in the momenta are "
          "quadratic with constant coefficients, or equations alone",
      .references = {"Kevrekidis, arXiv 2605.09103 (2026)", "Strang, SIAM J. Numer. Anal. 5, 506 (1968)",
                     "Hairer, Lubich, Wanner 2006, VI.5"}};
}
std::vector<Conflict> LiftedSplitting::conflicts(const ProblemCard& problem) const {
  if (lift != LiftMethod::exact || problem.lift == Lifted::exactly) return {};
  return {{"lift",
           "needs what is linear in the momenta, and what reads s, to be linear in the coordinates and s, or "
           "equations alone in their variables, with constant coefficients",
           "automatic, midpoint, extrapolation"}};
}

}  // namespace least

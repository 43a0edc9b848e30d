// harmonic_splitting: H = A + B, where A = ½ pᵀM⁻¹p + ½ qᵀKq is the motion of coupled oscillators, exact in their
// normal modes for steps of any length, and B what else V is, small where swings are. Motions along A and kicks by B
// take turns, kicks in the middle:
//   composition   A h/2, kick h, A h/2 (order 2, symmetric), and what it is composed to
//   saba_2 … aba_1064   made for weak kicks: see alternation.hpp
// Symplectic, time-reversible. The error of a step of ε = B/A is O(εh³) without a composition; SABA and ABA leave
// O(ε²h³) and less. What the fastest oscillator does is exact, but kicks meet it: where a step is half a period of one,
// or a multiple of that, they add up, and errors grow. Which scenes it runs is found from their text:
// core/text/harmonic.hpp. The map: core/schemes/harmonic_stepper.hpp. Look-alike: leapfrog, which drifts along straight
// lines and resolves the fastest oscillator or is unstable. Sources: McLachlan, BIT 35, 258 (1995); Laskar & Robutel,
// Celest. Mech. Dyn. Astron. 80, 39 (2001); Blanes et al., Appl. Numer. Math. 68, 58 (2013); Hairer, Lubich, Wanner
// 2006, XIII.1 on resonances.
#pragma once

#include <tuple>

#include "core/scheme.hpp"
#include "core/schemes/turns.hpp"

namespace least {

struct HarmonicSplitting {
  double step = 0.01;
  Composition composition = Composition::none;
  SplittingTurns splitting = SplittingTurns::strang;
  static constexpr std::tuple fields{
      step_field<HarmonicSplitting>(), composition_field<HarmonicSplitting>(),
      Field<HarmonicSplitting, SplittingTurns>{
          "splitting",
          "",
          "",
          "strang: a kick between two motions of the oscillators, which may be composed; saba and aba: for kicks that "
          "are weak, with long steps and without a composition",
          &HarmonicSplitting::splitting,
          {0, 0},
          turns_names}};
  static SchemeCard card() {
    return {.id = "harmonic_splitting",
            .title = "Harmonic splitting",
            .summary = "Exact motion of coupled oscillators in their normal modes, and kicks by what else there is.",
            .orders = orders_of_turns(),
            .symmetric = true,
            .structure = "symplectic",
            .good_for =
                "chains and lattices of springs, small swings about a minimum, one fast oscillator beside slow ones: "
                "steps that need not resolve it; with the splittings aba_864 and aba_1064 to many digits",
            .fails_when =
                "swings are so large that what is not quadratic rules, or a step is near a multiple of half a period "
                "of an oscillator that the kicks meet",
            .needs =
                "a scene as text, a potential V and a constant kinetic metric, of which V has a quadratic part at the "
                "origin that does not depend on time",
            .references = {"McLachlan, BIT 35, 258 (1995)", "Laskar, Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001)",
                           "Blanes, Casas, Farrés, Laskar, Makazaga, Murua, Appl. Numer. Math. 68, 58 (2013)",
                           "Hairer, Lubich, Wanner 2006, XIII.1"}};
  }
  std::vector<Conflict> conflicts(const ProblemCard&) const { return conflicts_of_turns(splitting, composition); }
  const Alternation<double>& turns() const {
    const auto* named = alternation_of(splitting);
    return named ? *named : Alternation<double>::of(composition);
  }
};

}  // namespace least

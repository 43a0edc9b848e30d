// harmonic_splitting: H = A + B, where A = ½ pᵀM⁻¹p + ½ qᵀKq is the motion of
// coupled oscillators, exact in their normal modes for steps of any length, and
// B what else V is, small where swings are. Motions along A and kicks by B take
// turns, kicks in the middle:
//   composition   A h/2, kick h, A h/2 (order 2, symmetric), and what it is
//   composed to saba_2 … aba_1064   made for weak kicks: see alternation.hpp
// Symplectic, time-reversible. The error of a step of ε = B/A is O(εh³) without
// a composition; SABA and ABA leave O(ε²h³) and less. What the fastest
// oscillator does is exact, but kicks meet it: where a step is half a period of
// one, or a multiple of that, they add up, and errors grow. Which scenes it
// runs is found from their text: core/text/harmonic.hpp. The map:
// core/schemes/harmonic_stepper.hpp. Look-alike: leapfrog, which drifts along
// straight lines and resolves the fastest oscillator or is unstable. Sources:
// McLachlan, BIT 35, 258 (1995); Laskar & Robutel, Celest. Mech. Dyn. Astron.
// 80, 39 (2001); Blanes et al., Appl. Numer. Math. 68, 58 (2013); Hairer,
// Lubich, Wanner 2006, XIII.1 on resonances.
#pragma once

#include <tuple>

#include "core/scheme.hpp"
#include "core/schemes/alternation.hpp"

namespace least {

enum class HarmonicSplittingKind : std::uint8_t { strang, saba_2, saba_4, aba_864, aba_1064 };
inline constexpr auto harmonic_splitting_names = [] {
  std::array<std::string_view, 1 + alternations::named.size()> all{"strang"};
  std::ranges::transform(alternations::named, all.begin() + 1, &alternations::Named::name);
  return all;
}();

struct HarmonicSplitting {
  double step = 0.01;
  Composition composition = Composition::none;
  HarmonicSplittingKind splitting = HarmonicSplittingKind::strang;
  static constexpr std::tuple fields{step_field<HarmonicSplitting>(), composition_field<HarmonicSplitting>(),
                                     Field<HarmonicSplitting, HarmonicSplittingKind>{
                                         "splitting",
                                         "",
                                         "",
                                         "strang: a kick between two motions of the oscillators, which may be "
                                         "composed; saba and aba: for kicks that "
                                         "are weak, with long steps and without a composition",
                                         &HarmonicSplitting::splitting,
                                         {0, 0},
                                         harmonic_splitting_names}};
  static SchemeCard card() {
    return {.id = "harmonic_splitting",
            .title = "Harmonic splitting",
            .summary =
                "Exact motion of coupled oscillators in their normal "
                "modes, and kicks by what else there is.",
            .orders = orders(),
            .symmetric = true,
            .structure = "symplectic",
            .good_for =
                "chains and lattices of springs, small swings about a "
                "minimum, one fast oscillator beside slow ones: "
                "steps that need not resolve it; with the splittings "
                "aba_864 and aba_1064 to many digits",
            .fails_when =
                "swings are so large that what is not quadratic rules, or a "
                "step is near a multiple of half a period "
                "of an oscillator that the kicks meet",
            .needs =
                "a scene as text, a potential V and a constant kinetic "
                "metric, of which V has a quadratic part at the "
                "origin that does not depend on time",
            .references = {"McLachlan, BIT 35, 258 (1995)", "Laskar, Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001)",
                           "Blanes, Casas, Farrés, Laskar, Makazaga, Murua, Appl. Numer. "
                           "Math. 68, 58 (2013)",
                           "Hairer, Lubich, Wanner 2006, XIII.1"}};
  }
  std::vector<Conflict> conflicts(const ProblemCard&) const {
    if (splitting == HarmonicSplittingKind::strang || composition == Composition::none) return {};
    return {{"composition", "goes with the splitting strang: the others have their own order", "none"}};
  }
  const Alternation<double>& turns() const {
    if (splitting == HarmonicSplittingKind::strang) return Alternation<double>::of(composition);
    return Alternation<double>::named(static_cast<std::size_t>(splitting) - 1);
  }

 private:
  static std::vector<std::pair<std::string, int>> orders() {
    auto all = orders_from(2);
    for (const auto& named : alternations::named) all.emplace_back(named.name, named.order);
    return all;
  }
};

}  // namespace least

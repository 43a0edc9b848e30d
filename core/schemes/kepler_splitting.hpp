// kepler_splitting, after Wisdom and Holman: H = A + B, where in A each body is alone with its centre, which it goes
// round as Kepler says, exactly and for steps of any length, and B is what else there is, small where the centre is
// heavy or its pull strong. One step is
//   composition   kick h/2, Kepler h, kick h/2 (order 2, symmetric), and what it is composed to
//   saba_2 … aba_1064   Kepler and kicks in turn, made for weak kicks: see alternation.hpp
// Symplectic, time-reversible; linear and angular momentum are kept. The error of a step of ε = B/A is O(εh³) without a
// composition; SABA and ABA leave O(ε²h³) and less. It assumes that kicks resolve the passages of a body through its
// nearest place (10 to 20 a turn at a small eccentricity) and encounters of two that revolve, and cannot check it.
// A motion along Kepler's orbits counts as an evaluation of the forces, as it takes as long as one.
// Which scenes it runs is found from their text: core/text/planetary.hpp. The map:
// core/catalogue/planetary_stepper.hpp. Look-alike: leapfrog with heliocentric coordinates, whose drifts are straight.
// Sources: Wisdom & Holman, Astron. J. 102, 1528 (1991); Duncan, Levison & Lee, Astron. J. 116, 2067 (1998); Laskar &
// Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001); Blanes et al., Appl. Numer. Math. 68, 58 (2013).
#pragma once

#include <optional>
#include <tuple>

#include "core/scheme.hpp"
#include "core/schemes/turns.hpp"

namespace least {

enum class KeplerCoordinates : std::uint8_t { jacobi, heliocentric };
inline constexpr std::array<std::string_view, 2> kepler_coordinate_names{"jacobi", "heliocentric"};

struct KeplerSplitting {
  double step = 0.01;
  Composition composition = Composition::none;
  SplittingTurns splitting = SplittingTurns::strang;
  KeplerCoordinates coordinates = KeplerCoordinates::jacobi;
  static constexpr std::tuple fields{
      step_field<KeplerSplitting>(), composition_field<KeplerSplitting>(),
      Field<KeplerSplitting, SplittingTurns>{
          "splitting",
          "",
          "",
          "strang: kicks around one motion along Kepler's orbits, which may be composed; saba and aba: for kicks that "
          "are weak, with long steps and without a composition",
          &KeplerSplitting::splitting,
          {0, 0},
          turns_names},
      Field<KeplerSplitting, KeplerCoordinates>{
          "coordinates",
          "",
          "",
          "jacobi: of each body from the centre of mass of those nearer to the centre at the start, the most accurate "
          "where they stay in this order; heliocentric: democratic, for bodies that pass each other. About a fixed "
          "centre both are the same",
          &KeplerSplitting::coordinates,
          {0, 0},
          kepler_coordinate_names}};
  static SchemeCard card() {
    return {.id = "kepler_splitting",
            .title = "Kepler splitting (Wisdom–Holman)",
            .summary = "Exact motion along Kepler's orbits, and kicks by what else there is.",
            .orders = orders_of_turns(),
            .symmetric = true,
            .structure = "symplectic",
            .good_for =
                "planets about a star and whatever is near to that: steps of a tenth of a turn, bounded energy over "
                "long runs; with the splittings aba_864 and aba_1064 to many digits",
            .fails_when = "two light bodies meet, or a step does not resolve the nearest passage of an eccentric orbit",
            .needs =
                "a scene as text, p²/2m + V, whose V has a term −k/r for each body in the plane or in space: about one "
                "body that is heavier than the others, or about a fixed centre",
            .references = {"Wisdom, Holman, Astron. J. 102, 1528 (1991)",
                           "Duncan, Levison, Lee, Astron. J. 116, 2067 (1998)",
                           "Laskar, Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001)",
                           "Blanes, Casas, Farrés, Laskar, Makazaga, Murua, Appl. Numer. Math. 68, 58 (2013)"}};
  }
  std::vector<Conflict> conflicts(const ProblemCard&) const { return conflicts_of_turns(splitting, composition); }
  /// The turns of the splitting; null for strang.
  const Alternation<double>* turns() const { return alternation_of(splitting); }
};

}  // namespace least

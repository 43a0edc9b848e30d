// The field's published tests: scenes as text, their starts, and what is known of their ends.
//   A1 … E5    DETEST: Hull, Enright, Fellen, Sedgwick, SIAM J. Numer. Anal. 9, 603 (1972); values: Enright, Pryce, ACM
//              Trans. Math. Softw. 13, 1 (1987)
//   Pleiades, Arenstorf's orbit, Lorenz: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993
//   van der Pol, μ = 1000: Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, IV.10
//   figure eight: Chenciner, Montgomery, Ann. Math. 152, 881 (2000)
//   outer solar system: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.2.4
//   Pythagorean three bodies: Burrau, Astron. Nachr. 195, 113 (1913); Szebehely, Peters, Astron. J. 72, 876 (1967)
// Of the last two, and of Lorenz, the ends are from Taylor series of order 34 in quadruple precision, by a program that
// shares nothing with this library: runs of two tolerances agree in as many digits as are given. The references of this
// library, in double-double, are held against them, too.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/texts.hpp"

namespace torture {

struct Published {
  std::string name, what;
  least::text::TypedScene scene;
  std::vector<double> start;  ///< variables in the order of the scene, then momenta
  double end = 20;
  std::vector<double> known;   ///< the first of these, as many as are known
  int digits, digits_of_auto;  ///< in which our runs agree, relative to max(1, the largest of them)
};

/// all_published() returns all tests, in the order of the table.
std::vector<Published> all_published();
/// add_motions() adds the tests of many bodies and of chaos, the latter last.
void add_motions(std::vector<Published>& all);

/// Agreement is the result of a run of a test, by `taylor` at the tolerance 1e-15 or by `auto` at 1e-9.
struct Agreement {
  double digits = 0, seconds = 0;
  std::string scheme;
};
Agreement agreement_of(const Published& test, bool automatic);
/// agreement_of_reference() returns the digits in which the library's reference agrees; nothing where the reference
/// itself does not claim 1e-12.
std::optional<double> agreement_of_reference(const Published& test);

/// EnergyRow asks for the energy of the outer solar system over 200,000 days, by a scheme with a step of `step` days.
struct EnergyRow {
  std::string scheme, composition;  ///< or splitting
  double step;
  double most;  ///< an upper bound of the largest relative error of the energy
};
std::vector<EnergyRow> energy_rows();
struct EnergyError {
  double most = 0, last = 0, seconds = 0;
  std::int64_t forces = 0;
};
EnergyError energy_of(const EnergyRow& row);

}  // namespace torture

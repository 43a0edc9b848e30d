// The field's published tests: scenes as text, their starts, and what is known of their ends.
//   A1 … E5    DETEST: Hull, Enright, Fellen, Sedgwick, SIAM J. Numer. Anal. 9, 603 (1972); values: Enright, Pryce, ACM
//              Trans. Math. Softw. 13, 1 (1987)
//   Pleiades, Arenstorf's orbit, Lorenz: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993
//   van der Pol, μ = 1000: Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, IV.10
//   figure eight: Chenciner, Montgomery, Ann. Math. 152, 881 (2000)
#pragma once

#include <string>
#include <vector>

#include "tests/support/texts.hpp"

namespace torture {

struct Published {
  std::string name, what;
  least::text::TypedScene scene;
  std::vector<double> start;  ///< variables in the order of the scene, then momenta
  double end = 20;
  std::vector<double> known;   ///< of these the first so many
  int digits, digits_of_auto;  ///< in which our runs agree, relative to max(1, the largest of them)
};

/// All of them, in the order of the table.
std::vector<Published> all_published();

/// A run of one, by taylor at the tolerance 1e-15 or by auto at 1e-9.
struct Agreement {
  double digits = 0, seconds = 0;
  std::string scheme;
};
Agreement agreement_of(const Published& test, bool automatic);

}  // namespace torture

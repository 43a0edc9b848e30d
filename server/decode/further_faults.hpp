// Finds all faults of a scene given as text, where some hide others: definitions are read before the texts that use
// them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/text/written_out.hpp"

namespace least::server {

/// FurtherFaults holds all faults that were found in a scene.
struct FurtherFaults {
  std::vector<text::DefinitionFault> faults;
  /// The scene with its faulty texts replaced. It has the variables, parameters and columns that the mended scene will
  /// have, so that the rest of a request can be read. Null where the search ended before.
  std::shared_ptr<const Mechanics> stand_in;
};

/// further_faults returns, besides `first`, the faults that appear when the faulty texts are replaced by numbers, and
/// L, H or V by the simplest mechanics, repeatedly. The search ends where variables or parameters would have to be
/// replaced.
FurtherFaults further_faults(text::TypedScene typed, std::vector<text::DefinitionFault> first);

/// simplest_formula returns the simplest mechanics of the scene's kind in its variables: L = Σ v²/2, H = Σ p²/2 or V =
/// 0. Where the replaced `text` speaks of the action s, it is dissipative by s.
std::string simplest_formula(const text::Definition& scene, std::string_view text);

}  // namespace least::server

// How two exact motions take turns where one of them is weak, as the scheme's setting `splitting`: strang, which may be
// composed, or a splitting of core/schemes/alternation.hpp, which has an order of its own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/scheme.hpp"
#include "core/schemes/alternation.hpp"

namespace least {

enum class SplittingTurns : std::uint8_t { strang, saba_2, saba_4, aba_864, aba_1064 };
inline constexpr auto turns_names = [] {
  std::array<std::string_view, 1 + alternations::named.size()> all{"strang"};
  std::ranges::transform(alternations::named, all.begin() + 1, &alternations::Named::name);
  return all;
}();

/// Null for strang.
inline const Alternation<double>* alternation_of(SplittingTurns turns) {
  return turns == SplittingTurns::strang ? nullptr : &Alternation<double>::named(static_cast<std::size_t>(turns) - 1);
}
/// The orders by composition or splitting, as a scheme's card lists them.
inline std::vector<std::pair<std::string, int>> orders_of_turns() {
  auto all = orders_from(2);
  for (const auto& named : alternations::named) all.emplace_back(named.name, named.order);
  return all;
}
inline std::vector<Conflict> conflicts_of_turns(SplittingTurns turns, const Composition& composition) {
  if (turns == SplittingTurns::strang || composition == Composition::none) return {};
  return {{"composition", "goes with the splitting strang: the others have their own order", "none"}};
}

}  // namespace least

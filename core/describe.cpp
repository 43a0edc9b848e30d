#include "core/describe.hpp"

#include <algorithm>

#include "core/composition.hpp"

namespace least {

std::optional<std::size_t> SchemeCard::find(std::string_view parameter) const {
  const auto found = std::ranges::find(parameters, parameter, &ParameterCard::name);
  if (found == parameters.end()) return std::nullopt;
  return static_cast<std::size_t>(found - parameters.begin());
}

int order_with_weights(const SchemeCard& card, std::span<const double> settings) {
  const int base = card.orders.empty() ? 2 : card.orders.front().second;
  return compositions::order_of(weights_of(card, settings), base);
}

}  // namespace least

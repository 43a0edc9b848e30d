#include "core/describe.hpp"

#include <algorithm>
#include <string>

#include "core/composition.hpp"

namespace least {

std::optional<std::size_t> SchemeCard::find(std::string_view parameter) const {
  const auto found = std::ranges::find(parameters, parameter, &ParameterCard::name);
  if (found == parameters.end()) return std::nullopt;
  return static_cast<std::size_t>(found - parameters.begin());
}

int SchemeCard::order(std::span<const double> settings) const {
  int most = 0;  // a composition and a splitting each have an order: the higher one counts
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterCard& parameter = parameters[i];
    if (parameter.kind != Kind::choice && parameter.kind != Kind::integer) continue;
    if (has_weights(parameter, settings[i])) return order_with_weights(*this, settings);
    const auto value = static_cast<std::size_t>(settings[i]);
    const std::string word = parameter.kind == Kind::choice ? parameter.choices[value] : std::to_string(value);
    for (const auto& [key, order] : orders)
      if (key == word) most = std::max(most, order);
  }
  return most > 0 || orders.empty() ? most : orders.front().second;
}

int order_with_weights(const SchemeCard& card, std::span<const double> settings) {
  const int base = card.orders.empty() ? 2 : card.orders.front().second;
  return compositions::order_of(weights_of(card, settings), base);
}

}  // namespace least

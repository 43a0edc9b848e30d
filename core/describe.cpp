#include "core/describe.hpp"

#include <algorithm>

namespace least {

std::optional<std::size_t> SchemeCard::find(std::string_view parameter) const {
  const auto found = std::ranges::find(parameters, parameter, &ParameterCard::name);
  if (found == parameters.end()) return std::nullopt;
  return static_cast<std::size_t>(found - parameters.begin());
}

}  // namespace least

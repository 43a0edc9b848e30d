// Conversion of the values of a card's parameters to an aggregate.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "core/describe.hpp"

namespace least {

/// from_values returns a C whose members have these values, in the order of `fields`; values after those are the custom
/// weights of its composition.
template <class C, class Fields>
C from_values(const Fields& fields, std::span<const double> values) {
  C c;
  std::apply(
      [&](const auto&... field) {
        std::size_t i = 0;
        (field.set(c, values[i++]), ...);
      },
      fields);
  if constexpr (requires { c.composition; })  // the values after the fields are custom weights
    c.composition =
        decltype(c.composition)(static_cast<double>(c.composition), values.subspan(std::tuple_size_v<Fields>));
  return c;
}

template <class Fields>
std::vector<ParameterCard> parameter_cards(const Fields& fields) {
  return std::apply([](const auto&... field) { return std::vector<ParameterCard>{field.card()...}; }, fields);
}

}  // namespace least

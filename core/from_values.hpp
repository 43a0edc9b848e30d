// From a card's values to an aggregate and back.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "core/describe.hpp"

namespace least {

/// An aggregate with the values of a card's parameters, and what stands after them.
template <class C, class Fields>
C from_values(const Fields& fields, std::span<const double> values) {
  C c;
  std::apply(
      [&](const auto&... field) {
        std::size_t i = 0;
        (field.set(c, values[i++]), ...);
      },
      fields);
  if constexpr (requires { c.composition; })  // after them its weights, where it has its own
    c.composition =
        decltype(c.composition)(static_cast<double>(c.composition), values.subspan(std::tuple_size_v<Fields>));
  return c;
}

template <class Fields>
std::vector<ParameterCard> parameter_cards(const Fields& fields) {
  return std::apply([](const auto&... field) { return std::vector<ParameterCard>{field.card()...}; }, fields);
}

}  // namespace least

// Constants given as decimal strings, read into any number without losing digits.
#pragma once

#include <charconv>
#include <string_view>
#include <type_traits>

namespace least {

/// The number nearest to the decimal text; T is double, or constructible from text.
template <class T>
T parse(std::string_view text) {
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, long double>) {
    T value{};
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  } else {
    return T(text);
  }
}

}  // namespace least

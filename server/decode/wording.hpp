// Words of error messages: ranges, lists of names, "did you mean".
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/describe.hpp"

namespace least::server {

using Names = std::vector<std::string_view>;

/// The shortest text of a number: 1000 is `1e3`, .5 is `0.5`, infinity is `inf`.
std::string shortest(double x);

/// `(0, 1e3]`
std::string interval(const Range& range);

/// `a, b, c`
std::string listed(std::span<const std::string_view> names);

/// The name that others call by this word (`rk4`, `dt`), else the one closest to a misspelt one, or empty when none is
/// close. Case does not count, a swap of neighbours counts once.
std::string_view closest(std::string_view word, std::span<const std::string_view> names);

/// `; did you mean "leapfrog"?` or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> names);

}  // namespace least::server

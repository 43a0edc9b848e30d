// The words of error messages: ranges, lists of names, "did you mean".
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

/// closest returns the name for which `word` is a common synonym (`rk4`, `dt`), else the name closest to a misspelt
/// word; empty when none is close. Case is ignored, and a swap of neighbouring letters counts as one error.
std::string_view closest(std::string_view word, std::span<const std::string_view> names);

/// did_you_mean returns `; did you mean "leapfrog"?` or an empty text.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> names);

}  // namespace least::server

// first_change finds where a polynomial c₀ + c₁t + …, the series of a value whose sign chooses a formula, first changes
// its sign. It passes over no zero, however close two of them lie: a stretch of time is halved until the expansion
// about its middle proves that it has no zero, or at most one, because its first terms outweigh all others. Source:
// Moore, Interval Analysis, 1966, chapters 3 and 7.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace least::tape {

inline constexpr std::size_t most_terms = 64;

struct Stretch {
  double low, high;
};

/// Returns Σ cₖ timeᵏ.
double value_at(std::span<const double> c, double time);

/// Returns how far, at most `end`, the truncated series c represents its value: up to the time where its last two terms
/// reach `tolerance` times its largest term. Such a value may change much faster than the motion itself.
double told_until(std::span<const double> c, double end, double tolerance);

/// Returns the first stretch of [0, end] at whose end the value is no longer on its side of zero (below if `negative`),
/// and on which it changes sides once; zero counts as above. Returns nothing where the side never changes, or only for
/// a time too short to be told from rounding. c has at most `most_terms` coefficients.
std::optional<Stretch> first_change(std::span<const double> c, double end, bool negative);

}  // namespace least::tape

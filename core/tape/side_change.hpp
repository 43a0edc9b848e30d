// Where a polynomial c₀ + c₁t + …, as a series has it of what a formula is chosen by, leaves the side of 0 on which it
// begins: none of its zeros is passed over, however close two of them lie. On a stretch of time that is halved until it
// says so, the polynomial about the middle has no zero, or one at most, where its first terms outweigh all others.
// Source: Moore, Interval Analysis, 1966, chapters 3 and 7.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace least::tape {

inline constexpr std::size_t most_terms = 64;

struct Stretch {
  double low, high;
};

/// The value at a time.
double value_at(std::span<const double> c, double time);

/// How far, at most `end`, such a series of a value says what the value is: up to where its last two terms come to the
/// part `tolerance` of its largest one. A smooth motion may be asked for what changes much faster than it.
double told_until(std::span<const double> c, double end, double tolerance);

/// Of [0, end] the first stretch at whose end the side has changed, and on which it changes once; at a zero the value
/// is not negative. None where it stays on its side, or touches zero for no longer than rounding can tell. At most
/// `most_terms` coefficients.
std::optional<Stretch> first_change(std::span<const double> c, double end, bool negative);

}  // namespace least::tape

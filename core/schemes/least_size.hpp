// What the tolerance of a step is relative to.
#pragma once

namespace least {

/// usual_size returns whether a motion that starts with this size may be given in units in which it is about 1: to such
/// motions a tolerance is absolute and relative alike. Sizes below 1e-50 and above 1e50 count as usual, too: no units
/// lead to them, and a search for what is at rest starts there.
constexpr bool usual_size(double size) {
  constexpr double least = 1e-3, most = 1e3, of_any_unit = 1e50;
  return (size >= least && size <= most) || !(size > 1 / of_any_unit && size < of_any_unit);
}

/// least_size returns the size below which errors of steps are absolute, for a motion whose components are at most
/// `largest` in size at its start: 1, or `largest` where that is less than usual. So a motion of nanometres, given in
/// metres, keeps its digits. A start at 0 says nothing of the size of a motion: then it is 1.
constexpr double least_size(double largest) { return largest < 1 && !usual_size(largest) ? largest : 1; }

}  // namespace least

// The results of blocks of members and their reduction: blocks of 4,096 at absolute indices, each summed in the order
// of its members, then block after block. Hence the sums do not depend on who computed which block, nor when.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/run/outcome.hpp"

namespace least {

inline constexpr std::int64_t block_size = 4096;

/// Moments of the values of a column: their number, mean, sum of squares about the mean, and extremes.
struct Moments {
  std::int64_t count = 0;
  double mean = 0, squares = 0;
  double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;

  /// of(values) returns the moments of all finite values.
  static Moments of(const std::vector<double>& values);
  /// add(more) merges the moments of further values. Source: Chan, Golub, LeVeque, Am. Stat. 37, 242 (1983).
  void add(const Moments& more);
  /// variance() is unbiased; NaN for fewer than two values.
  double variance() const;
};

/// HistogramAsked is the request for a histogram of a column of the ensemble, with bins [low + i·w, low + (i + 1)·w).
struct HistogramAsked {
  std::size_t column = 0;
  double low = 0, high = 1;
  std::int64_t bins = 1;
};
/// Histogram holds the counts by bin and of values on either side of the range. Values that are not finite are not
/// counted.
struct Histogram {
  std::vector<std::int64_t> counts;
  std::int64_t below = 0, above = 0;

  void count(const HistogramAsked& asked, double value);
  void add(const Histogram& more);
};

/// SectionPoints are the states at which members met a section: `values` has one entry per column for each point, row
/// by row.
struct SectionPoints {
  std::vector<std::int64_t> member, crossing;
  std::vector<double> t, values;

  /// append and make_room charge the memory to `held` before they take it; both throw MemoryShortage.
  void append(const SectionPoints& more, std::size_t most, std::size_t columns, Held& held);
  void make_room(std::size_t points, std::size_t columns, Held& held);
  /// cut keeps only the first `most` points.
  void cut(std::size_t most, std::size_t columns);
  /// sort orders the points by member, then crossing, and keeps the first `most`. The points must be of members [first,
  /// first + count), and those of each member already in order. `going` is asked now and then; once it returns false
  /// the points are left unusable.
  template <class Going>
  void sort(std::int64_t first, std::size_t count, std::size_t most, Held& held, Going&& going);
};

/// Trajectories are rows along the motion of members, a number per column: the rows of each member together, in the
/// order of time.
struct Trajectories {
  std::vector<std::int64_t> member, rows;  ///< rows: how many each member has; one that stopped early has those before
  std::vector<double> values;

  /// Charges the memory to `held` before it is taken; throws MemoryShortage.
  void append(const Trajectories& more, Held& held);

  /// open(first, members, numbers) makes room for the rows of members from `first` on, at most `numbers` doubles for
  /// each, which may be added in any order.
  void open(std::int64_t first, std::size_t members, std::size_t numbers, Held& held);
  /// add(place, row) appends a row of the member at that place.
  void add(std::size_t place, const std::vector<double>& row);
  /// close(columns) removes the gaps behind members with fewer rows than there is room for.
  void close(std::size_t columns);
};

/// Endings counts members by the reason why they ended; `completed` is among the reasons.
using Endings = std::array<std::int64_t, static_cast<std::size_t>(ReturnCode::cancelled) + 1>;

/// Harvest is the result of the members of one block, or of all of them. Parts that are not asked for are empty.
struct Harvest {
  Endings ended{};
  std::vector<Moments> columns;
  std::vector<Histogram> histograms;
  std::vector<std::int64_t> final_member;  ///< the members that completed
  std::vector<double> final;               ///< their final columns, row by row
  SectionPoints section;
  Trajectories trajectories;  ///< of all members
  bool truncated = false;     ///< the limit of section points was exceeded
  /// Members that may lack points, as the search for them remained unresolved: their number, and the first of them.
  std::int64_t unresolved = 0, first_unresolved = 0;
  Cost cost;  ///< summed over all members

  void add_unresolved(std::int64_t member) {
    if (unresolved++ == 0) first_unresolved = member;
  }
  /// add(more, most, held) adds the results of a later block and keeps at most `most` points of sections. Throws
  /// MemoryShortage.
  void add(const Harvest& more, std::size_t most, Held& held);
  void add(const Harvest& more, std::size_t most) {
    Held unbounded;
    add(more, most, unbounded);
  }
};

/// Block is a range of members with the same block number, and its results.
struct Block {
  std::int64_t index = 0;  ///< of the block; it has members [4096·index, 4096·(index + 1)) as far as they are asked for
  std::int64_t first = 0, count = 0;
  Harvest harvest;
  Held held{};  ///< the memory of `harvest`
};

template <class Going>
void SectionPoints::sort(std::int64_t first, std::size_t count, std::size_t most, Held& held, Going&& going) {
  const std::size_t points = t.size(), kept = std::min(points, most);
  constexpr std::size_t piece = std::size_t{1} << 16;
  bool goes_on = points > 0;
  const auto may = [&](std::size_t done) { return goes_on = goes_on && (done % piece != 0 || going()); };
  std::vector<std::size_t> next(count + 1, 0);  // index of the first point of each member
  for (const std::int64_t m : member) ++next[static_cast<std::size_t>(m - first) + 1];
  for (std::size_t m = 0; m < count; ++m) next[m + 1] += next[m];
  std::vector<std::size_t> order;
  least::make_room(order, points, held);
  order.resize(points);
  for (std::size_t i = 0; i < points && may(i); ++i) order[next[static_cast<std::size_t>(member[i] - first)]++] = i;
  const auto rearrange = [&](auto& list) {
    if (!goes_on) return;
    const std::size_t width = list.size() / points;
    std::remove_cvref_t<decltype(list)> sorted;
    least::make_room(sorted, kept * width, held);
    for (std::size_t i = 0; i < kept && may(i); ++i) {
      const auto row = list.begin() + static_cast<std::ptrdiff_t>(order[i] * width);
      sorted.insert(sorted.end(), row, row + static_cast<std::ptrdiff_t>(width));
    }
    held.shrink_by(list.capacity() * sizeof(list[0]));
    list = std::move(sorted);
  };
  rearrange(member);
  rearrange(crossing);
  rearrange(t);
  rearrange(values);
  held.shrink_by(order.capacity() * sizeof(order[0]));
}

}  // namespace least

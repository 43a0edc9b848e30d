// What blocks of members leave behind, and how it adds up: blocks of 4,096 at absolute indices, each summed in the
// order of its members, the blocks in theirs. So the sums do not depend on who computed which block, nor when.
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

/// Of the values of a column: how many there are, their mean, the sum of squares about it, and the extremes.
struct Moments {
  std::int64_t count = 0;
  double mean = 0, squares = 0;
  double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;

  /// Of all that are numbers.
  static Moments of(const std::vector<double>& values);
  /// Adds those of further values. Source: Chan, Golub, LeVeque, Am. Stat. 37, 242 (1983).
  void add(const Moments& more);
  /// Unbiased; NaN for fewer than two.
  double variance() const;
};

/// A histogram that is asked for, of a column of the ensemble, in bins [low + i·w, low + (i + 1)·w).
struct HistogramAsked {
  std::size_t column = 0;
  double low = 0, high = 1;
  std::int64_t bins = 1;
};
/// Counts by bin, as many as there are, and of the values on either side of the range; what is no finite number is not
/// counted.
struct Histogram {
  std::vector<std::int64_t> counts;
  std::int64_t below = 0, above = 0;

  void count(const HistogramAsked& asked, double value);
  void add(const Histogram& more);
};

/// The states at which members met a section: one entry of `values` per column and point, row by row.
struct SectionPoints {
  std::vector<std::int64_t> member, crossing;
  std::vector<double> t, values;

  /// Room for so many points is held before it is taken: both throw MemoryShortage.
  void append(const SectionPoints& more, std::size_t most, std::size_t columns, Held& held);
  void make_room(std::size_t points, std::size_t columns, Held& held);
  /// Leaves out all but the first.
  void cut(std::size_t most, std::size_t columns);
  /// The first `most` points in the order of members and crossings, of members [first, first + count), each of whose
  /// points stand in their order. `going` is asked now and then: false leaves them as nobody can use them.
  template <class Going>
  void sort(std::int64_t first, std::size_t count, std::size_t most, Held& held, Going&& going);
};

/// Rows along the way of members, a number per column: those of each member together, in the order of time.
struct Trajectories {
  std::vector<std::int64_t> member, rows;  ///< how many rows it has: of one that stopped, those before
  std::vector<double> values;

  /// Room is held before it is taken: throws MemoryShortage.
  void append(const Trajectories& more, Held& held);

  /// Begins the rows of so many members from `first` on, so many numbers of each at most, which come in any order.
  void open(std::int64_t first, std::size_t members, std::size_t numbers, Held& held);
  /// The next row of one of them, by its place.
  void add(std::size_t place, const std::vector<double>& row);
  /// Closes up behind members that have fewer rows than there is room for.
  void close(std::size_t columns);
};

/// How members ended, by the name of the reason; `completed` among them.
using Endings = std::array<std::int64_t, static_cast<std::size_t>(ReturnCode::cancelled) + 1>;

/// What the members of one block, or of all of them, leave behind. What is not asked for is empty.
struct Harvest {
  Endings ended{};
  std::vector<Moments> columns;
  std::vector<Histogram> histograms;
  std::vector<std::int64_t> final_member;  ///< of those that completed
  std::vector<double> final;               ///< row by row, a number per column
  SectionPoints section;
  Trajectories trajectories;  ///< of all members
  bool truncated = false;     ///< there were more points than may be kept
  /// Members of which points may be missing, since the search for them ended unresolved: how many, and the first.
  std::int64_t unresolved = 0, first_unresolved = 0;
  Cost cost;  ///< steps of all members

  void add_unresolved(std::int64_t member) {
    if (unresolved++ == 0) first_unresolved = member;
  }
  /// Adds a later block's; no more than `most` points of sections are kept. Throws MemoryShortage.
  void add(const Harvest& more, std::size_t most, Held& held);
  void add(const Harvest& more, std::size_t most) {
    Held unbounded;
    add(more, most, unbounded);
  }
};

struct Block {
  std::int64_t index = 0;  ///< members [4096·index, 4096·(index + 1)), as far as they are within the range asked for
  std::int64_t first = 0, count = 0;
  Harvest harvest;
  Held held{};  ///< for that
};

template <class Going>
void SectionPoints::sort(std::int64_t first, std::size_t count, std::size_t most, Held& held, Going&& going) {
  const std::size_t points = t.size(), kept = std::min(points, most);
  constexpr std::size_t piece = std::size_t{1} << 16;
  bool goes_on = points > 0;
  const auto may = [&](std::size_t done) { return goes_on = goes_on && (done % piece != 0 || going()); };
  std::vector<std::size_t> next(count + 1, 0);  // where the points of a member begin
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

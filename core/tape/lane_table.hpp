// LaneTable finds the lane of a program that is the product of two values (core/tape/lowering.hpp).
#pragma once

#include <utility>

#include "core/tape/program.hpp"

namespace least::tape {

/// A hash table, at most half full.
class LaneTable {
 public:
  /// Returns the lane of a and b, in either order; it is appended to the program if there is none yet.
  constexpr Index of(Index a, Index b, Program& program) {
    if (a > b) std::swap(a, b);
    const std::size_t place = place_of(a, b, program);
    if (places_[place] != none) return places_[place];
    const auto added = static_cast<Index>(program.lane_a.size());
    program.lane_a.push_back(a);
    program.lane_b.push_back(b);
    if (2 * program.lane_a.size() < places_.size()) return places_[place] = added;
    places_.assign(2 * places_.size(), none);
    for (Index i = 0; i <= added; ++i) places_[place_of(program.lane_a[at(i)], program.lane_b[at(i)], program)] = i;
    return added;
  }

 private:
  static constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Returns the slot of the lane in the hash table, or the empty slot for it.
  constexpr std::size_t place_of(Index a, Index b, const Program& program) const {
    const std::uint64_t both = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b);
    const std::size_t mask = places_.size() - 1;
    std::size_t place = static_cast<std::size_t>((both * 0x9e3779b97f4a7c15ULL) >> 29) & mask;
    for (Index i = places_[place]; i != none; i = places_[place]) {
      if (program.lane_a[at(i)] == a && program.lane_b[at(i)] == b) break;
      place = (place + 1) & mask;
    }
    return place;
  }

  std::vector<Index> places_ = std::vector<Index>(64, none);
};

}  // namespace least::tape

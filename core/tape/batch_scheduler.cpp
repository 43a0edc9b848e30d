// Batches::Scheduler groups the steps of a formula into batches and gives their values places.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/tape/batches.hpp"
#include "core/tape/long_sums.hpp"

namespace least::tape {

namespace {

constexpr std::size_t few_steps = 200;  // with fewer, one by one is as fast
constexpr std::size_t few_alike = 5;    // steps of a batch, on average
// Scenes of few coordinates have many formulas, and every request makes its own: the memory of batches, ten bytes per
// operation, would cost more than the time they save.
constexpr std::ptrdiff_t few_variables = 17;
constexpr std::size_t few_values = 64;  // values of a part of a batch
constexpr std::size_t few_in_run = 4;   // values of a run, on average: with fewer, each is read from its own place

bool has_number(Code code) {
  switch (code) {
    case Code::constant:
    case Code::add_constant:
    case Code::from_constant:
    case Code::scale:
    case Code::over:
    case Code::power:
      return true;
    default:
      return false;
  }
}

}  // namespace

/// Groups steps by their depth (the longest chain of steps before them) and operation, finds which batches can run
/// together tile by tile, gives each batch that is read later a range of places, and frees the range after its last
/// reader.
class Batches::Scheduler {
 public:
  Scheduler(std::span<const Operation> steps, std::span<const Index> ends)
      : steps_(steps), ends_(ends), long_(steps, ends), at_(steps.size()) {
    group();
  }

  bool worthwhile() const { return steps_.size() >= few_alike * groups_.size(); }

  void schedule(Batches& made) {
    for (std::vector<Index>& alike : groups_) {
      order(alike);
      std::size_t place = 0;
      for (const Index i : alike) at_[at(i)] = place++;
    }
    find_last_readers();
    place_.resize(groups_.size());
    tiles_of_.resize(groups_.size());
    made.places_.push_back(zero);
    room_ = 1;  // for the zero
    for (std::size_t first = 0; first < groups_.size();) {
      std::size_t end = first + 1;
      if (is_sums(first)) {
        write_sums(made, first);
      } else {
        const std::size_t count = extend(first, end);
        write_together(made, first, end, count);
      }
      for (std::size_t g = first; g < end; ++g)
        for (const std::size_t ended : ending_[g])
          if (ended < first || is_kept(ended, end)) release(place_[ended], size_of(ended));
      first = end;
    }
    for (const Index end : ends_) made.ends_.push_back(place_of(end));
    made.room_ = room_;
    made.tiles_ = tiles_;
  }

 private:
  using Part = Index Operation::*;
  static constexpr Part parts[] = {&Operation::a, &Operation::b, &Operation::c};
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  template <class F>
  void for_each_part(Index i, F&& f) const {
    if (const LongSums::Sum* const sum = long_.at(i)) {
      f(sum->head);
      for (const Index term : sum->terms) f(term);
      return;
    }
    for_each_operand(steps_[at(i)], f);
  }

  void group() {
    std::vector<int> depth(steps_.size(), 0);
    constexpr int of_sums = -1;
    std::map<std::pair<int, int>, std::size_t> known;
    const auto key = [&](std::size_t i) {
      return std::pair(depth[i], long_.at(static_cast<Index>(i)) ? of_sums : static_cast<int>(steps_[i].code));
    };
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (long_.absorbs(static_cast<Index>(i))) continue;
      for_each_part(static_cast<Index>(i), [&](Index part) { depth[i] = std::max(depth[i], depth[at(part)] + 1); });
      ++known[key(i)];
    }
    std::size_t count = 0;
    for (auto& [_, number] : known) number = count++;
    groups_.resize(count);
    group_of_.resize(steps_.size());
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (long_.absorbs(static_cast<Index>(i))) continue;
      group_of_[i] = known[key(i)];
      groups_[group_of_[i]].push_back(static_cast<Index>(i));
    }
  }

  std::size_t size_of(std::size_t g) const { return groups_[g].size(); }
  Code code_of(std::size_t g) const { return steps_[at(groups_[g][0])].code; }
  bool is_sums(std::size_t g) const { return long_.at(groups_[g][0]) != nullptr; }

  /// Sets last_[g], the batch that reads batch g last, and ending_[g], the batches whose last reader is g.
  void find_last_readers() {
    last_.resize(groups_.size());
    std::iota(last_.begin(), last_.end(), 0);
    for (std::size_t i = 0; i < steps_.size(); ++i)
      if (!long_.absorbs(static_cast<Index>(i)))
        for_each_part(static_cast<Index>(i), [&](Index part) {
          std::size_t& reader = last_[group_of_[at(part)]];
          reader = std::max(reader, group_of_[i]);
        });
    for (const Index end : ends_) last_[group_of_[at(end)]] = never;
    ending_.resize(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (last_[g] != never) ending_[last_[g]].push_back(g);
  }

  bool reads(std::size_t g, Part part) const { return steps_[at(groups_[g][0])].*part != none; }
  /// Returns a number for the operand of a step; the numbers of consecutive values differ by one.
  std::size_t source(Index i, Part part) const {
    const Index from = steps_[at(i)].*part;
    if (steps_[at(i)].code == Code::variable) return at(from);
    return (group_of_[at(from)] << 32) + at_[at(from)];
  }
  bool in_order(std::span<const Index> some, Part part) const {
    for (std::size_t k = 1; k < some.size(); ++k)
      if (source(some[k], part) != source(some[k - 1], part) + 1) return false;
    return true;
  }

  std::size_t scattered(const std::vector<Index>& group) const {
    std::size_t count = 0;
    for (const Part part : {&Operation::a, &Operation::b, &Operation::c})
      for (std::size_t k = 1; k < group.size() && steps_[at(group[0])].*part != none; ++k)
        if (source(group[k], part) != source(group[k - 1], part) + 1) ++count;
    return count;
  }

  /// Sorts the steps of a batch so that most operands are consecutive: as written, or by the place of one operand. Sums
  /// go by decreasing length, so that those side by side have about as many terms; then by the place of the last term,
  /// so that the terms of those side by side are consecutive.
  void order(std::vector<Index>& group) const {
    if (long_.at(group[0])) {
      std::ranges::stable_sort(group, {}, [&](Index i) {
        const std::vector<Index>& terms = long_.at(i)->terms;
        const Index last = terms.back();
        return std::tuple(-static_cast<std::ptrdiff_t>(terms.size()), group_of_[at(last)], at_[at(last)]);
      });
      return;
    }
    std::vector<Index> best = group;
    std::size_t fewest = scattered(group);
    for (const Part part : {&Operation::a, &Operation::b}) {
      if (fewest == 0 || steps_[at(group[0])].*part == none) break;
      std::vector<Index> sorted = group;
      std::ranges::stable_sort(sorted, {}, [&](Index i) { return source(i, part); });
      if (const std::size_t count = scattered(sorted); count < fewest) {
        fewest = count;
        best = std::move(sorted);
      }
    }
    group = std::move(best);
  }

  /// Moves `end` behind the last batch that can run together with those from `first` on, and returns the number of
  /// values of the parts into which these batches are then divided.
  std::size_t extend(std::size_t first, std::size_t& end) const {
    std::size_t count = size_of(first);
    const auto begins = [&](Code code) {
      return code == Code::constant || code == Code::time || code == Code::variable;
    };
    if (begins(code_of(first))) return count;
    while (end < groups_.size() && !is_sums(end) && !begins(code_of(end))) {
      const std::size_t part = std::gcd(count, size_of(end));
      if (part < few_values && (part != count || part != size_of(end))) break;
      std::size_t g = part == count ? end : first;
      while (g <= end && is_aligned(g, first, end, part)) ++g;
      if (g <= end) break;
      count = part;
      ++end;
    }
    return count;
  }
  /// Whether every part of `count` values of batch g reads whole parts, in order, of those batches from `first` to
  /// `last` that it reads at all.
  bool is_aligned(std::size_t g, std::size_t first, std::size_t last, std::size_t count) const {
    for (const Part part : parts) {
      if (!reads(g, part)) continue;
      for (std::size_t begin = 0; begin < size_of(g); begin += count) {
        const std::span some(groups_[g].data() + begin, count);
        const auto from = [&](Index i) { return steps_[at(i)].*part; };
        const bool inside = std::ranges::any_of(some, [&](Index i) {
          const std::size_t other = group_of_[at(from(i))];
          return other >= first && other <= last;
        });
        if (inside && !(at_[at(from(some[0]))] % count == 0 && in_order(some, part))) return false;
      }
    }
    return true;
  }

  /// Whether a batch has readers from batch `end` on, behind those that it runs together with, or is an output.
  bool is_kept(std::size_t g, std::size_t end) const { return last_[g] == never || last_[g] >= end; }

  void write_together(Batches& made, std::size_t first, std::size_t end, std::size_t count) {
    Stage stage{false, static_cast<std::uint32_t>(made.batches_.size()), 0, static_cast<std::uint32_t>(count)};
    std::vector<std::uint32_t> free_tiles;
    std::uint32_t tiles = 0;
    for (std::size_t g = first; g < end; ++g) {
      const auto parts_of_it = static_cast<std::uint32_t>(size_of(g) / count);
      const bool kept = is_kept(g, end);
      if (kept) place_[g] = take(static_cast<Place>(size_of(g)));
      tiles_of_[g].clear();
      for (std::uint32_t k = 0; k < parts_of_it; ++k) {
        const std::span some(groups_[g].data() + k * count, count);
        Batch batch{.code = code_of(g)};
        batch.value = static_cast<std::uint32_t>(made.values_.size());
        if (has_number(batch.code))
          for (const Index i : some) made.values_.push_back(steps_[at(i)].value);
        Operand* const operands[] = {&batch.a, &batch.b, &batch.c};
        for (std::size_t p = 0; p < std::size(parts); ++p)
          if (reads(g, parts[p])) *operands[p] = operand(made, some, parts[p], first, end);
        if (kept) {
          batch.out = {Operand::Kind::in_order, place_[g] + static_cast<Place>(k * count)};
        } else {
          if (free_tiles.empty()) free_tiles.push_back(tiles++);
          batch.out = {Operand::Kind::in_tile, free_tiles.back()};
          tiles_of_[g].push_back(free_tiles.back());
          free_tiles.pop_back();
        }
        made.batches_.push_back(batch);
        ++stage.number;
      }
      for (const std::size_t ended : ending_[g])
        if (ended >= first && ended < g)
          free_tiles.insert(free_tiles.end(), tiles_of_[ended].begin(), tiles_of_[ended].end());
    }
    tiles_ = std::max<std::size_t>(tiles_, tiles);
    made.stages_.push_back(stage);
  }

  Operand operand(Batches& made, std::span<const Index> some, Part part, std::size_t first, std::size_t end) const {
    const bool of_scene = steps_[at(some[0])].code == Code::variable;
    const Index from = steps_[at(some[0])].*part;
    if (of_scene && in_order(some, part)) return {Operand::Kind::in_order, static_cast<Place>(from)};
    if (!of_scene) {
      const std::size_t g = group_of_[at(from)];
      if (g >= first && g < end && !is_kept(g, end))
        return {Operand::Kind::in_tile, tiles_of_[g][at_[at(from)] / some.size()]};
      if (in_order(some, part)) return {Operand::Kind::in_order, place_of(from)};
    }
    if (!of_scene)
      if (const auto runs = in_runs(made, some, part)) return *runs;
    const Operand where{Operand::Kind::scattered, static_cast<std::uint32_t>(made.places_.size())};
    for (const Index i : some)
      made.places_.push_back(of_scene ? static_cast<Place>(steps_[at(i)].*part) : place_of(steps_[at(i)].*part));
    return where;
  }

  /// Returns the operand as runs, of which each tile begins a new one; nothing where the runs would be short.
  std::optional<Operand> in_runs(Batches& made, std::span<const Index> some, Part part) const {
    std::vector<Run> runs;
    std::vector<Place> first_of_tile;
    for (std::size_t k = 0; k < some.size(); ++k) {
      const Place place = place_of(steps_[at(some[k])].*part);
      if (k % tile == 0) {
        first_of_tile.push_back(static_cast<Place>(made.runs_.size() + runs.size()));
      } else {
        Run& run = runs.back();
        if (run.length == 1) run.moves = place != run.from;
        if (place == run.from + (run.moves ? run.length : 0)) {
          ++run.length;
          continue;
        }
      }
      runs.push_back({place, 1, false});
    }
    if (runs.size() * few_in_run > some.size()) return std::nullopt;
    const Operand where{Operand::Kind::in_runs, static_cast<std::uint32_t>(made.places_.size())};
    made.places_.insert(made.places_.end(), first_of_tile.begin(), first_of_tile.end());
    made.runs_.insert(made.runs_.end(), runs.begin(), runs.end());
    return where;
  }

  void write_sums(Batches& made, std::size_t g) {
    const auto& group = groups_[g];
    const auto blocks = static_cast<Place>((group.size() + abreast - 1) / abreast);
    place_[g] = take(blocks * static_cast<Place>(abreast));
    made.stages_.push_back({true, static_cast<std::uint32_t>(made.sums_.size()), blocks, 0});
    for (std::size_t begin = 0; begin < group.size(); begin += abreast) {
      const auto sum = [&](std::size_t o) { return begin + o < group.size() ? long_.at(group[begin + o]) : nullptr; };
      Sums block{.out = place_[g] + static_cast<Place>(begin),
                 .first_span = static_cast<std::uint32_t>(made.spans_.size()),
                 .at = static_cast<std::uint32_t>(made.places_.size()),
                 .sign = static_cast<std::uint32_t>(made.signs_.size())};
      for (std::size_t o = 0; o < abreast; ++o) made.places_.push_back(sum(o) ? place_of(sum(o)->head) : zero);
      for (std::size_t k = 0; k < sum(0)->terms.size(); ++k) {
        std::array<Place, abreast> terms;  // NOLINT: written before it is read
        for (std::size_t o = 0; o < abreast; ++o) {
          const bool there = sum(o) && k < sum(o)->terms.size();
          terms[o] = there ? place_of(sum(o)->terms[k]) : zero;
          made.signs_.push_back(there ? sum(o)->signs[k] : -1);
        }
        const bool in_order =
            std::ranges::adjacent_find(terms, [](Place one, Place next) { return next != one + 1; }) == terms.end();
        if (k == 0 || made.spans_.back().in_order != in_order) made.spans_.push_back({0, in_order});
        ++made.spans_.back().terms;
        made.places_.insert(made.places_.end(), terms.begin(), in_order ? terms.begin() + 1 : terms.end());
      }
      block.spans = static_cast<std::uint32_t>(made.spans_.size()) - block.first_span;
      made.sums_.push_back(block);
    }
  }

  Place place_of(Index i) const { return place_[group_of_[at(i)]] + static_cast<Place>(at_[at(i)]); }

  /// The first free range that is long enough.
  Place take(Place count) {
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      if (range->second < count) continue;
      const auto [from, length] = *range;
      free_.erase(range);
      if (length > count) free_[from + count] = length - count;
      return from;
    }
    const Place from = static_cast<Place>(room_);
    room_ += count;
    return from;
  }
  void release(Place from, std::size_t size) {
    auto count = static_cast<Place>(size);
    auto next = free_.lower_bound(from);
    if (next != free_.end() && next->first == from + count) {
      count += next->second;
      next = free_.erase(next);
    }
    if (next != free_.begin()) {
      const auto before = std::prev(next);
      if (before->first + before->second == from) {
        before->second += count;
        return;
      }
    }
    free_[from] = count;
  }

  static constexpr std::size_t never = static_cast<std::size_t>(-1);
  std::span<const Operation> steps_;
  std::span<const Index> ends_;
  LongSums long_;
  std::vector<std::vector<Index>> groups_;  ///< steps, in the order of evaluation
  std::vector<std::size_t> group_of_, at_;  ///< by step: its group, and its place in the group
  std::vector<std::size_t> last_;           ///< by group: its last reader
  std::vector<std::vector<std::size_t>> ending_;
  std::vector<Place> place_;                          ///< by group: its first place, if it is kept
  std::vector<std::vector<std::uint32_t>> tiles_of_;  ///< by group that is not kept: the tile of each of its parts
  std::map<Place, Place> free_;                       ///< free ranges of places: first place, length
  std::size_t room_ = 0, tiles_ = 0;
};

std::shared_ptr<const Batches> Batches::of(std::span<const Operation> steps, std::span<const Index> ends) {
  const auto variables = std::ranges::count(steps, Code::variable, &Operation::code);
  if (steps.size() < few_steps || variables <= few_variables) return nullptr;
  Scheduler scheduler(steps, ends);
  if (!scheduler.worthwhile()) return nullptr;
  const auto made = std::make_shared<Batches>();
  scheduler.schedule(*made);
  return made;
}

}  // namespace least::tape

// How TermSums turns terms into columns, segments and steps.
#include <algorithm>
#include <numeric>

#include "core/tape/derivative.hpp"
#include "core/tape/long_sums.hpp"
#include "core/tape/prepared_terms.hpp"
#include "core/tape/term_sums.hpp"
#include "core/tape/terms.hpp"

namespace least::tape {

/// Order is an order of the terms, and counts the segments that it makes.
class TermSums::Order {
 public:
  /// `columns`: by operand and by result, the places of all terms.
  Order(std::vector<std::span<const std::uint32_t>> columns, std::size_t count)
      : columns_(std::move(columns)), terms_(count) {
    std::iota(terms_.begin(), terms_.end(), 0);
  }

  /// Sorts terms by the distance between the first two places that they read; terms of equal distance keep their order.
  void sort_by_distance() {
    if (columns_.size() < 2) return;
    const auto distance = [&](std::uint32_t term) {
      return static_cast<std::int64_t>(columns_[1][term]) - static_cast<std::int64_t>(columns_[0][term]);
    };
    std::int64_t least = distance(0), most = least;
    for (std::uint32_t t = 1; t < terms_.size(); ++t) {
      least = std::min(least, distance(t));
      most = std::max(most, distance(t));
    }
    std::vector<std::uint32_t> next(static_cast<std::size_t>(most - least) + 2, 0);  // first term by distance
    for (std::uint32_t t = 0; t < terms_.size(); ++t) ++next[static_cast<std::size_t>(distance(t) - least) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (std::uint32_t t = 0; t < terms_.size(); ++t) terms_[next[static_cast<std::size_t>(distance(t) - least)]++] = t;
  }
  /// Calls f(first, count) for each segment: at most a tile of terms, along which each column moves or stays.
  template <class F>
  void each_segment(const F& f) const {
    for (std::size_t begin = 0, end = 1; begin < terms_.size(); begin = end++) {
      while (end < terms_.size() && end - begin < tile && goes_on(begin, end)) ++end;
      f(begin, end - begin);
    }
  }
  std::size_t segments() const {
    std::size_t count = 0;
    each_segment([&](std::size_t, std::size_t) { ++count; });
    return count;
  }
  const std::vector<std::uint32_t>& terms() const { return terms_; }

 private:
  /// Whether the term at `end` continues the segment that begins at `begin`: each of its places is the next one or the
  /// same, as the second term of the segment decided.
  bool goes_on(std::size_t begin, std::size_t end) const {
    for (const auto& column : columns_) {
      const std::uint32_t from = column[terms_[begin]], next = column[terms_[begin + 1]], here = column[terms_[end]];
      const bool moves = next == from + 1 && from != dropped && next != dropped;
      if (!moves && next != from) return false;
      if (here != (moves ? column[terms_[end - 1]] + 1 : from) || (moves && here == dropped)) return false;
    }
    return true;
  }

  std::vector<std::span<const std::uint32_t>> columns_;
  std::vector<std::uint32_t> terms_;
};

TermSums::TermSums(const Tape& tape, const Terms& terms, const std::function<std::uint32_t(Index)>& registered)
    : count_(nth(terms.count)), count_of_sums_(nth(terms.sums)) {
  const PreparedTerms prepared(tape, terms);
  set_columns(tape, terms, prepared, registered);
  set_segments();
}

void TermSums::set_columns(const Tape& tape, const Terms& terms, const PreparedTerms& prepared,
                           const std::function<std::uint32_t(Index)>& registered) {
  // Only arguments that the formula reads become columns.
  Tape lean;
  Substitution renumber(prepared.formula(), lean, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    const std::vector<double>& known = prepared.numbers()[k];
    Column column;
    if (!known.empty()) {
      column.first = static_cast<std::uint32_t>(numbers_.size());
      numbers_.insert(numbers_.end(), known.begin(), known.end());
    } else {
      column.source = is_all(tape, terms, i, Op::variable) ? Source::variable : Source::formula;
      column.first = static_cast<std::uint32_t>(places_.size());
      for (std::size_t t = 0; t < count_; ++t) {
        const Index given = terms.given[k * count_ + t];
        places_.push_back(column.source == Source::variable ? static_cast<std::uint32_t>(tape[given].value)
                                                            : registered(given));
      }
    }
    columns_.push_back(column);
    return Symbol::variable(lean, columns_.size() - 1);
  });
  std::vector<Index> results;
  for (std::size_t r = 0; r < prepared.results().size(); ++r) {
    results.push_back(renumber.at(prepared.results()[r].place).on(lean));
    results_.push_back({static_cast<std::uint32_t>(places_.size()), 0, prepared.results()[r].negated});
    for (std::size_t t = 0; t < count_; ++t) {
      const Index into = terms.into[r * count_ + t];
      places_.push_back(into == none ? dropped : static_cast<std::uint32_t>(into));
    }
  }
  formula_ = Formula(lean, results);
  set_steps(lean, results);
}

/// Tiles are allocated like registers: a tile is free after its last reader.
void TermSums::set_steps(const Tape& tape, std::span<const Index> results) {
  const Translation from = translated(tape, results);
  const std::vector<FusedStep> all = fused(from);
  const std::size_t size = all.size();
  std::vector<std::size_t> last(size, size);  // no reader
  for (std::size_t i = 0; i < size; ++i)
    if (!all[i].absorbed) for_each_operand(all[i].operation, [&](Index part) { last[nth(part)] = i; });
  for (const Index end : from.ends) last[nth(end)] = size;
  std::vector<std::uint16_t> given(size), free;
  operands_ = columns_.size();
  const auto is_read = [&](std::uint16_t operand) {
    return operand < columns_.size() && columns_[operand].source != Source::number;
  };
  for (std::size_t i = 0; i < size; ++i) {
    const Operation& step = all[i].operation;
    if (all[i].absorbed) continue;
    if (step.code == Code::variable) {
      given[i] = static_cast<std::uint16_t>(step.a);
      last[i] = size;
      continue;
    }
    const auto place = [&](Index part) { return part == none ? std::uint16_t(0) : given[nth(part)]; };
    if (free.empty()) free.push_back(static_cast<std::uint16_t>(operands_++));
    given[i] = free.back();
    free.pop_back();
    Step made{step.code, all[i].fused, false, given[i], place(step.a), place(step.b), place(step.c), step.value};
    made.difference = made.fused == Fused::nothing && made.code == Code::subtract && is_read(made.a) && is_read(made.b);
    if (!made.difference)
      for_each_operand(step, [&](Index part) {
        if (is_read(given[nth(part)])) columns_[given[nth(part)]].gathered = true;
      });
    steps_.push_back(made);
    for_each_operand(step, [&](Index part) {
      if (last[nth(part)] != i) return;
      free.push_back(given[nth(part)]);
      last[nth(part)] = size;
    });
  }
  for (std::size_t r = 0; r < results_.size(); ++r) {
    results_[r].operand = given[nth(from.ends[r])];
    if (is_read(results_[r].operand)) columns_[results_[r].operand].gathered = true;
  }
}

void TermSums::set_segments() {
  std::vector<std::span<const std::uint32_t>> all;
  for (const Column& column : columns_)
    if (column.source != Source::number) all.emplace_back(places_.data() + column.first, count_);
  const std::size_t read = all.size();
  for (const Result& result : results_) all.emplace_back(places_.data() + result.first, count_);
  if (read == 0) all.insert(all.begin(), all.front());
  Order as_given(all, count_), by_distance = as_given;
  by_distance.sort_by_distance();
  const Order& order = by_distance.segments() <= as_given.segments() ? by_distance : as_given;
  in_segments_ = order.segments() * few_in_segment <= count_;
  if (!in_segments_) {
    tiles_.resize((count_ + tile - 1) / tile);
    for (Step& step : steps_) step.difference = false;
    for (Column& column : columns_) column.gathered = column.source != Source::number;
    return;
  }
  std::size_t in_tile = tile;
  order.each_segment([&](std::size_t begin, std::size_t length) {
    if (in_tile + length > tile) {
      tiles_.push_back({static_cast<std::uint32_t>(lengths_.size()), 0});
      in_tile = 0;
    }
    in_tile += length;
    ++tiles_.back().segments;
    lengths_.push_back(static_cast<std::uint16_t>(length));
    const auto reach = [&](std::uint32_t first) {
      const std::uint32_t from = places_[first + order.terms()[begin]];
      return Reach{from, length > 1 && places_[first + order.terms()[begin + 1]] == from + 1};
    };
    for (const Column& column : columns_)
      reach_.push_back(column.source == Source::number ? Reach{} : reach(column.first));
    for (const Result& result : results_) reach_.push_back(reach(result.first));
  });
  // Numbers and places are now put in this order.
  const auto reorder = [&](auto& list, std::uint32_t first) {
    std::vector moved(list.begin() + first, list.begin() + first + static_cast<std::ptrdiff_t>(count_));
    for (std::size_t t = 0; t < count_; ++t) list[first + t] = moved[order.terms()[t]];
  };
  for (const Column& column : columns_)
    column.source == Source::number ? reorder(numbers_, column.first) : reorder(places_, column.first);
  for (const Result& result : results_) reorder(places_, result.first);
}

}  // namespace least::tape

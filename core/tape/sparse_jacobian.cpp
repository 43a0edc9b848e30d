#include "core/tape/sparse_jacobian.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <utility>

#include "core/tape/derivative.hpp"
#include "core/tape/tape.hpp"

namespace least::tape {
namespace {

/// Sets of small numbers, one row of bits each.
class BitRows {
 public:
  BitRows(std::size_t rows, std::size_t width) : words_((width + 63) / 64), bits_(rows * words_) {}

  void insert(std::size_t row, std::size_t i) { bits_[row * words_ + i / 64] |= std::uint64_t(1) << (i % 64); }
  void unite(std::size_t row, const BitRows& from, std::size_t other) {
    for (std::size_t w = 0; w < words_; ++w) bits_[row * words_ + w] |= from.bits_[other * words_ + w];
  }
  std::vector<std::uint32_t> members(std::size_t row) const {
    std::vector<std::uint32_t> all;
    for (std::size_t w = 0; w < words_; ++w)
      for (std::uint64_t left = bits_[row * words_ + w]; left != 0; left &= left - 1)
        all.push_back(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(left)));
    return all;
  }

 private:
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// Returns, by sum of the terms, the variables that it reads.
BitRows reads_of_sums(const Terms& terms, const BitRows& reads, std::size_t variables) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  BitRows sums(at(terms.sums), variables);
  const std::size_t count = at(terms.count);
  for (std::size_t t = 0; t < count; ++t) {
    BitRows term(1, variables);
    for (std::size_t k = 0; k < at(terms.arguments); ++k) term.unite(0, reads, at(terms.given[k * count + t]));
    for (std::size_t r = 0; r < terms.results.size(); ++r)
      if (const Index sum = terms.into[r * count + t]; sum != none) sums.unite(at(sum), term, 0);
  }
  return sums;
}

}  // namespace

SparseJacobian::SparseJacobian(const Tape& tape, std::span<const Index> outputs, std::size_t variables, Kind kind)
    : variables_(variables) {
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  Index last = none;
  for (const Index output : outputs) last = std::max(last, output);
  BitRows reads(at(last + 1), variables);
  std::map<Index, BitRows> sums;  // by number of terms
  for (Index i = 0; i <= last; ++i) {
    const Node& node = tape[i];
    if (node.op == Op::total) {
      const auto number = static_cast<Index>(node.low);
      auto known = sums.find(number);
      if (known == sums.end()) known = sums.emplace(number, reads_of_sums(tape.terms(number), reads, variables)).first;
      reads.unite(at(i), known->second, static_cast<std::size_t>(node.value));
      continue;
    }
    if (node.op == Op::variable && node.value < static_cast<double>(variables))
      reads.insert(at(i), static_cast<std::size_t>(node.value));
    for (const Index part : {node.a, node.b, node.c})
      if (part != none) reads.unite(at(i), reads, at(part));
  }
  BitRows rows(outputs.size(), variables);
  SparsityPattern readers(variables);
  pattern_.reserve(outputs.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    rows.unite(i, reads, at(outputs[i]));
    pattern_.push_back(rows.members(i));
    for (const std::uint32_t j : pattern_[i]) readers[j].push_back(static_cast<std::uint32_t>(i));
  }
  // Greedy colouring: every variable goes into the first direction none of whose variables it shares a row with.
  constexpr auto unplaced = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> direction(variables, unplaced), taken;
  for (std::uint32_t j = 0; j < variables; ++j) {
    if (readers[j].empty()) continue;
    BitRows beside(1, variables);
    for (const std::uint32_t row : readers[j]) beside.unite(0, rows, row);
    taken.assign(columns_.size() + 1, 0);
    for (const std::uint32_t other : beside.members(0))
      if (direction[other] != unplaced) taken[direction[other]] = 1;
    const auto free = static_cast<std::uint32_t>(std::ranges::find(taken, 0U) - taken.begin());
    if (free == columns_.size()) columns_.emplace_back();
    direction[j] = free;
    columns_[free].variables.push_back(j);
    for (const std::uint32_t row : readers[j]) columns_[free].entries.emplace_back(row, j);
  }
  constexpr Index short_tape = 1 << 10;
  if (variables > few || outputs.size() > few || tape.has_terms() || tape.size() > short_tape) return;
  try {
    write_out(tape, outputs, kind);
  } catch (const TooManyOperations&) {
    written_.clear();
  }
}

/// Writes the entries as formulas, unless these cost more than about four dual directions do: derivatives of
/// derivatives may be long.
void SparseJacobian::write_out(Tape tape, std::span<const Index> outputs, Kind kind) {
  constexpr std::size_t cost_of_directions = 3;
  std::vector<int> variables(variables_);
  std::iota(variables.begin(), variables.end(), 0);
  std::vector<Written> written;
  std::vector<Index> all;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> places;
  tape.bound(tape.size() + static_cast<Index>(few * few) * (tape.size() + 64));
  for (std::uint32_t row = 0; row < outputs.size(); ++row) {
    if (pattern_[row].empty()) continue;
    const auto slopes = gradient(tape, Symbol::at(tape, outputs[row]), variables);
    for (const std::uint32_t column : pattern_[row]) {
      const auto mirrored = kind == Kind::hessian ? places.find({column, row}) : places.end();
      const auto place = mirrored != places.end() ? mirrored->second : static_cast<std::uint32_t>(all.size());
      if (place == all.size()) all.push_back(slopes[column].on(tape));
      places[{row, column}] = place;
      written.push_back({row, column, place});
    }
  }
  if (written.empty()) return;
  const Formula entries(tape, all);
  all.insert(all.end(), outputs.begin(), outputs.end());
  const Formula with_outputs(tape, all);
  if (with_outputs.operations() > cost_of_directions * Formula(tape, outputs).operations()) return;
  written_ = std::move(written);
  entries_ = entries;
  with_outputs_ = with_outputs;
}

std::size_t SparseJacobian::bytes() const {
  std::size_t entries = 0;
  for (const Columns& columns : columns_) entries += columns.entries.size();
  constexpr std::size_t of_operation = 32;
  return entries * (sizeof(std::uint32_t) + sizeof(columns_.front().entries.front())) +
         written_.size() * sizeof(Written) + (entries_.operations() + with_outputs_.operations()) * of_operation;
}

void SparseJacobian::differentiate(const Formula& formula, const Directions* x, double t, Directions* out) {
  formula.evaluate(x, Directions(t), out);
}

}  // namespace least::tape

#include "core/text/symbol_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/number/linear.hpp"

namespace least::text {
namespace {

using Entry = SymbolMatrix::Entry;
using Row = SymbolMatrix::Row;

/// Limits of multiplications in an elimination of numbers, and of symbols: some hundredths of a second each.
constexpr std::size_t most_multiplications = std::size_t(1) << 26, most_of_symbols = std::size_t(1) << 20;

/// Count throws tape::TooManyOperations once more operations are taken than it began with.
class Count {
 public:
  explicit Count(std::size_t most) : left_(most) {}
  void take(std::size_t operations) {
    if (operations > left_) throw tape::TooManyOperations();
    left_ -= operations;
  }

 private:
  std::size_t left_;
};

const Symbol* find(const Row& row, std::size_t column) {
  const auto found = std::ranges::lower_bound(row, column, {}, &Entry::column);
  return found != row.end() && found->column == column ? &found->value : nullptr;
}

/// combined returns a − f b, with the entries of b from `begin` on.
Row combined(const Row& a, const Symbol& f, const Row& b, Row::const_iterator begin) {
  Row made;
  made.reserve(a.size() + static_cast<std::size_t>(b.end() - begin));
  auto x = a.begin();
  for (auto y = begin; y != b.end(); ++y) {
    while (x != a.end() && x->column < y->column) made.push_back(*x++);
    const bool both = x != a.end() && x->column == y->column;
    const Symbol value = (both ? x++->value : Symbol(0)) - f * y->value;
    if (!is_nothing(value)) made.push_back({y->column, value});
  }
  made.insert(made.end(), x, a.end());
  return made;
}

/// Elimination transforms `a` into a diagonal matrix by row operations and applies these to the unit matrix as well.
class Elimination {
 public:
  explicit Elimination(SymbolMatrix a) : a_(std::move(a)), b_(a_.size()), rows_(a_.size()) {
    held_.add_soon(sizeof(Entry) * (a_.entries() + a_.size()));
    for (std::size_t i = 0; i < a_.size(); ++i) {
      b_.row(i).push_back({i, Symbol(1)});
      for (const Entry& entry : a_.row(i)) rows_[entry.column].push_back(i);
    }
  }

  std::optional<SymbolMatrix> inverse() {
    const std::size_t n = a_.size();
    for (std::size_t k = 0; k < n; ++k)
      if (!eliminate(k)) return std::nullopt;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol pivot = a_.at(i, i);
      for (Entry& entry : b_.row(i)) entry.value = entry.value / pivot;
    }
    return std::move(b_);
  }

 private:
  bool eliminate(std::size_t k) {
    auto& rows = rows_[k];  // rows that may have an entry in column k
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    const auto has = [&](std::size_t i) { return find(a_.row(i), k) != nullptr; };
    const auto pivot = std::ranges::find_if(rows, [&](std::size_t i) { return i >= k && has(i); });
    if (pivot == rows.end()) return false;
    if (*pivot != k) exchange(k, *pivot);
    const Row& from = a_.row(k);
    const auto after = std::ranges::upper_bound(from, k, {}, &Entry::column);
    const Symbol divisor = *find(from, k);
    for (const std::size_t i : std::vector(rows)) {
      const Symbol* const entry = i == k ? nullptr : find(a_.row(i), k);
      if (!entry) continue;
      const Symbol f = *entry / divisor;
      count_.take(static_cast<std::size_t>(from.end() - after) + b_.row(k).size());
      Row& row = a_.row(i);
      std::erase_if(row, [k](const Entry& of) { return of.column == k; });
      for (auto of = after; of != from.end(); ++of) rows_[of->column].push_back(i);
      replace(row, combined(row, f, from, after));
      replace(b_.row(i), combined(b_.row(i), f, b_.row(k), b_.row(k).begin()));
    }
    return true;
  }
  void exchange(std::size_t k, std::size_t other) {
    std::swap(a_.row(k), a_.row(other));
    std::swap(b_.row(k), b_.row(other));
    for (const std::size_t i : {k, other})
      for (const Entry& entry : a_.row(i)) rows_[entry.column].push_back(i);
  }
  void replace(Row& row, Row with) {
    held_.add_soon(with.size() * sizeof(Entry));
    held_.shrink_by(row.size() * sizeof(Entry));
    row = std::move(with);
  }

  SymbolMatrix a_, b_;
  std::vector<std::vector<std::size_t>> rows_;
  Count count_{most_of_symbols};
  Held held_ = HeldByThread::take(0);
};

/// firsts_of returns, for each row, the smallest row of its block.
std::vector<std::size_t> firsts_of(const SymbolMatrix& matrix) {
  std::vector<std::size_t> first(matrix.size());
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (first[i] != i) i = first[i] = first[first[i]];
    return i;
  };
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (const Entry& entry : matrix.row(i)) {
      const std::size_t a = root(i), b = root(entry.column);
      first[std::max(a, b)] = std::min(a, b);
    }
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = root(i);
  return first;
}

/// sign_of_pivots returns the common sign of all pivots of a symmetric matrix, 0 where they differ. It computes A = L D
/// Lᵀ within the envelope: row i of L begins at the same column as row i of A.
int sign_of_pivots(const SymbolMatrix& matrix, std::span<const double> numbers) {
  const std::size_t n = matrix.size();
  Count count(most_multiplications);
  Held held = HeldByThread::take(0);
  std::vector<std::size_t> begin(n), start(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    begin[i] = matrix.row(i).empty() ? i : std::min(i, matrix.row(i).front().column);
    start[i + 1] = start[i] + i - begin[i];
  }
  held.add_soon(start[n] * sizeof(double));
  std::vector<double> lower(start[n], 0), pivots(n, 0);
  std::size_t next = 0;
  int sign = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double* const row = lower.data() + start[i];  // from column begin[i] on
    for (const Entry& entry : matrix.row(i)) {
      const double value = numbers[next++];
      if (entry.column < i) row[entry.column - begin[i]] = value;
      if (entry.column == i) pivots[i] = value;
    }
    for (std::size_t j = begin[i]; j < i; ++j) {  // the row of L D first
      const double* const other = lower.data() + start[j];
      const std::size_t from = std::max(begin[i], begin[j]);
      count.take(j - std::min(from, j));
      for (std::size_t k = from; k < j; ++k) row[j - begin[i]] -= row[k - begin[i]] * other[k - begin[j]];
    }
    for (std::size_t k = begin[i]; k < i; ++k) {
      const double l = row[k - begin[i]] / pivots[k];
      pivots[i] -= row[k - begin[i]] * l;
      row[k - begin[i]] = l;
    }
    const int here = pivots[i] > 0 ? 1 : pivots[i] < 0 ? -1 : 0;
    if (sign == 0) sign = here;
    if (here == 0 || here != sign) return 0;
  }
  return sign;
}

/// log_determinant_of returns log |det A|, by elimination with column pivoting: the determinant of hundreds of rows may
/// not be representable.
double log_determinant_of(std::size_t n, std::vector<double> a) {
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i * n + k]) > std::abs(a[pivot * n + k])) pivot = i;
    if (pivot != k) std::swap_ranges(&a[k * n], &a[k * n] + n, &a[pivot * n]);
    sum += std::log(std::abs(a[k * n + k]));
    for (std::size_t i = k + 1; i < n; ++i) {
      const double part = a[i * n + k] / a[k * n + k];
      for (std::size_t j = k + 1; j < n; ++j) a[i * n + j] -= part * a[k * n + j];
    }
  }
  return sum;
}

}  // namespace

bool is_nothing(const Symbol& x) { return x.is_constant() && x.constant() == 0; }

std::size_t SymbolMatrix::entries() const {
  return std::accumulate(rows_.begin(), rows_.end(), std::size_t{0},
                         [](std::size_t sum, const Row& row) { return sum + row.size(); });
}

Symbol SymbolMatrix::at(std::size_t i, std::size_t j) const {
  const Symbol* const found = find(rows_[i], j);
  return found ? *found : Symbol(0);
}

bool SymbolMatrix::is_diagonal() const {
  for (std::size_t i = 0; i < size(); ++i)
    for (const Entry& entry : rows_[i])
      if (entry.column != i) return false;
  return true;
}

std::vector<Symbol> SymbolMatrix::written_out() const {
  std::vector<Symbol> all(size() * size(), Symbol(0));
  for (std::size_t i = 0; i < size(); ++i)
    for (const Entry& entry : rows_[i]) all[i * size() + entry.column] = entry.value;
  return all;
}

BlockMatrix::BlockMatrix(const SymbolMatrix& matrix, std::span<const double> numbers) {
  const std::size_t n = matrix.size();
  const std::vector<std::size_t> first = firsts_of(matrix);
  std::vector<std::size_t> block(n), place(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (first[i] == i) {
      block[i] = blocks_.size();
      blocks_.emplace_back();
    }
    auto& of = blocks_[block[i] = block[first[i]]].of;
    place[i] = of.size();
    of.push_back(i);
  }
  std::size_t all = 0;
  for (const Block& one : blocks_) all += one.of.size() * one.of.size();
  if (all > most_numbers) throw tape::TooManyOperations();
  for (Block& one : blocks_) one.numbers.assign(one.of.size() * one.of.size(), 0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (const Entry& entry : matrix.row(i)) {
      Block& one = blocks_[block[i]];
      one.numbers[place[i] * one.of.size() + place[entry.column]] = numbers[next++];
    }
}

void BlockMatrix::invert() {
  for (Block& block : blocks_) detail::invert(block.of.size(), block.numbers.data());
}

BlockMatrix::Regularity BlockMatrix::regularity() const {
  // Each round halves the logarithm of the scale errors, so that scales of 1e±300 end within a factor 10
  constexpr int rounds = 8;
  Regularity all;
  for (const Block& block : blocks_) {
    const std::size_t n = block.of.size();
    std::vector<double> a = block.numbers;
    for (int round = 0; round < rounds; ++round) {
      std::vector<double> scale(n);
      for (std::size_t i = 0; i < n; ++i) {
        double most = 0;
        for (std::size_t j = 0; j < n; ++j) most = std::max(most, std::abs(a[i * n + j]));
        scale[i] = most > 0 && std::isfinite(most) ? 1 / std::sqrt(most) : 1;
        all.log_determinant -= 2 * std::log(scale[i]);
      }
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) a[i * n + j] *= scale[i] * scale[j];
    }
    const auto norm = [&] {  // maximum row sum
      double most = 0;
      for (std::size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (std::size_t j = 0; j < n; ++j) sum += std::abs(a[i * n + j]);
        if (!(sum <= most)) most = sum;
      }
      return most;
    };
    const double size = norm();
    all.log_determinant += log_determinant_of(n, a);
    detail::invert(n, a.data());
    const double reciprocal = 1 / (size * norm());
    all.reciprocal_condition = reciprocal > 0 ? std::min(all.reciprocal_condition, reciprocal) : 0;
  }
  return all;
}

bool is_positive_definite(const SymbolMatrix& matrix, std::span<const double> numbers) {
  return sign_of_pivots(matrix, numbers) > 0;
}

bool is_indefinite(const SymbolMatrix& second) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < second.size(); ++i)
    for (const Entry& entry : second.row(i)) {
      if (!entry.value.is_constant()) return false;
      numbers.push_back(entry.value.constant());
    }
  return sign_of_pivots(second, numbers) == 0;
}

std::optional<SymbolMatrix> inverse_of(SymbolMatrix a) { return Elimination(std::move(a)).inverse(); }

}  // namespace least::text

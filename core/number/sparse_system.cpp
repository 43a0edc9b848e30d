#include "core/number/sparse_system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/number/small_factors.hpp"

namespace least {
namespace {

/// Returns, for each row i, the rows j ≠ i for which entry (i, j) or (j, i) is in the pattern.
SparsityPattern neighbours_of(const SparsityPattern& pattern) {
  SparsityPattern all(pattern.size());
  for (std::uint32_t i = 0; i < pattern.size(); ++i)
    for (const std::uint32_t j : pattern[i])
      if (j != i) {
        all[i].push_back(j);  // NOLINT(performance-inefficient-vector-operation)
        all[j].push_back(i);
      }
  for (auto& some : all) {
    std::ranges::sort(some);
    some.erase(std::unique(some.begin(), some.end()), some.end());
  }
  return all;
}

/// Returns the new number of every row: breadth first from one end of the graph, neighbours of low degree first.
std::vector<std::uint32_t> renumbering(const SparsityPattern& neighbours) {
  const std::size_t n = neighbours.size();
  constexpr auto unknown_place = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> place(n), order, by_degree(n);
  std::iota(by_degree.begin(), by_degree.end(), 0);
  const auto degree = [&](std::uint32_t i) { return neighbours[i].size(); };
  std::ranges::stable_sort(by_degree, {}, degree);
  order.reserve(n);
  const auto visit = [&](std::uint32_t from) {
    place[from] = static_cast<std::uint32_t>(order.size());
    order.push_back(from);
    for (std::size_t head = place[from]; head < order.size(); ++head) {
      const std::size_t first = order.size();
      for (const std::uint32_t j : neighbours[order[head]])
        if (place[j] == unknown_place) {
          place[j] = static_cast<std::uint32_t>(order.size());
          order.push_back(j);
        }
      std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return degree(a) < degree(b); });
      for (std::size_t k = first; k < order.size(); ++k) place[order[k]] = static_cast<std::uint32_t>(k);
    }
  };
  std::ranges::fill(place, unknown_place);
  for (const std::uint32_t start : by_degree) {
    if (place[start] != unknown_place) continue;
    const std::size_t first = order.size();
    visit(start);
    const std::uint32_t end = order.back();  // the far end of the graph is the better one to begin at
    for (std::size_t k = first; k < order.size(); ++k) place[order[k]] = unknown_place;
    order.resize(first);
    visit(end);
  }
  return place;
}

std::size_t longest_row(const SparsityPattern& pattern) {
  std::size_t longest = 0;
  for (const auto& row : pattern) longest = std::max(longest, row.size());
  return longest;
}

std::size_t bandwidth_of(const SparsityPattern& pattern, const std::vector<std::uint32_t>& place) {
  std::size_t band = 0;
  for (std::size_t i = 0; i < pattern.size(); ++i)
    for (const std::uint32_t j : pattern[i])
      band = std::max<std::size_t>(band, place[i] > place[j] ? place[i] - place[j] : place[j] - place[i]);
  return band;
}

}  // namespace

SparseSystem::SparseSystem(const SparsityPattern& pattern) : place_(pattern.size()) {
  const std::size_t n = size();
  // A row with so many entries makes the band wide in every order, so the matrix is treated as full: renumbering full
  // rows would take long.
  if (n > 16 && 4 * longest_row(pattern) > n + 4) {
    std::iota(place_.begin(), place_.end(), 0);
    band_ = n - 1;
  } else {
    place_ = renumbering(neighbours_of(pattern));
    band_ = bandwidth_of(pattern, place_);
  }
  constexpr std::size_t smallest = 4, most_small = 16;
  small_ = n <= smallest || (n <= most_small && 2 * band_ >= n);
  // Elimination in a narrow band costs no more than blocked elimination of the whole matrix.
  if (small_) {
    entries_.resize(n * n);
    pivots_.resize(n);
  } else if (n <= most_small || 8 * band_ < n) {
    entries_.resize(n * width());
    pivots_.resize(n);
  } else {
    dense_ = std::make_unique<DenseFactors>(n);
  }
  renumbered_.resize(n);
}

void SparseSystem::clear() {
  std::ranges::fill(entries_, 0.0);
  if (dense_) std::fill_n(dense_->entries(), size() * size(), 0.0);
}

bool SparseSystem::factor() {
  if (dense_) return dense_->factor();
  const std::size_t n = size();
  if (small_) {
    with_size(n, [&](auto count) { factor_small(count, entries_.data(), pivots_.data()); });
    return true;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t below = std::min(n, k + band_ + 1), right = std::min(n, k + 2 * band_ + 1);
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < below; ++i)
      if (std::abs(row(i)[k]) > std::abs(row(pivot)[k])) pivot = i;
    pivots_[k] = static_cast<std::uint32_t>(pivot);
    double* const of = row(k);
    if (pivot != k) std::swap_ranges(of + k, of + right, row(pivot) + k);
    for (std::size_t i = k + 1; i < below; ++i) {
      double* const r = row(i);
      if (r[k] == 0) continue;
      const double part = r[k] /= of[k];
      for (std::size_t j = k + 1; j < right; ++j) r[j] -= part * of[j];
    }
  }
  return true;
}

void SparseSystem::solve(double* b) {
  if (dense_) return dense_->solve(b);
  const std::size_t n = size();
  if (small_) return with_size(n, [&](auto count) { solve_small(count, entries_.data(), pivots_.data(), b); });
  double* const x = renumbered_.data();
  for (std::size_t i = 0; i < n; ++i) x[place_[i]] = b[i];
  for (std::size_t k = 0; k < n; ++k) {
    std::swap(x[k], x[pivots_[k]]);
    for (std::size_t i = k + 1; i < std::min(n, k + band_ + 1); ++i) x[i] -= row(i)[k] * x[k];
  }
  for (std::size_t k = n; k-- > 0;) {
    const double* const of = row(k);
    for (std::size_t j = k + 1; j < std::min(n, k + 2 * band_ + 1); ++j) x[k] -= of[j] * x[j];
    x[k] /= of[k];
  }
  for (std::size_t i = 0; i < n; ++i) b[i] = x[place_[i]];
}

}  // namespace least

// The rows of an answer until they are sent: as numbers, the only form in which all of them are in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

/// KeptRows stores rows in blocks, so that growing moves nothing and freed memory can return to the system. `budget`
/// may be null: unlimited.
class KeptRows final : public RowSink {
 public:
  explicit KeptRows(std::size_t columns, MemoryBudget* budget = nullptr)
      : columns_(std::max<std::size_t>(columns, 1)), held_(budget) {}

  /// append returns false where the budget has no memory left.
  bool append(std::span<const double> rows) override {
    while (!rows.empty()) {
      if (blocks_.empty() || blocks_.back().size() == block_size()) {
        // The first block grows with its content, as most runs are short
        if (!grow(blocks_.empty() ? 0 : block_size())) return false;
      }
      std::vector<double>& block = blocks_.back();
      const std::size_t n = std::min(rows.size(), block_size() - block.size());
      if (blocks_.size() == 1 && !grow_first(block.size() + n)) return false;
      block.insert(block.end(), rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(n));
      rows = rows.subspan(n);
    }
    return true;
  }

  std::size_t columns() const { return columns_; }
  std::size_t rows() const {
    std::size_t numbers = 0;
    for (const auto& block : blocks_) numbers += block.size();
    return numbers / columns_;
  }
  /// slices() returns the number of slices: consecutive parts of some thousand numbers, whole rows each.
  std::size_t slices() const {
    if (blocks_.empty()) return 0;
    return (blocks_.size() - 1) * slices_of(block_size()) + slices_of(blocks_.back().size());
  }
  std::span<const double> slice(std::size_t i) const {
    const std::size_t each = slices_of(block_size()), from = i % each * slice_size();
    const std::span<const double> block = blocks_[i / each];
    return block.subspan(from, std::min(slice_size(), block.size() - from));
  }
  /// rows_before returns the number of rows before a slice.
  std::size_t rows_before(std::size_t i) const {
    const std::size_t each = slices_of(block_size());
    return (i / each * block_size() + i % each * slice_size()) / columns_;
  }
  /// The bytes of all rows, and about those that the next block of rows takes.
  std::size_t bytes() const { return held_.bytes(); }
  static constexpr std::size_t bytes_of_block = std::size_t{1} << 20;  ///< beyond malloc's threshold, so that the
                                                                       ///< memory is unmapped when it is freed
  /// overflowed() tells whether rows were rejected.
  bool overflowed() const { return overflowed_; }

 private:
  std::size_t block_size() const {
    constexpr std::size_t numbers = bytes_of_block / sizeof(double);
    return std::max<std::size_t>(numbers / columns_, 1) * columns_;
  }
  std::size_t slice_size() const { return std::max<std::size_t>(16 * 1024 / columns_, 1) * columns_; }
  std::size_t slices_of(std::size_t numbers) const { return (numbers + slice_size() - 1) / slice_size(); }
  bool take(std::size_t numbers) {
    if (held_.grow_by(numbers * sizeof(double))) return true;
    overflowed_ = true;
    return false;
  }
  bool grow(std::size_t numbers) {
    if (!take(numbers)) return false;
    blocks_.emplace_back().reserve(numbers);
    return true;
  }
  bool grow_first(std::size_t size) {
    std::vector<double>& block = blocks_.front();
    if (size <= block.capacity()) return true;
    const std::size_t capacity = std::min(std::max(size, 2 * block.capacity()), block_size());
    if (!take(capacity - block.capacity())) return false;
    block.reserve(capacity);
    return true;
  }

  const std::size_t columns_;
  Held held_;
  std::vector<std::vector<double>> blocks_;
  bool overflowed_ = false;
};

/// KeptRun stores the samples of a run, and the points of its section.
struct KeptRun final : RowSink {
  KeptRows samples, points;

  KeptRun(const Request& request, MemoryBudget* budget = nullptr)
      : samples(request.columns.size(), budget), points(request.section_columns().size(), budget) {}

  bool append(std::span<const double> rows) override { return samples.append(rows); }
  bool append_section(std::span<const double> rows) override { return points.append(rows); }
  bool overflowed() const { return samples.overflowed() || points.overflowed(); }
  std::size_t bytes() const { return samples.bytes() + points.bytes(); }
};

}  // namespace least::server

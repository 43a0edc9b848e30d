#include "core/text/velocities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/number/linear.hpp"
#include "core/tape/tape.hpp"

namespace least::text {
namespace {

/// fill replaces the entry numbers of a block by the values of these entries of ∂²L/∂v².
void fill(const BlockMatrix::Block& block, const double* entries, double* matrix) {
  for (std::size_t k = 0; k < block.numbers.size(); ++k) {
    const auto which = static_cast<std::size_t>(block.numbers[k]);
    matrix[k] = which == 0 ? 0 : entries[which - 1];
  }
}

}  // namespace

std::vector<BlockMatrix::Block> Velocities::blocks_of(const SymbolMatrix& matrix) {
  std::vector<double> numbers(matrix.entries());
  std::iota(numbers.begin(), numbers.end(), 1.0);
  return BlockMatrix(matrix, numbers).blocks();
}

bool Velocities::fits(const SymbolMatrix& hessian) try {
  return std::ranges::all_of(blocks_of(hessian), [](const auto& block) { return block.of.size() <= most_coupled; });
} catch (const tape::TooManyOperations&) {
  return false;
}

Velocities::Velocities(const SymbolMatrix& hessian, tape::Formula momenta, tape::Formula with_hessian, bool linear)
    : n_(hessian.size()),
      blocks_(blocks_of(hessian)),
      momenta_(std::move(momenta)),
      with_hessian_(std::move(with_hessian)),
      linear_(linear) {}

void Velocities::solve(const double* x, double t, double* v) const {
  constexpr int most_rounds = 100, most_halvings = 30;
  const double* const p = x + n_;
  thread_local std::vector<double> at, all, other, matrix, rest, step;
  at.assign(x, x + 2 * n_ + 1);
  all.resize(with_hessian_.outputs());
  rest.resize(n_);
  step.resize(n_);
  other.resize(n_);
  std::fill_n(v, n_, 0.0);
  // look(v) evaluates momenta and ∂²L/∂v² at v, for the next step, and returns how far the momenta are from p (sum of
  // |Δp|).
  const auto look = [&](const double* velocities) {
    std::copy_n(velocities, n_, at.begin() + static_cast<std::ptrdiff_t>(n_));
    with_hessian_.evaluate(at.data(), t, all.data());
    double wrong = 0;
    for (std::size_t i = 0; i < n_; ++i) wrong += std::abs(p[i] - all[i]);
    return wrong;
  };
  const auto entry = [&](const Block& block, std::size_t k) {
    const auto which = static_cast<std::size_t>(block.numbers[k]);
    return which == 0 ? 0 : all[n_ + which - 1];
  };
  const auto singular = [&] {
    for (const Block& block : blocks_)
      for (std::size_t i = 0; i < block.of.size(); ++i)
        if (!(std::abs(entry(block, i * block.of.size() + i)) > 0)) return true;
    return false;
  };
  // The search begins at rest; where ∂²L/∂v² is singular there, at v = p, then at v = −p.
  double wrong = look(v);
  if (!linear_ && (!std::isfinite(wrong) || singular())) {
    for (const double share : {1.0, -1.0}) {
      for (std::size_t i = 0; i < n_; ++i) v[i] = share * (p[i] != 0 ? p[i] : 1);
      wrong = look(v);
      if (std::isfinite(wrong) && !singular()) break;
    }
  }
  // The remaining error is compared with the momenta and with the terms that cancel in them, here or at the beginning.
  const auto terms = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) sum += std::abs(p[i]);
    for (const Block& block : blocks_)
      for (std::size_t k = 0; k < block.numbers.size(); ++k)
        sum += std::abs(entry(block, k) * v[block.of[k % block.of.size()]]);
    return sum;
  };
  double here = terms(), size = here;
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  for (int round = 0; round < most_rounds && wrong > rounding * here; ++round) {
    for (const Block& block : blocks_) {
      const std::size_t n = block.of.size();
      matrix.resize(block.numbers.size());
      fill(block, all.data() + n_, matrix.data());
      for (std::size_t i = 0; i < n; ++i) rest[i] = p[block.of[i]] - all[block.of[i]];
      if (n == 1) {
        step[0] = rest[0] / matrix[0];
      } else {
        detail::solve_by_lu(n, matrix.data(), rest.data(), step.data());
      }
      for (std::size_t i = 0; i < n; ++i) other[block.of[i]] = step[i];
    }
    if (linear_) return void(std::ranges::copy(other, v));
    std::swap(other, step);
    double now = wrong;
    for (int halving = 0; halving < most_halvings && !(now < wrong); ++halving) {
      for (std::size_t i = 0; i < n_; ++i) other[i] = v[i] + std::exp2(-halving) * step[i];
      now = look(other.data());
    }
    if (!(now < wrong)) break;  // only rounding is left, or there is no solution
    std::ranges::copy(other, v);
    wrong = now;
    here = terms();
    size = std::max(size, here);
  }
  if (wrong != 0 && !(wrong <= 1e-12 * size)) std::fill_n(v, n_, std::numeric_limits<double>::quiet_NaN());
}

const std::vector<double>& Velocities::inverse_at(const double* x, double t, const double* v) const {
  thread_local std::vector<double> at, all, inverse;
  at.assign(x, x + 2 * n_ + 1);
  std::copy_n(v, n_, at.begin() + static_cast<std::ptrdiff_t>(n_));
  all.resize(with_hessian_.outputs());
  with_hessian_.evaluate(at.data(), t, all.data());
  inverse.clear();
  for (const Block& block : blocks_) {
    const std::size_t first = inverse.size();
    inverse.resize(first + block.numbers.size());
    fill(block, all.data() + n_, &inverse[first]);
    detail::invert(block.of.size(), &inverse[first]);
  }
  return inverse;
}

}  // namespace least::text

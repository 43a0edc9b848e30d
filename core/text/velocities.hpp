// The velocities of a Lagrangian: v with ∂L/∂v = p, by Newton's method with step halving; one step where L is quadratic
// in v. Coordinates whose velocities are not coupled are solved for in separate blocks, so that the work is
// proportional to their number where few are coupled.
#pragma once

#include <type_traits>
#include <vector>

#include "core/number/dual.hpp"
#include "core/tape/formula.hpp"
#include "core/text/symbol_matrix.hpp"

namespace least::text {

/// has_first_slopes<T> tells whether T is a double with first derivatives.
template <class T>
inline constexpr bool has_first_slopes = false;
template <int K>
inline constexpr bool has_first_slopes<Dual<double, K>> = true;

/// Velocities solves ∂L/∂v(q, v, s, t) = p for v.
class Velocities {
 public:
  /// Limit of velocities that ∂²L/∂v² may couple in one block.
  static constexpr std::size_t most_coupled = 24;

  /// fits tells whether no block of ∂²L/∂v² is larger.
  static bool fits(const SymbolMatrix& hessian);
  /// blocks_of returns the uncoupled blocks of a matrix, with the number of the stored entry, from 1 on, at each
  /// position, 0 for none. Throws tape::TooManyOperations where the blocks are too large together.
  static std::vector<BlockMatrix::Block> blocks_of(const SymbolMatrix& matrix);
  /// `momenta` is ∂L/∂v as a function of (q, v, s); `with_hessian` adds the stored entries of ∂²L/∂v², row by row.
  /// `linear`: momenta are linear in the velocities, without a constant term.
  Velocities(const SymbolMatrix& hessian, tape::Formula momenta, tape::Formula with_hessian, bool linear = false);

  std::size_t size() const { return n_; }
  /// The uncoupled blocks of ∂²L/∂v².
  const std::vector<BlockMatrix::Block>& blocks() const { return blocks_; }
  /// find(x, s, t, v) writes the n velocities at x = (q, p); NaN where there are none. They are found in double, then
  /// refined to the precision of T, derivatives included.
  template <class T, class S>
  void find(const T* x, const T& s, const S& t, T* v) const {
    thread_local std::vector<double> plain, found;
    plain.resize(2 * n_ + 1);
    found.resize(n_);
    for (std::size_t i = 0; i < 2 * n_; ++i) plain[i] = plain_number(x[i]);
    plain[2 * n_] = plain_number(s);
    solve(plain.data(), plain_number(t), found.data());
    for (std::size_t i = 0; i < n_; ++i) v[i] = T(found[i]);
    if constexpr (!std::is_same_v<T, double>) {
      constexpr int rounds = has_first_slopes<T> ? 1 : 4;  // with the inverse matrix of the first round
      thread_local std::vector<T> at, wrong;
      at.assign(x, x + 2 * n_);
      at.push_back(s);
      wrong.resize(n_);
      const std::vector<double>& inverse = inverse_at(plain.data(), plain_number(t), found.data());
      for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < n_; ++i) at[n_ + i] = v[i];
        momenta_.evaluate(at.data(), t, wrong.data());
        for (std::size_t i = 0; i < n_; ++i) wrong[i] = x[n_ + i] - wrong[i];
        const double* entry = inverse.data();
        for (const auto& block : blocks_)
          for (const std::size_t i : block.of)
            for (const std::size_t j : block.of) v[i] = v[i] + *entry++ * wrong[j];
      }
    }
  }

 private:
  using Block = BlockMatrix::Block;
  void solve(const double* x, double t, double* v) const;
  /// inverse_at returns the inverse of ∂²L/∂v² at v, block by block; the reference is to a thread-local buffer, valid
  /// until the next call.
  const std::vector<double>& inverse_at(const double* x, double t, const double* v) const;

  std::size_t n_;
  std::vector<Block> blocks_;
  tape::Formula momenta_, with_hessian_;
  bool linear_;
};

}  // namespace least::text

// The velocities of a Lagrangian: v with ∂L/∂v = p, by Newton's method with steps that are shortened until they help;
// where it is quadratic in them, by its first step. Coordinates whose velocities have nothing to do with each other are
// solved for apart, so that the work goes with their number where few are coupled.
#pragma once

#include <type_traits>
#include <vector>

#include "core/number/dual.hpp"
#include "core/tape/formula.hpp"
#include "core/text/symbol_matrix.hpp"

namespace least::text {

/// Whether it is a double with first derivatives.
template <class T>
inline constexpr bool has_first_slopes = false;
template <int K>
inline constexpr bool has_first_slopes<Dual<double, K>> = true;

class Velocities {
 public:
  /// Velocities that one equation may couple, directly or by others.
  static constexpr std::size_t most_coupled = 24;

  /// Whether no more are coupled by ∂²L/∂v².
  static bool fits(const SymbolMatrix& hessian);
  /// What of a matrix has nothing to do with the rest; numbers: which entry stands there, from 1 on, 0 for none. Throws
  /// tape::TooManyOperations where blocks have too many.
  static std::vector<BlockMatrix::Block> blocks_of(const SymbolMatrix& matrix);
  /// `momenta`: of (q, v, s) ∂L/∂v; `with_hessian`: that and the entries of ∂²L/∂v², row by row. `linear`: momenta are
  /// in velocities, and vanish with them.
  Velocities(const SymbolMatrix& hessian, tape::Formula momenta, tape::Formula with_hessian, bool linear = false);

  std::size_t size() const { return n_; }
  /// Of ∂²L/∂v².
  const std::vector<BlockMatrix::Block>& blocks() const { return blocks_; }
  /// v of x = (q, p) and s, to n numbers; not numbers where there is none. It is found in double, then brought to the
  /// digits of T, or to its derivatives.
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
      constexpr int rounds = has_first_slopes<T> ? 1 : 4;  // with the matrix of the first
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
  /// Of ∂²L/∂v² at v, block by block. The thread's, until it asks for the next.
  const std::vector<double>& inverse_at(const double* x, double t, const double* v) const;

  std::size_t n_;
  std::vector<Block> blocks_;
  tape::Formula momenta_, with_hessian_;
  bool linear_;
};

}  // namespace least::text

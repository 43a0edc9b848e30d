#include "core/text/symbol_matrix.hpp"

#include <cstddef>
#include <utility>

namespace least::text {

bool is_nothing(const Symbol& x) { return x.is_constant() && x.constant() == 0; }

bool is_indefinite(const SymbolMatrix& second) {
  const std::size_t n = second.size();
  std::vector<double> m;
  for (const auto& row : second)
    for (const Symbol& entry : row) {
      if (!entry.is_constant()) return false;
      m.push_back(entry.constant());
    }
  for (std::size_t k = 0; k < n; ++k) {
    if (!(m[0] > 0 ? m[k * n + k] > 0 : m[k * n + k] < 0)) return true;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = m[i * n + k] / m[k * n + k];
      if (factor == 0) continue;  // of a thousand masses alone nearly all
      for (std::size_t j = k + 1; j < n; ++j) m[i * n + j] -= factor * m[k * n + j];
    }
  }
  return false;
}

std::optional<SymbolMatrix> inverse_of(SymbolMatrix a) {
  const std::size_t n = a.size();
  SymbolMatrix b(n, std::vector<Symbol>(n, Symbol(0)));
  for (std::size_t i = 0; i < n; ++i) b[i][i] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < n && is_nothing(a[pivot][k])) ++pivot;
    if (pivot == n) return std::nullopt;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k || is_nothing(a[i][k])) continue;
      const Symbol f = a[i][k] / a[k][k];
      for (std::size_t j = 0; j < n; ++j) {
        if (j > k && !is_nothing(a[k][j])) a[i][j] = a[i][j] - f * a[k][j];
        if (!is_nothing(b[k][j])) b[i][j] = b[i][j] - f * b[k][j];
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (!is_nothing(b[i][j])) b[i][j] = b[i][j] / a[i][i];
  return b;
}

}  // namespace least::text

#include "core/tape/elimination.hpp"

#include <utility>

namespace least::tape {

void eliminate(std::vector<Symbol>& a, std::vector<Symbol>& b) {
  const std::size_t n = b.size();
  const auto is_zero = [](const Symbol& y) { return y.is_constant() && y.constant() == 0; };
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot + 1 < n && is_zero(a[pivot * n + k])) ++pivot;
    for (std::size_t j = 0; j < n; ++j) std::swap(a[k * n + j], a[pivot * n + j]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k || is_zero(a[i * n + k])) continue;
      const Symbol share = a[i * n + k] / a[k * n + k];
      for (std::size_t j = k; j < n; ++j) a[i * n + j] = a[i * n + j] - share * a[k * n + j];
      b[i] = b[i] - share * b[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) b[k] = b[k] / a[k * n + k];
}

}  // namespace least::tape

#include "core/number/exponential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace least {
namespace {

/// Terms of φ₂(z) = Σ zᵏ/(k + 2)! that are more than round-off of the first where |z| ≤ 1/2.
constexpr int terms_of_phi = 14;

std::vector<double> product(std::size_t n, const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < n; ++j) c[i * n + j] += a[i * n + k] * b[k * n + j];
  return c;
}

}  // namespace

Phi phi(double z) {
  if (std::abs(z) > 0.5) {
    const double grown = std::expm1(z);
    return {grown / z, (grown - z) / z / z};
  }
  double two = 1;  // nested from the last term on
  for (int k = terms_of_phi; k > 0; --k) two = 1 + two * z / (k + 2);
  two *= 0.5;
  return {1 + z * two, two};
}

MatrixPhi phi(std::size_t n, std::vector<double> z) {
  double norm = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < n; ++j) row += std::abs(z[i * n + j]);
    norm = std::max(norm, row);
  }
  if (!std::isfinite(norm)) {
    const std::vector<double> undefined(n * n, std::numeric_limits<double>::quiet_NaN());
    return {undefined, undefined};
  }
  const int doublings = norm > 0.5 ? std::ilogb(norm) + 2 : 0;
  for (double& entry : z) entry = std::ldexp(entry, -doublings);
  const auto add_to_diagonal = [n](std::vector<double>& a, double x) {
    for (std::size_t i = 0; i < n; ++i) a[i * n + i] += x;
  };
  std::vector<double> two(n * n, 0.0);
  add_to_diagonal(two, 1);
  for (int k = terms_of_phi; k > 0; --k) {
    two = product(n, z, two);
    for (double& entry : two) entry /= k + 2;
    add_to_diagonal(two, 1);
  }
  for (double& entry : two) entry *= 0.5;
  std::vector<double> one = product(n, z, two);
  add_to_diagonal(one, 1);
  std::vector<double> whole = product(n, z, one);
  add_to_diagonal(whole, 1);
  // φ₂(2z) = (φ₁² + 2 φ₂)/4, φ₁(2z) = φ₁ (e^z + 1)/2: nothing cancels where motions decay.
  for (int k = 0; k < doublings; ++k) {
    const std::vector<double> square = product(n, one, one);
    for (std::size_t i = 0; i < two.size(); ++i) two[i] = 0.25 * square[i] + 0.5 * two[i];
    std::vector<double> half = whole;
    add_to_diagonal(half, 1);
    one = product(n, one, half);
    for (double& entry : one) entry *= 0.5;
    whole = product(n, whole, whole);
  }
  return {std::move(one), std::move(two)};
}

}  // namespace least

// φ₁(z) = (e^z − 1)/z and φ₂(z) = (e^z − 1 − z)/z² of numbers and of matrices: the solution of ẏ = w + B y, y(0) = 0,
// is y(h) = h φ₁(hB) w, and its mean over the time h is h φ₂(hB) w. Source: Hochbruck & Ostermann, Acta Numerica 19,
// 209 (2010), 2.1.
#pragma once

#include <cstddef>
#include <vector>

namespace least {

struct Phi {
  double one = 1, two = 0.5;
};
/// Returns φ₁(z) and φ₂(z), to round-off for every finite z.
Phi phi(double z);

/// MatrixPhi is φ₁ and φ₂ of an n × n matrix, row-major.
struct MatrixPhi {
  std::vector<double> one, two;
};
/// Computes φ₁ and φ₂ of the n × n matrix z, row-major, by scaling and doubling; not finite where z is not.
MatrixPhi phi(std::size_t n, std::vector<double> z);

}  // namespace least

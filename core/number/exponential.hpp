// φ₁(z) = (e^z − 1)/z and φ₂(z) = (e^z − 1 − z)/z² of numbers and of matrices: of ẏ = w + B y at y = 0 they give
// y(h) = h φ₁(hB) w and its mean over the time h, h φ₂(hB) w. Source: Hochbruck & Ostermann, Acta Numerica 19, 209
// (2010), 2.1.
#pragma once

#include <cstddef>
#include <vector>

namespace least {

struct Phi {
  double one = 1, two = 0.5;
};
/// To round-off for every finite z.
Phi phi(double z);

/// Of an n × n matrix, row by row.
struct MatrixPhi {
  std::vector<double> one, two;
};
/// By scaling and doubling; not finite where z is not.
MatrixPhi phi(std::size_t n, std::vector<double> z);

}  // namespace least

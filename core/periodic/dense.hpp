// Small dense matrices of dynamic size, and the linear algebra that closed orbits need. Only dense.cpp includes Eigen.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace least::periodic {

/// Matrix is stored row by row.
struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> a;

  Matrix() = default;
  Matrix(std::size_t r, std::size_t c) : rows(r), columns(c), a(r * c) {}
  static Matrix identity(std::size_t n);
  double& operator()(std::size_t i, std::size_t j) { return a[i * columns + j]; }
  double operator()(std::size_t i, std::size_t j) const { return a[i * columns + j]; }
  std::vector<double> column(std::size_t j) const;
  void add_column(std::span<const double> values);
};
Matrix operator*(const Matrix& a, const Matrix& b);
std::vector<double> operator*(const Matrix& a, std::span<const double> x);
Matrix transposed(const Matrix& a);
double dot(std::span<const double> a, std::span<const double> b);
/// length returns the Euclidean norm.
double length(std::span<const double> a);

/// decompose makes a complete orthogonal decomposition, which reveals the rank: pivots below `threshold` times the
/// largest count as zero.
/// Source: Golub & Van Loan, Matrix Computations, 2013, 5.5.
struct Decomposition {
  Matrix null;                   ///< an orthonormal basis of the null space, as columns
  std::vector<double> solution;  ///< the least-squares solution of A x = b with the smallest norm
};
Decomposition decompose(const Matrix& a, std::span<const double> b, double threshold);
/// span_of returns an orthonormal basis of the span of the columns. Anything below `threshold` times the larger of
/// `size` and the largest column counts as zero.
Matrix span_of(const Matrix& columns, double threshold, double size = 0);
/// orthogonal_to returns an orthonormal basis of the orthogonal complement of that span.
Matrix orthogonal_to(const Matrix& columns, double threshold, double size = 0);
/// complement_of returns the same where the rank of the columns is known.
Matrix complement_of(const Matrix& columns, std::size_t rank);

/// eigenvalues returns all eigenvalues, in no particular order.
std::vector<std::complex<double>> eigenvalues(const Matrix& square);
/// eigenvector returns the unit eigenvector of the real eigenvalue closest to `value`.
std::vector<double> eigenvector(const Matrix& square, double value);

}  // namespace least::periodic

// Small dense matrices whose size is known when they are made, and what closed orbits need of them. dense.cpp alone
// sees Eigen.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace least::periodic {

/// Row by row.
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
/// Of the Euclidean kind.
double length(std::span<const double> a);

/// A complete orthogonal decomposition, which tells the rank: pivots below `threshold` times the largest count as none.
/// Source: Golub & Van Loan, Matrix Computations, 2013, 5.5.
struct Decomposition {
  Matrix null;                   ///< an orthonormal basis of the null space, as columns
  std::vector<double> solution;  ///< of A x = b in the sense of least squares, of all of these the shortest
};
Decomposition decompose(const Matrix& a, std::span<const double> b, double threshold);
/// An orthonormal basis of what the columns span. What is below `threshold` times the largest or `size` is nothing.
Matrix span_of(const Matrix& columns, double threshold, double size = 0);
/// One of what is orthogonal to all of them.
Matrix orthogonal_to(const Matrix& columns, double threshold, double size = 0);
/// The same where so many of them are known to be independent.
Matrix complement_of(const Matrix& columns, std::size_t rank);

std::vector<std::complex<double>> eigenvalues(const Matrix& square);
/// Of the real eigenvalue next to `value`, of length 1.
std::vector<double> eigenvector(const Matrix& square, double value);

}  // namespace least::periodic

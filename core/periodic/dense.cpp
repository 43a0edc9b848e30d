#include "core/periodic/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace least::periodic {
namespace {

using Dense = Eigen::MatrixXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Orthogonal = Eigen::CompleteOrthogonalDecomposition<Dense>;

Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }
Dense dense(const Matrix& m) { return Eigen::Map<const Rows>(m.a.data(), index(m.rows), index(m.columns)); }
Matrix plain(const Dense& m) {
  Matrix made(static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()));
  Eigen::Map<Rows>(made.a.data(), m.rows(), m.cols()) = m;
  return made;
}

Orthogonal factors(const Dense& a, double threshold) {
  Orthogonal made(a.rows(), a.cols());
  made.setThreshold(threshold);
  made.compute(a);
  return made;
}

/// With A P = Q [T 0; 0 0] Z the last columns of P Zᵀ span the null space of A.
Dense null_space(const Orthogonal& of) {
  const Eigen::Index n = of.cols(), rank = of.rank();
  const Dense z = rank < n ? Dense(of.matrixZ().transpose()) : Dense::Identity(n, n);
  return of.colsPermutation() * z.rightCols(n - rank);
}

}  // namespace

Matrix Matrix::identity(std::size_t n) {
  Matrix made(n, n);
  for (std::size_t i = 0; i < n; ++i) made(i, i) = 1;
  return made;
}

std::vector<double> Matrix::column(std::size_t j) const {
  std::vector<double> values(rows);
  for (std::size_t i = 0; i < rows; ++i) values[i] = (*this)(i, j);
  return values;
}

void Matrix::add_column(std::span<const double> values) {
  Matrix wider(values.size(), columns + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) wider(i, j) = (*this)(i, j);
    wider(i, columns) = values[i];
  }
  *this = std::move(wider);
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix made(a.rows, b.columns);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t k = 0; k < a.columns; ++k)
      for (std::size_t j = 0; j < b.columns; ++j) made(i, j) += a(i, k) * b(k, j);
  return made;
}

std::vector<double> operator*(const Matrix& a, std::span<const double> x) {
  std::vector<double> y(a.rows);
  for (std::size_t i = 0; i < a.rows; ++i) y[i] = dot(std::span(a.a).subspan(i * a.columns, a.columns), x);
  return y;
}

Matrix transposed(const Matrix& a) {
  Matrix made(a.columns, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.columns; ++j) made(j, i) = a(i, j);
  return made;
}

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double length(std::span<const double> a) { return std::sqrt(dot(a, a)); }

Decomposition decompose(const Matrix& a, std::span<const double> b, double threshold) {
  const Orthogonal made = factors(dense(a), threshold);
  Decomposition found{plain(null_space(made)), std::vector<double>(a.columns)};
  Eigen::Map<Eigen::VectorXd>(found.solution.data(), index(a.columns)) =
      made.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), index(b.size())));
  return found;
}

namespace {

/// The first `rank` columns of Q span the given columns.
struct Spanned {
  Dense q;
  Eigen::Index rank;
};
Spanned spanned(const Matrix& columns, double threshold, double size = 0) {
  Eigen::ColPivHouseholderQR<Dense> made(index(columns.rows), index(columns.columns));
  const Dense all = dense(columns);
  const double largest = all.colwise().norm().maxCoeff();
  made.setThreshold(threshold * std::max(1.0, size / largest));
  made.compute(all);
  return {made.householderQ(), made.rank()};
}

}  // namespace

Matrix orthogonal_to(const Matrix& columns, double threshold, double size) {
  if (columns.columns == 0) return Matrix::identity(columns.rows);
  const Spanned made = spanned(columns, threshold, size);
  return plain(made.q.rightCols(made.q.cols() - made.rank));
}

Matrix complement_of(const Matrix& columns, std::size_t rank) {
  if (columns.columns == 0) return Matrix::identity(columns.rows);
  return plain(spanned(columns, 0).q.rightCols(index(columns.rows - rank)));
}

Matrix span_of(const Matrix& columns, double threshold, double size) {
  if (columns.columns == 0) return columns;
  const Spanned made = spanned(columns, threshold, size);
  return plain(made.q.leftCols(made.rank));
}

/// Read off the diagonal blocks, of one or two rows, of the real Schur form.
std::vector<std::complex<double>> eigenvalues(const Matrix& square) {
  const std::size_t n = square.rows;
  std::vector<std::complex<double>> values(n);
  if (n == 0) return values;
  const Eigen::RealSchur<Dense> schur(dense(square), false);
  const auto t = [&](std::size_t i, std::size_t j) { return schur.matrixT()(index(i), index(j)); };
  for (std::size_t i = 0; i < n; ++i) {
    if (i + 1 == n || t(i + 1, i) == 0) {
      values[i] = t(i, i);
      continue;
    }
    const double half = (t(i, i) - t(i + 1, i + 1)) / 2, inner = half * half + t(i, i + 1) * t(i + 1, i);
    const std::complex<double> root = std::sqrt(std::complex<double>(inner));
    values[i] = t(i + 1, i + 1) + half + root;
    values[i + 1] = t(i + 1, i + 1) + half - root;
    ++i;
  }
  return values;
}

/// The null space of A − λ: orthogonal to all rows.
std::vector<double> eigenvector(const Matrix& square, double value) {
  Matrix rows = transposed(square);
  for (std::size_t i = 0; i < rows.rows; ++i) rows(i, i) -= value;
  return complement_of(rows, rows.rows - 1).column(0);
}

}  // namespace least::periodic

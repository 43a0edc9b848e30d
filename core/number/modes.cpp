#include "core/number/modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace least {

Modes modes_of(std::size_t n, const std::vector<double>& symmetric) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(n);
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Eigen::Map<const Matrix>(symmetric.data(), size, size));
  Modes modes{std::vector<double>(n), std::vector<double>(n * n)};
  std::copy_n(solver.eigenvalues().data(), n, modes.values.begin());
  Eigen::Map<Matrix>(modes.vectors.data(), size, size) = solver.eigenvectors();
  return modes;
}

}  // namespace least

// Eigenvalues and eigenvectors of symmetric matrices: the normal modes of small oscillations.
#pragma once

#include <cstddef>
#include <vector>

namespace least {

struct Modes {
  std::vector<double> values;   ///< eigenvalues, increasing
  std::vector<double> vectors;  ///< row-major; column k is the eigenvector of values[k]; orthonormal
};
/// Returns the modes of a symmetric n × n matrix, row-major, of which only the lower triangle is read.
Modes modes_of(std::size_t n, const std::vector<double>& symmetric);

}  // namespace least

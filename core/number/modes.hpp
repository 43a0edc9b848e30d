// Eigenvalues and eigenvectors of symmetric matrices: the normal modes of small oscillations.
#pragma once

#include <cstddef>
#include <vector>

namespace least {

struct Modes {
  std::vector<double> values;   ///< increasing
  std::vector<double> vectors;  ///< row by row; the k-th column is the one of the k-th value; orthogonal, of length 1
};
/// Of an n × n matrix, row by row, of which the lower half is read.
Modes modes_of(std::size_t n, const std::vector<double>& symmetric);

}  // namespace least

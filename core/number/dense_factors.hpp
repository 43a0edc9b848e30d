// DenseFactors is the LU decomposition, in place, of a matrix whose size is known at run time (core/number/linear.cpp).
#pragma once

#include <cstddef>
#include <memory>

namespace least {

class DenseFactors {
 public:
  explicit DenseFactors(std::size_t n);
  ~DenseFactors();
  DenseFactors(const DenseFactors&) = delete;
  DenseFactors& operator=(const DenseFactors&) = delete;

  /// The n × n matrix, row-major; `factor` overwrites it.
  double* entries();
  /// Replaces the matrix by its factors, block of columns by block of columns. Returns false if
  /// AskedByThread::goes_on(), which it asks between blocks, does.
  bool factor();
  /// Replaces b by x with A x = b; not finite where the matrix is singular. Requires `factor`.
  void solve(double* b);

 private:
  struct Eigens;
  std::unique_ptr<Eigens> of_;
};

}  // namespace least

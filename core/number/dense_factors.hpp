// LU decompositions of matrices whose size is known when they run, in place (core/number/linear.cpp).
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

  /// Row by row; spoilt by `factor`.
  double* entries();
  /// By blocks of columns, between which it asks whether it is to go on (AskedByThread); false: it is not.
  bool factor();
  /// x with A x = b in the place of b; not finite where the matrix has no inverse.
  void solve(double* b);

 private:
  struct Eigens;
  std::unique_ptr<Eigens> of_;
};

}  // namespace least

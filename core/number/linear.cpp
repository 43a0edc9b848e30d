#include "core/number/linear.hpp"

#include <Eigen/LU>

#include "core/number/quad.hpp"

#if LDBL_MANT_DIG < 113
template <>
struct Eigen::NumTraits<least::Quad> : Eigen::GenericNumTraits<least::Quad> {
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 8,
    MulCost = 8
  };
};
#endif

namespace least {
namespace {

template <class T, int N>
using Square = Eigen::Matrix<T, N, N, Eigen::RowMajor, N == Eigen::Dynamic ? largest_system : N,
                             N == Eigen::Dynamic ? largest_system : N>;
template <class T, int N>
using Column = Eigen::Matrix<T, N, 1, 0, N == Eigen::Dynamic ? largest_system : N, 1>;

/// The decomposition takes the place of `a`: what is as large as a system can be is only its list of pivots.
template <int N, class T>
void solve(std::size_t n, T* a, const T* b, T* x) {
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Square<T, N>> rows(a, size, size);
  const Eigen::PartialPivLU<Eigen::Ref<Square<T, N>>> lu(rows);
  Eigen::Map<Column<T, N>>(x, size) = lu.solve(Eigen::Map<const Column<T, N>>(b, size));
}

}  // namespace

template <class T>
void detail::solve_by_lu(std::size_t n, T* a, const T* b, T* x) {
  // A size that is fixed saves up to 50 ns and takes two seconds of compilation: for the smallest and most frequent.
  if constexpr (std::is_same_v<T, double>) {
    if (n == 2) return solve<2>(n, a, b, x);
    if (n == 3) return solve<3>(n, a, b, x);
    if (n == 4) return solve<4>(n, a, b, x);
  }
  solve<Eigen::Dynamic>(n, a, b, x);
}
template void detail::solve_by_lu(std::size_t, double*, const double*, double*);
template void detail::solve_by_lu(std::size_t, long double*, const long double*, long double*);
#if LDBL_MANT_DIG < 113
template void detail::solve_by_lu(std::size_t, Quad*, const Quad*, Quad*);
#endif

double detail::determinant_by_lu(std::size_t n, double* a) {
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Square<double, Eigen::Dynamic>> rows(a, size, size);
  return Eigen::PartialPivLU<Eigen::Ref<Square<double, Eigen::Dynamic>>>(rows).determinant();
}

}  // namespace least

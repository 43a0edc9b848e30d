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

constexpr int largest = 9;

template <class T, int N, int most = N>
using Square = Eigen::Matrix<T, N, N, Eigen::RowMajor, most, most>;
template <class T, int N, int most = N>
using Column = Eigen::Matrix<T, N, 1, 0, most, 1>;

}  // namespace

template <class T>
template <std::size_t N>
std::array<T, N> LinearSolver<T>::by_lu(const std::array<std::array<T, N>, N>& a, const std::array<T, N>& b) {
  // A size that is fixed saves up to 50 ns and takes two seconds of compilation: for the smallest and most frequent.
  constexpr bool fixed = std::is_same_v<T, double> && N <= 4;
  constexpr int size = fixed ? int(N) : Eigen::Dynamic, most = fixed ? int(N) : largest;
  using Rows = Square<T, size, most>;
  using Values = Column<T, size, most>;
  std::array<T, N> x;
  Eigen::Map<Values>(x.data(), N) =
      Eigen::Map<const Rows>(a[0].data(), N, N).partialPivLu().solve(Eigen::Map<const Values>(b.data(), N));
  return x;
}

template <std::size_t N>
double determinant(const std::array<std::array<double, N>, N>& a) {
  return Eigen::Map<const Square<double, Eigen::Dynamic, largest>>(a[0].data(), N, N).partialPivLu().determinant();
}
template double determinant<3>(const std::array<std::array<double, 3>, 3>&);
template double determinant<5>(const std::array<std::array<double, 5>, 5>&);
template double determinant<7>(const std::array<std::array<double, 7>, 7>&);

// Sizes and numbers that implicit schemes and their tests ask for.
#define LEAST_SOLVE(T, N) \
  template std::array<T, N> LinearSolver<T>::by_lu<N>(const std::array<std::array<T, N>, N>&, const std::array<T, N>&);
#define LEAST_SOLVES(N) LEAST_SOLVE(double, N) LEAST_SOLVE(long double, N) LEAST_QUAD(N)
#if LDBL_MANT_DIG < 113
#define LEAST_QUAD(N) LEAST_SOLVE(Quad, N)
#else
#define LEAST_QUAD(N)
#endif
LEAST_SOLVES(2)
LEAST_SOLVES(3)
LEAST_SOLVES(4)
LEAST_SOLVES(5)
LEAST_SOLVES(6)
LEAST_SOLVES(7)
LEAST_SOLVES(8)
LEAST_SOLVES(9)

}  // namespace least

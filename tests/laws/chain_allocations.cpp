// No step allocates, however large the system it solves. Above 16 equations Eigen works in blocks.
#include "tests/support/allocations.hpp"
#include "tests/support/chains.hpp"

namespace {

using namespace chains;

template <template <class> class P, class Scheme>
void allocates_nothing(const Scheme& scheme) {
  const P<double> problem;
  auto x = start<FullStateOf<P<double>>>();
  auto stepper = scheme.bind(problem, x);
  const std::size_t before = counting::allocations();
  for (int k = 0; k < 3; ++k) {
    if constexpr (SelfTimed<Scheme>) {
      ASSERT_EQ(stepper.step(x), StepStatus::ok) << laws::label(scheme);
    } else {
      ASSERT_EQ(stepper.step(x, 0.01), StepStatus::ok) << laws::label(scheme);
    }
  }
  EXPECT_EQ(counting::allocations(), before) << laws::label(scheme);
}

TEST(ChainsOfEight, AllocateNothingInAStep) {
  allocates_nothing<Toda<8>::Ring>(VariationalMidpoint{});
  allocates_nothing<Toda<8>::Ring>(Galerkin4{});
  allocates_nothing<Toda<8>::Damped>(ContactGalerkin4{});
  allocates_nothing<Toda<8>::Damped>(ContactGauss{0.01, 3});
  allocates_nothing<Toda<8>::Quadratic>(ContactGauss{0.01, 3});
  allocates_nothing<Toda<8>::Ring>(TypedTaylor{});
  allocates_nothing<Toda<8>::Ring>(DormandPrince5{});
  allocates_nothing<Toda<8>::Ring>(Fehlberg78{});
}

TEST(ChainsOfEight, DeterminantsAllocateNothing) {
  Mat<33> unit{};
  for (std::size_t i = 0; i < unit.size(); ++i) unit[i][i] = i % 2 ? 2 : 0.5;
  const std::size_t before = counting::allocations();
  EXPECT_DOUBLE_EQ(determinant(unit), 0.5);
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace

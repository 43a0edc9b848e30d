// adaptive_verlet on scenes of many coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "core/from_values.hpp"
#include "core/schemes/adaptive_verlet.hpp"
#include "tests/support/sized.hpp"

namespace sized_adaptive {
namespace {

using namespace sized;
constexpr auto typed_v = Definition::Kind::potential, typed_h = Definition::Kind::hamiltonian;
constexpr const char* monitors[] = {"arclength", "frequency"};

/// Toda's lattice closed to a ring, held by springs where `k` is not 0: of unequal masses, or of momenta that are
/// coupled by `c`.
std::shared_ptr<const Mechanics> ring(int n, double k, double c = 0) {
  text::TypedScene typed;
  const std::string potential = "sum(i=1..n, exp(q[i] - q[mod(i,n)+1]) + k*q[i]^4/4)";
  const std::vector<std::pair<std::string, double>> parameters{{"n", double(n)}, {"k", k}, {"c", c}};
  if (c == 0) {
    typed.scene = of(typed_v, {"q[n]"}, parameters, potential);
    typed.scene.masses = {{"q[i]", "1 + i/n"}};
  } else {
    typed.scene =
        of(typed_h, {"q[n]"}, parameters, "sum(i=1..n, p[i]^2/2) + c*sum(i=1..n-1, p[i]*p[i+1]) + " + potential);
  }
  return made(typed);
}
std::vector<double> start(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.9 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.8 * std::cos(3 * i));
  return x;
}
Request adaptive(const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& from,
                 std::string_view monitor, double end, double step) {
  Request request = stepped("adaptive_verlet", mechanics, from, end, step);
  runs::set(request, "monitor", monitor);
  return request;
}

TEST(SizedAdaptive, IsOfOrder2) {
  for (const int n : {9, 100})
    for (const double c : {0.0, 0.2})
      for (const char* monitor : monitors) {
        const auto mechanics = ring(n, 0.4, c);
        const auto truth = final_of(request_by("taylor", mechanics, start(n), 4));
        const auto error = [&](double step) {
          return distance(final_of(adaptive(mechanics, start(n), monitor, 4, step)), truth);
        };
        EXPECT_NEAR(std::log2(error(0.05) / error(0.025)), 2, 0.2) << n << monitor << c;
      }
}

/// The same scene as a problem that is compiled.
template <int N, bool Coupled>
struct Ring {
  static constexpr int dof = N;
  static constexpr double spring = 0.4, coupling = 0.2;

  template <class T, class S>
  constexpr T potential(const Vec<N, T>& q, const S&) const {
    using least::exp;
    T sum(0);
    for (std::size_t i = 0; i < N; ++i)
      sum = sum + exp(q[i] - q[(i + 1) % N]) + spring * (q[i] * q[i]) * (q[i] * q[i]) / 4;
    return sum;
  }
  Vec<N> inverse_mass() const {
    Vec<N> w;
    for (std::size_t i = 0; i < N; ++i) w[i] = 1 / (1 + double(i + 1) / N);
    return w;
  }
  bool has_full_mass() const { return Coupled; }
  template <class T>
  Vec<N, T> times_inverse_mass(const Vec<N, T>& p) const {
    Vec<N, T> v = p;
    for (std::size_t i = 0; i + 1 < N; ++i) {
      v[i] = v[i] + coupling * p[i + 1];
      v[i + 1] = v[i + 1] + coupling * p[i];
    }
    return v;
  }
  template <class T>
  Vec<N, T> times_mass(const Vec<N, T>& v) const {
    return v;  // steps ask for none
  }
};
template <int N, bool Coupled>
void is_as_compiled() {
  using P = Ring<N, Coupled>;
  const P problem;
  for (const char* monitor : monitors) {
    Request request = adaptive(ring(N, P::spring, Coupled ? P::coupling : 0), start(N), monitor, 1, 0.05);
    request.until_steps = true;
    request.steps = 60;
    const auto found = runs::go(request).outcome;
    StateOf<P> x;
    for (std::size_t i = 0; i < 2 * N; ++i) x[i] = start(N)[i];
    const auto scheme = from_values<AdaptiveVerlet>(AdaptiveVerlet::fields, request.settings);
    auto stepper = scheme.bind(problem, x, energy(problem, x));
    for (int k = 0; k < request.steps; ++k) ASSERT_EQ(stepper.step(x), StepStatus::ok);
    EXPECT_GT(std::abs(stepper.density() - 1), 1e-3);
    EXPECT_NEAR(found.t, x.t, 1e-13) << N << monitor;
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_NEAR(found.final[i], x[i], 1e-12) << N << monitor << i;
    EXPECT_EQ(found.cost.force_evaluations, stepper.work().forces);
  }
}
TEST(SizedAdaptive, StatesAreThoseOfTheProblemThatIsCompiled) {
  is_as_compiled<1, false>();
  is_as_compiled<2, false>();
  is_as_compiled<2, true>();
  is_as_compiled<3, true>();
  is_as_compiled<8, false>();
  is_as_compiled<9, false>();
  is_as_compiled<9, true>();
}

// What is the same everywhere leaves steps as they are; so does what is not there.
TEST(SizedAdaptive, IsLeapfrogWhereTheFrequencyDoesNotChange) {
  constexpr int n = 50;
  for (const char* potential : {"sum(i=1..50, i*q[i]^2/20)", "sum(i=1..50, q[i]/i)"}) {
    text::TypedScene typed;
    typed.scene = of(typed_v, {"q[50]"}, {}, potential);
    const auto mechanics = made(typed);
    const auto by_leapfrog = final_of(stepped("leapfrog", mechanics, start(n), 5, 0.125));
    EXPECT_LT(distance(final_of(adaptive(mechanics, start(n), "frequency", 5, 0.125)), by_leapfrog), 1e-12);
  }
}

TEST(SizedAdaptive, TheMomentumOfTheWholeIsKept) {
  constexpr int n = 40;
  for (const char* monitor : monitors) {
    Request request = adaptive(ring(n, 0), start(n), monitor, 20, 0.1);
    request.until_steps = true;
    request.steps = 200;
    const auto x = final_of(request);
    double before = 0, after = 0;
    for (std::size_t i = n; i < 2 * n; ++i) {
      before += start(n)[i];
      after += x[i];
    }
    EXPECT_GT(std::abs(before), 0.05);
    EXPECT_NEAR(after, before, 1e-12) << monitor;
  }
}

TEST(SizedAdaptive, StopsWhereTheDensityIsLost) {
  const auto outcome = runs::go(adaptive(ring(9, 0.4), start(9), "frequency", 50, 0.6)).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::singular) << outcome.stop.detail.text();
}

TEST(SizedAdaptive, IsOfferedWhereNothingDependsOnTime) {
  const auto offered = [](const std::string& more, std::optional<std::string> damping = {}) {
    text::TypedScene typed;
    typed.scene = of(typed_v, {"q[100]"}, {}, "sum(i=1..100, q[i]^4)" + more);
    typed.scene.damping = damping;
    return runs::fits(made(typed)->card(), find_scheme("adaptive_verlet").value());
  };
  EXPECT_TRUE(offered(""));
  EXPECT_FALSE(offered(" + sin(t)*q[1]"));
  EXPECT_FALSE(offered("", "0.1"));
}

}  // namespace
}  // namespace sized_adaptive

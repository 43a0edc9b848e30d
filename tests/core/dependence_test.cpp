// Whether a problem depends on time and keeps its energy, as the compiler finds it, against the problem's equations.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "core/problem_traits.hpp"
#include "least_problems.hpp"

namespace least::problems {}

namespace {

using namespace least;
using namespace least::problems;

// ── forms that hide the time ────────────────────────────────────────────────────────────────────────────────────────

struct Pendulum0 {
  static constexpr int dof = 1;
  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    using least::cos;
    return -cos(q[0]);
  }
};
static_assert(Autonomous<Pendulum0> && KeepsEnergy<Pendulum0>);

/// A drive whose default amplitude is zero: the form decides, not the value.
template <class R = double>
struct Still {
  R amplitude{0};
  static constexpr int dof = 1;
  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S& t) const {
    return q[0] * q[0] - amplitude * t * q[0];
  }
};
static_assert(Conservative<Still<>> && !Autonomous<Still<>> && !KeepsEnergy<Still<>>);
static_assert(!Autonomous<Still<Dual<double, 1>>>, "whatever the parameters are made of");

/// The time occurs in a comparison only, by way of a phase.
struct Switched {
  static constexpr int dof = 1;
  template <class S>
  struct Phase {
    S on;
  };
  template <class S>
  constexpr auto phases(const S& t) const {
    return Phase<S>{select(t < S(1), S(1), S(2))};
  }
  template <class T, class F>
  constexpr T potential(const Vec<1, T>& q, const F& f) const {
    return f.on * (q[0] * q[0]);
  }
};
static_assert(Conservative<Switched> && !Autonomous<Switched>);

/// The time occurs in a hand-written gradient only; there it is as wrong as in the potential.
struct ByHand : Pendulum0 {
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S& t) const {
    return {q[0] * t};
  }
};
static_assert(!Autonomous<ByHand>);

struct Braked : Pendulum0 {
  template <class S>
  constexpr auto damping(const S& t) const {
    using least::exp;
    return exp(-t);
  }
};
struct Steady : Pendulum0 {
  constexpr double damping() const { return 0.1; }
};
static_assert(!Autonomous<Braked> && Autonomous<Steady> && !KeepsEnergy<Steady>);

struct Pushed {
  static constexpr int dim = 2;
  template <class T, class S>
  constexpr Vec<2, T> field(const Vec<2, T>& y, const S& t) const {
    return {y[1], t - y[0]};
  }
};
static_assert(Flow<Pushed> && !Autonomous<Pushed>);

// ── every problem of the catalogue ──────────────────────────────────────────────────────────────────────────────────

/// somewhere() returns the card's start, moved away from special values, at the time t.
template <template <class> class P>
FullStateOf<P<double>> somewhere(double t) {
  FullStateOf<P<double>> x;
  const auto variables = About<P>::card().variables;
  for (std::size_t i = 0; i < x.size; ++i) x[i] = 0.9 * variables.at(i).value + 0.07 * double(i + 1);
  x.t = t;
  return x;
}

inline void shift(double& parameter) { parameter += 0.05; }
template <class Choice>
void shift(Choice&) {}

/// off_default() moves the parameters away from their defaults, too: a drive that is off by default counts.
template <template <class> class P>
P<double> off_default() {
  P<double> problem;
  std::apply([&](const auto&... field) { (shift(problem.*field.member), ...); }, About<P>::fields);
  return problem;
}

template <template <class> class P>
void agrees_with_its_equations(const char* id) {
  const P<double> problem = off_default<P>();
  bool same = true;
  for (const double t : {0.9, 1.7, 2.6}) {
    const auto now = derivative(problem, somewhere<P>(t)), then = derivative(problem, somewhere<P>(0.4));
    for (std::size_t i = 0; i < now.size; ++i) same = same && now[i] == then[i];
  }
  EXPECT_EQ(Autonomous<P<double>>, same) << id;

  if constexpr (HasFrequency<P<double>>) {
    auto elsewhere = somewhere<P>(0.4);
    for (std::size_t i = 0; i < elsewhere.size; ++i) elsewhere[i] += 0.3;
    EXPECT_EQ(ConstantFrequency<P<double>>,
              problem.frequency_squared(position(elsewhere)) == problem.frequency_squared(position(somewhere<P>(0.4))))
        << id;
  }

  if constexpr (HasEnergy<P<double>>) {  // dH/dt along the motion
    using D = Dual<double, 1>;
    double most = 0;
    for (const double t : {0.9, 1.7, 2.6}) {
      const auto x = somewhere<P>(t);
      const auto rate = derivative(problem, x);
      auto moving = convert<D, D>(x);
      for (std::size_t i = 0; i < x.size; ++i) moving[i].slope[0] = rate[i];
      moving.t.slope[0] = 1;
      most = std::max(most, std::abs(energy(problem, moving).slope[0]));
    }
    EXPECT_EQ(KeepsEnergy<P<double>>, most < 1e-13) << id << ": " << most;
  } else {
    EXPECT_FALSE(KeepsEnergy<P<double>>) << id;
  }
}

TEST(Autonomous, AgreesWithTheEquationsOfEveryProblem) {
#define LEAST_AGREES(id, Class) agrees_with_its_equations<Class>(#id);
  LEAST_FOR_EACH_PROBLEM(LEAST_AGREES)
#undef LEAST_AGREES
}

}  // namespace

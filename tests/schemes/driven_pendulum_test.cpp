// A pendulum pushed with a period, H = p²/2 − cos q − A q cos(Ωt): conservative in its form, but its energy changes.
// Schemes evaluate the potential at the times of their discrete Lagrangian or their stages; schemes that need an energy
// level do not take this problem.
#include <set>

#include "core/catalogue/compiled.hpp"
#include "tests/support/chains.hpp"

namespace {

using namespace least;

template <class R = double>
struct DrivenPendulum {
  R amplitude{0.7}, frequency{2.3};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S& t) const {
    using least::cos;
    return -cos(q[0]) - amplitude * cos(frequency * t) * q[0];
  }
};

}  // namespace

template <>
struct least::About<DrivenPendulum> {
  using P = DrivenPendulum<>;
  static constexpr std::tuple fields{Field<P>{"amplitude", "A", "1", "of the drive", &P::amplitude, {-1e3, 1e3}},
                                     Field<P>{"frequency", "Ω", "1", "of the drive", &P::frequency, {0, 1e3}}};
  static ProblemCard card() {
    return {.id = "driven_pendulum",
            .title = "Driven pendulum",
            .variables = {{"q", "q", "rad", "angle", 0.9}, {"p", "p", "1", "momentum", 0.4}},
            .span = 8,
            .suggested = {{"step", 0.05}}};
  }
};

namespace {

using P = DrivenPendulum<>;
static_assert(Conservative<P> && Separable<P>, "no s anywhere");
static_assert(!Autonomous<P> && !KeepsEnergy<P>);
static_assert(!SelfTimedSchemeFor<JacobiMaupertuis, P> && !SelfTimedSchemeFor<TimeTransformed, P> &&
              !SelfTimedSchemeFor<AdaptiveVerlet, P>);

TEST(DrivenPendulum, IsRunByWhatReadsTheTime) {
  std::set<std::string> found;
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    ((Fits<Scheme, P> ? void(found.insert(Scheme::card().id)) : void()), ...);
  }(static_cast<SchemeList*>(nullptr));
  const std::set<std::string> expected{"explicit_euler",   "explicit_midpoint", "runge_kutta_4",        "ruth_3",
                                       "symplectic_euler", "leapfrog",          "variational_midpoint", "galerkin_4",
                                       "dormand_prince_5", "fehlberg_78",       "bulirsch_stoer",       "taylor"};
  EXPECT_EQ(found, expected);
}
TEST(DrivenPendulum, OrderIsAsDeclared) { laws::order_is_as_declared<DrivenPendulum>(); }
TEST(DrivenPendulum, SymmetricSchemesReturn) { laws::symmetric_schemes_return<DrivenPendulum>(); }
TEST(DrivenPendulum, NoStepIsTheIdentity) { laws::no_step_is_the_identity<DrivenPendulum>(); }

TEST(DrivenPendulum, TolerancesAreMet) { chains::tolerances_are_met<DrivenPendulum>(8); }

}  // namespace

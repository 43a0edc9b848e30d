// Dissipative and driven scenes against reference states of 26 digits that were computed independently
// (tests/reference/contact.json says how): the quad-precision reference integrator and the closed forms to nearly all
// of them, and a scheme of high order through a run, s included, to what double can say.
#include <gtest/gtest.h>

#include <cmath>

#include "core/from_values.hpp"
#include "core/number/parse.hpp"
#include "core/reference/reference.hpp"
#include "least_problems.hpp"
#include "tests/support/contact_data.hpp"

namespace {

using namespace least;
using namespace least::problems;
using contact::data, contact::orbits, contact::request_for;
using nlohmann::json;

/// number() reads a number, or one of the few expressions that are used for parameters.
Quad number(const std::string& text) {
  const Quad pi = parse<Quad>("3.14159265358979323846264338327950288");
  if (text == "pi") return pi;
  if (text == "2pi") return 2 * pi;
  if (text == "pi/3") return pi / 3;
  if (text == "-pi/2") return -pi / 2;
  if (text == "8/3") return Quad(8) / 3;
  if (text == "sqrt2") return sqrt(Quad(2));
  return parse<Quad>(text);
}
Quad quad(const json& text) { return number(text.get<std::string>()); }

/// component() returns which component of the state a column of the reference is; −1 for none (s where the motion does
/// not depend on it, or a slope).
template <template <class> class P>
int component(const std::string& variable) {
  const ProblemCard card = About<P>::card();
  for (std::size_t i = 0; i < StateOf<P<double>>::size; ++i)
    if (card.variables[i].name == variable) return int(i);
  return -1;
}

template <class X>
using Path = std::vector<X>;

/// with_exact_parameters() returns what `solve(problem)` would give for parameters in quad precision, which problems do
/// not take: the value at the nearest doubles, corrected linearly in each parameter by means of the next double. The
/// error is of second order in the spacing of doubles.
template <template <class> class P, class Solve>
auto with_exact_parameters(const json& entry, Solve&& solve) {
  using M = P<double>;
  std::vector<double> values;
  for (const auto& p : parameter_cards(About<P>::fields)) values.push_back(p.value);
  std::vector<std::pair<std::size_t, Quad>> inexact;
  for (const auto& [name, text] : entry.at("parameters").items()) {
    const auto i = runs::position(parameter_cards(About<P>::fields), name, [](const auto& p) { return p.name; });
    const Quad exact = quad(text);
    values[i] = static_cast<double>(exact);
    if (exact != values[i]) inexact.emplace_back(i, exact);
  }
  const auto states = solve(from_values<M>(About<P>::fields, values));
  auto corrected = states;
  for (const auto& [i, exact] : inexact) {
    auto others = values;
    others[i] = std::nextafter(values[i], exact > values[i] ? INFINITY : -INFINITY);
    const Quad part = (exact - values[i]) / (Quad(others[i]) - values[i]);
    const auto beside = solve(from_values<M>(About<P>::fields, others));
    for (std::size_t k = 0; k < std::min(states.size(), beside.size()); ++k)
      for (std::size_t c = 0; c < states[k].size; ++c) corrected[k][c] += part * (beside[k][c] - states[k][c]);
  }
  return corrected;
}

template <template <class> class P>
StateOf<P<double>, Quad, Quad> start(const json& entry) {
  StateOf<P<double>, Quad, Quad> x;
  for (std::size_t i = 0; i < entry.at("variables").size(); ++i)
    if (const int c = component<P>(entry.at("variables").at(i)); c >= 0)
      x[std::size_t(c)] = quad(entry.at("start").at(i));
  return x;
}

/// difference() returns the largest difference from the reference in the components there are, relative to the larger
/// of 1 and the state.
template <template <class> class P, class X>
double difference(const X& x, const json& variables, const json& state) {
  double most = 0, size = 1;
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (const int c = component<P>(variables.at(i)); c >= 0) {
      const Quad truth = quad(state.at(i));
      most = std::max(most, std::abs(static_cast<double>(Quad(x[std::size_t(c)] - truth))));
      size = std::max(size, std::abs(static_cast<double>(truth)));
    }
  return most / size;
}

/// check_integrator() checks the project's own reference integrator up to the time `last`.
template <template <class> class P>
void check_integrator(const std::string& id, double last, double tolerance) {
  using X = StateOf<P<double>, Quad, Quad>;
  ASSERT_FALSE(orbits(id).empty());
  for (const json* entry : orbits(id)) {
    const auto path = with_exact_parameters<P>(*entry, [&](const P<double>& problem) {
      Path<X> states;
      Extrapolation<P<double>> run(problem, start<P>(*entry), 1e-27);
      for (const auto& state : entry->at("states"))
        if (const Quad t = quad(state.at("t")); t < last * (1 + 1e-9)) {
          EXPECT_TRUE(run.advance(t, [] { return true; }));
          states.push_back(run.state());
        }
      return states;
    });
    ASSERT_FALSE(path.empty());
    for (std::size_t k = 0; k < path.size(); ++k)
      EXPECT_LT(difference<P>(path[k], entry->at("variables"), entry->at("states").at(k).at("state")), tolerance)
          << entry->at("parameters") << " at " << entry->at("states").at(k).at("t");
  }
}
template <template <class> class P>
void check_closed_form(const std::string& id, double tolerance) {
  for (const json* entry : orbits(id)) {
    const auto path = with_exact_parameters<P>(*entry, [&](const P<double>& problem) {
      Path<StateOf<P<double>, Quad, Quad>> states;
      for (const auto& state : entry->at("states"))
        states.push_back(problem.exact(start<P>(*entry), quad(state.at("t"))));
      return states;
    });
    for (std::size_t k = 0; k < path.size(); ++k)
      EXPECT_LT(difference<P>(path[k], entry->at("variables"), entry->at("states").at(k).at("state")), tolerance)
          << entry->at("parameters") << " at " << entry->at("states").at(k).at("t");
  }
}

/// check_run() checks a run in double with every column against the states up to the time `last`.
void check_run(const json& entry, Request request, double last, double tolerance) {
  const auto& card = runs::card(request);
  runs::show_all(request);
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < entry.at("variables").size(); ++i) {
    const std::string name = entry.at("variables").at(i);
    runs::begin(request, name, static_cast<double>(quad(entry.at("start").at(i))));
    columns.push_back(1 + runs::position(card.variables, name, [](const auto& v) { return v.name; }));
  }
  for (const auto& [name, text] : entry.at("parameters").items())
    runs::set(request, name, static_cast<double>(quad(text)));
  std::vector<double> times;
  for (const auto& state : entry.at("states"))
    if (const double t = static_cast<double>(quad(state.at("t"))); t < last * (1 + 1e-9)) times.push_back(t);
  runs::at_times(request, times);
  const auto result = runs::go(request);
  ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << result.outcome.stop.detail;
  ASSERT_EQ(result.rows.size(), times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    double most = 0, size = 1;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double truth = static_cast<double>(quad(entry.at("states").at(k).at("state").at(i)));
      most = std::max(most, std::abs(result.rows[k][columns[i]] - truth));
      size = std::max(size, std::abs(truth));
    }
    EXPECT_LT(most / size, tolerance) << card.id << ' ' << entry.at("parameters") << " at " << times[k];
  }
}
constexpr double for_ever = 1e9;
void check_runs(const std::string& id, std::string_view scheme, double step, double tolerance, double last = for_ever) {
  for (const json* entry : orbits(id)) {
    Request request = request_for(id, scheme, scheme == "contact_splitting" ? "kahan_li_8" : "", step);
    if (scheme == "contact_gauss") runs::set(request, "stages", 3);
    check_run(*entry, request, last, tolerance);
  }
}

TEST(ContactReference, DampedOscillator) {
  check_closed_form<DampedOscillator>("damped_oscillator", 1e-24);
  check_integrator<DampedOscillator>("damped_oscillator", 15, 1e-22);
  check_runs("damped_oscillator", "contact_splitting", 0.05, 1e-12);
  check_runs("damped_oscillator", "contact_gauss", 0.05, 1e-10);
}
TEST(ContactReference, DrivenOscillator) {
  check_closed_form<DrivenOscillator>("driven_oscillator", 1e-24);
  check_integrator<DrivenOscillator>("driven_oscillator", 20, 1e-22);
  check_runs("driven_oscillator", "contact_splitting", 0.05, 1e-12);
  check_runs("driven_oscillator", "contact_gauss", 0.05, 1e-10);
}
TEST(ContactReference, ModulatedOscillator) {
  check_integrator<ModulatedOscillator>("modulated_oscillator", 10, 1e-22);
  check_runs("modulated_oscillator", "contact_splitting", 0.05, 1e-11);
  check_runs("modulated_oscillator", "contact_gauss", 0.025, 1e-10);
}
TEST(ContactReference, PerturbedKepler) {
  check_integrator<PerturbedKepler>("perturbed_kepler", 10, 1e-21);
  check_runs("perturbed_kepler", "contact_splitting", 0.01, 1e-10);
  check_runs("perturbed_kepler", "contact_gauss", 0.01, 1e-9, 40);
}
TEST(ContactReference, SpinOrbit) {
  // To ten revolutions: one of the orbits is chaotic, and loses ten digits over fifty.
  check_integrator<SpinOrbit>("spin_orbit", 63, 1e-20);
  check_runs("spin_orbit", "contact_splitting", std::acos(-1.0) / 20, 1e-10, 100);
  check_runs("spin_orbit", "contact_gauss", std::acos(-1.0) / 20, 1e-8, 100);
}
TEST(ContactReference, Cosmology) {
  check_integrator<CosmologicalOscillator>("cosmological_oscillator", 10, 1e-21);
  check_integrator<ScalarFieldCosmology>("scalar_field_cosmology", 10, 1e-21);
  for (const char* id : {"cosmological_oscillator", "scalar_field_cosmology"}) {
    check_runs(id, "contact_splitting", 0.02, 1e-10);
    check_runs(id, "contact_gauss", 0.02, 1e-10);
  }
}
TEST(ContactReference, VanDerPol) {
  check_integrator<VanDerPol>("van_der_pol", 5, 1e-20);
  for (const json* entry : orbits("van_der_pol")) {
    const double fast = static_cast<double>(quad(entry->at("parameters").at("epsilon")));
    check_run(*entry, request_for("van_der_pol", "runge_kutta_4", "", std::min(5e-4, 5e-3 / fast)), for_ever, 1e-10);
    check_run(*entry, request_for("van_der_pol", "contact_splitting", "kahan_li_8", std::min(0.01, 0.05 / fast)),
              for_ever, 1e-10);
  }
}

json lane_emden(const json& polytrope) {
  json entry = {{"problem", "lane_emden"},
                {"parameters", {{"n", polytrope.at("n").dump()}}},
                {"variables", {"q", "p", "s"}},
                {"start", {"1", "0", "0"}},
                {"states", json::array()}};
  for (const auto& state : polytrope.at("states"))
    entry["states"].push_back({{"t", state.at("t").dump()}, {"state", state.at("state")}});
  return entry;
}
/// From the regular start; past the zero with the plain power, where that is defined.
TEST(ContactReference, LaneEmden) {
  for (const auto& polytrope : data().at("lane_emden")) {
    const double n = polytrope.at("n");
    const bool whole = n == std::floor(n);
    const json entry = lane_emden(polytrope);
    const auto check = [&](auto&& solve, double tolerance) {
      for (const auto& state : entry.at("states"))
        EXPECT_LT(difference<LaneEmden>(solve(quad(state.at("t"))), entry.at("variables"), state.at("state")),
                  tolerance)
            << n << " at " << state.at("t");
    };
    const LaneEmden<> problem{n, whole ? AfterZero::continue_ : AfterZero::stop};
    State<1, Quad, Quad> x0;
    x0.q[0] = 1;
    Extrapolation<LaneEmden<>> integrator(problem, x0, 1e-27);
    check(
        [&](const Quad& t) {
          EXPECT_TRUE(integrator.advance(t, [] { return true; }));
          return integrator.state();
        },
        1e-22);
    if (problem.exact_applies(x0)) check([&](const Quad& t) { return problem.exact(x0, t); }, 1e-24);

    Request request = runs::defaults("lane_emden", "contact_splitting");
    runs::set(request, "composition", "kahan_li_8");
    runs::set(request, "after_zero", whole ? "continue" : "stop");
    check_run(entry, request, for_ever, 1e-11);
    request = runs::defaults("lane_emden", "contact_gauss");
    runs::set(request, "stages", 3);
    runs::set(request, "after_zero", whole ? "continue" : "stop");
    check_run(entry, request, for_ever, 1e-10);
  }
}

TEST(ContactReference, Flows) {
  check_integrator<Thermostat>("thermostat", 20, 1e-20);
  check_integrator<GenericOscillator>("generic_oscillator", 20, 1e-21);
  check_integrator<Lorenz>("lorenz", 5, 1e-19);
  check_runs("thermostat", "contact_splitting", 0.01, 1e-10);
  check_runs("generic_oscillator", "contact_splitting", 0.05, 1e-12);
  check_runs("lorenz", "contact_splitting", 0.001, 1e-10);
  check_runs("generic_oscillator", "runge_kutta_4", 0.002, 1e-10);
}

}  // namespace

// Lagrangians L(q, v, s, t) without a special form: the discrete Herglotz equations, solved for them, keep the contact
// form, have their order, and agree with the compiled schemes.
#include <gtest/gtest.h>

#include "core/catalogue/sized_herglotz.hpp"
#include "core/state_error.hpp"
#include "core/text/scene.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/steps_of_text.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace texts;

constexpr auto lagrangian = Definition::Kind::lagrangian;

struct General {
  const char* name;
  Definition definition;
};
std::vector<General> generals() {
  return {{"timed", of(lagrangian, {"q"}, {{"k", 1}},
                       "v^2/2 + v^4/12 + 0.3*cos(t)*q*v - (k + 0.2*sin(t))*q^2/2 - 0.1*s - 0.05*s^2")},
          {"plane", of(lagrangian, {"x", "y"}, {{"k", 2}},
                       "(vx^2 + vy^2)/2 + (vx^2 + vx*vy + vy^2)^2/20 + 0.2*x*vy - (x^2 + k*y^2)/2 - x^2*y/3"
                       " - 0.1*s - 0.05*s*x + 0.02*s*vy")},
          {"relativistic", of(lagrangian, {"q"}, {}, "-sqrt(1 - v^2) - q^2/2")}};
}

/// request_of() requests a run from a start of the test's own to t = 2.
Request request_of(const std::shared_ptr<const Mechanics>& mechanics, const char* scheme, double fineness,
                   const char* dial = "step") {
  Request request = typed_as(runs::defaults("damped_oscillator", scheme), mechanics);
  auto& initial = runs::scene(request).initial;
  const auto& variables = mechanics->card().variables;
  for (std::size_t i = 0; i < variables.size(); ++i)
    initial[i] = variables[i].hidden ? 0 : 0.5 - 0.15 * double(i % 8) + (i >= 8 ? 0.1 : 0);
  request.end = 2;
  runs::set(request, dial, fineness);
  runs::only_final(request);
  return request;
}
std::vector<double> end_of(const Request& request) {
  const auto outcome = runs::go(request).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << outcome.stop.detail;
  return outcome.final;
}
TEST(GeneralLagrangian, KeepsTheFormOfItsScene) {
  for (const General& general : generals()) {
    const auto mechanics = mechanics_of(general.definition);
    ASSERT_EQ(mechanics->text()->form->kind, text::FormKind::lagrangian);
    const bool acts = mechanics->text()->form->reads_action;
    const auto defect = [&](const char* scheme, const char* composition = nullptr) {
      Request request = request_of(mechanics, scheme, 0.1);
      if (composition) runs::set(request, "composition", composition);
      runs::ask(request, "structure");
      const auto outcome = runs::go(request).outcome;
      EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << outcome.stop.detail;
      const auto& parts = std::get<std::vector<Report>>(outcome.diagnostics.front().value);
      const auto* kind = std::get_if<std::string>(&parts.front().value);
      if (std::string_view(scheme) != "runge_kutta_4") {
        EXPECT_EQ(*kind, acts ? "contact" : "symplectic") << general.name << " " << scheme;
      }
      return runs::number(outcome.diagnostics, "structure/max_defect");
    };
    EXPECT_LT(defect("contact_variational_midpoint"), 1e-12) << general.name;
    EXPECT_LT(defect("contact_variational_midpoint", "kahan_li_6"), 1e-12) << general.name;
    EXPECT_LT(defect("contact_galerkin_4"), 1e-12) << general.name;
    EXPECT_GT(defect("runge_kutta_4"), 1e-8) << general.name;
  }
}

TEST(GeneralLagrangian, HasTheOrderOfTheScheme) {
  for (const General& general : generals()) {
    const auto mechanics = mechanics_of(general.definition);
    Request reference = request_of(mechanics, "contact_gauss", 0.005);
    runs::set(reference, "stages", 3);
    const auto truth = end_of(reference);
    for (const auto& [scheme, order] : {std::pair{"contact_variational_midpoint", 2}, {"contact_galerkin_4", 4}}) {
      const double coarse = order == 2 ? 0.02 : 0.1;
      std::vector<double> errors;
      for (const double step : {coarse, coarse / 2, coarse / 4})
        errors.push_back(distance(end_of(request_of(mechanics, scheme, step)), truth));
      ASSERT_GT(errors.back(), 1e-11) << general.name << " " << scheme << ": above round-off";
      for (std::size_t i = 0; i + 1 < errors.size(); ++i)
        EXPECT_NEAR(std::log2(errors[i] / errors[i + 1]), order, 0.1) << general.name << " " << scheme;
    }
    Request composed = request_of(mechanics, "contact_variational_midpoint", 0.1);
    runs::set(composed, "composition", "kahan_li_6");
    EXPECT_LT(distance(end_of(composed), truth), 1e-6) << general.name;
  }
}

TEST(GeneralLagrangian, MidpointReturnsByANegativeStep) {
  for (const General& general : generals()) {
    const auto mechanics = mechanics_of(general.definition);
    const Request request = request_of(mechanics, "contact_variational_midpoint", 0.1);
    const auto scene = mechanics->text()->sized(request.scene->parameters);
    const std::vector<double> start = request.scene->initial;
    std::vector<double> x = start;
    SizedHerglotz<double> stepper(*scene, SizedPath::straight, Composition::none);
    ASSERT_EQ(stepper.step(x.data(), 0.3, 0.1), StepStatus::ok);
    EXPECT_GT(distance(x, start), 0.01) << general.name;
    ASSERT_EQ(stepper.step(x.data(), 0.4, -0.1), StepStatus::ok);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], start[i], 1e-14) << general.name << " " << i;
  }
}

/// SaidTwice is a problem of the catalogue, written with a term that has a factor of zero, so that no form is found in
/// it.
struct SaidTwice {
  Typed typed;
  std::vector<std::pair<const char*, const char*>> schemes;  ///< of the compiled problem, of the text
};
std::vector<SaidTwice> said_twice() {
  const double pi = 3.141592653589793;
  return {
      {{"damped_oscillator",
        of(lagrangian, {"q"}, {{"k", 1}, {"alpha", 0.1}, {"z", 0}}, "v^2/2 - k*q^2/2 - alpha*s + z*v^4")},
       {{"contact_variational_midpoint", "contact_variational_midpoint"},
        {"contact_galerkin_4", "contact_galerkin_4"}}},
      {{"perturbed_kepler", of(lagrangian, {"x", "y"}, {{"gamma", -1}, {"alpha", 0.01}, {"omega", pi}, {"z", 0}},
                               "(vx^2 + vy^2)/2 - gamma/sqrt(x^2 + y^2) - alpha*sin(omega*t)*s + z*vx^2*vy^2")},
       {{"contact_variational_midpoint", "contact_variational_midpoint"},
        {"contact_galerkin_4", "contact_galerkin_4"}}},
      {{"cosmological_oscillator",
        of(lagrangian, {"q"}, {{"gamma", 1}, {"r", 1}, {"z", 0}}, "v^2/2 - q^2/2 - gamma*s^2/2 + r + z*v^4")},
       {{"contact_variational_midpoint", "contact_variational_midpoint"},
        {"contact_galerkin_4", "contact_galerkin_4"}}},
      {{"double_pendulum",
        of(lagrangian, {"theta1", "theta2"}, {{"m1", 1}, {"m2", 1}, {"l1", 1}, {"l2", 1}, {"g", 1}, {"z", 0}},
           "(m1 + m2)*l1^2*vtheta1^2/2 + m2*l2^2*vtheta2^2/2 + m2*l1*l2*cos(theta1 - theta2)*vtheta1*vtheta2"
           " + (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2) + z*vtheta1^4 + z*vtheta2^4")},
       {{"variational_midpoint", "contact_variational_midpoint"}, {"galerkin_4", "contact_galerkin_4"}}},
  };
}

TEST(GeneralLagrangian, AgreesWithTheCompiledSchemes) {
  for (const auto& [typed, schemes] : said_twice()) {
    const auto mechanics = mechanics_of(typed.definition);
    ASSERT_EQ(mechanics->text()->form->kind, text::FormKind::lagrangian) << typed.id;
    for (const auto& [of_compiled, of_text] : schemes) {
      Request compiled = runs::defaults(typed.id, of_compiled);
      compiled.end = compiled.scene->start + 5;
      compiled.record = {Record::Mode::every, 1, {}};
      Request general = typed_as(compiled, mechanics);
      general.scheme = find_scheme(of_text).value();
      general.settings.resize(least::schemes()[general.scheme].parameters.size());
      for (Request* request : {&compiled, &general})
        request->columns = {runs::position(runs::card(*request).columns, "discrete_energy",
                                           [](const auto& column) { return column.name; })};
      const auto [a, energies] = runs::go(compiled);
      const auto [b, energies_of_text] = runs::go(general);
      ASSERT_EQ(b.stop.reason, ReturnCode::completed) << typed.id << " " << of_text << " " << b.stop.detail;
      EXPECT_EQ(a.cost.steps, b.cost.steps);
      EXPECT_NEAR(energies.back()[0], energies_of_text.back()[0], 1e-11) << typed.id << " " << of_text;
      std::size_t next = 0;
      for (std::size_t i = 0; i < b.final.size(); ++i) {
        if (mechanics->card().variables[i].hidden) continue;
        const double expected = a.final[next++];
        if (std::isnan(expected)) continue;  // an s that the compiled run does not carry
        EXPECT_NEAR(b.final[i], expected, 1e-12 * std::max(1.0, std::abs(expected)))
            << typed.id << " " << of_text << " " << mechanics->card().variables[i].name;
      }
    }
  }
}

/// Series of (q, p, s) and of the velocities, for which the tape has additional equations.
TEST(GeneralLagrangian, HasATaylorSeries) {
  auto all = generals();
  all.push_back({"exchanged", of(lagrangian, {"x", "y"}, {}, "vx*(vy + vy^3/3) - x*y - 0.1*s")});
  for (const General& general : all) {
    const auto mechanics = mechanics_of(general.definition);
    const Request request = request_of(mechanics, "taylor", 1e-14, "tolerance");
    const auto start = request.scene->initial;
    const auto truth = mechanics->truth(*request.scene, {1, request.end}, [] { return true; });
    ASSERT_TRUE(truth.complete) << general.name;
    EXPECT_EQ(truth.how, "quad precision run");
    EXPECT_LT(truth.uncertainty, 1.2e-16) << general.name;
    EXPECT_GT(distance(truth.states.back(), start), 0.1) << general.name << ": it moves";
    const auto end = end_of(request), by_a_pair = end_of(request_of(mechanics, "fehlberg_78", 1e-14, "tolerance"));
    for (std::size_t i = 0; i < start.size(); ++i) {
      const double size = std::max(1.0, std::abs(end[i]));
      EXPECT_NEAR(end[i], truth.states.back()[i], 2e-14 * size) << general.name << " " << i;
      EXPECT_NEAR(by_a_pair[i], truth.states.back()[i], 1e-12 * size) << general.name << " " << i;
    }
  }
}

TEST(GeneralLagrangian, HasTheSeriesOfTheCompiledScheme) {
  for (const auto& row : said_twice()) {
    const Typed& typed = row.typed;
    Request compiled = runs::defaults(typed.id, "taylor");
    compiled.end = compiled.scene->start + 5;
    compiled.record = {Record::Mode::samples, 11, {}};
    Request general = typed_as(compiled, mechanics_of(typed.definition));
    for (Request* request : {&compiled, &general}) {
      request->columns.clear();
      for (const auto& name : typed.definition.variables)
        request->columns.push_back(
            runs::position(runs::card(*request).columns, name, [](const auto& column) { return column.name; }));
    }
    const auto [a, states] = runs::go(compiled);
    const auto [b, states_of_text] = runs::go(general);
    ASSERT_EQ(b.stop.reason, ReturnCode::completed) << typed.id << " " << b.stop.detail;
    ASSERT_EQ(states.size(), states_of_text.size());
    for (std::size_t k = 0; k < states.size(); ++k)
      for (std::size_t i = 0; i < states[k].size(); ++i)
        EXPECT_NEAR(states_of_text[k][i], states[k][i], 1e-10) << typed.id << " " << k;
  }
}

/// n relativistic oscillators that do not interact.
std::shared_ptr<const Mechanics> oscillators(int n) {
  text::TypedScene typed;
  typed.scene = of(lagrangian, {"q[n]"}, {{"n", double(n)}}, "-sum(i=1..n, sqrt(1 - v[i]^2)) - sum(i=1..n, q[i]^2/2)");
  return sized::made(typed);
}

TEST(GeneralLagrangian, OfManyEachMovesAsItDoesAlone) {
  const auto place = [](int i) { return 1 + 0.5 * std::sin(2.3 * i * i); };
  const auto momentum = [](int i) { return 0.8 * std::cos(3.0 * i); };
  const auto one = oscillators(1);
  for (const auto& [scheme, n] : {std::pair{"runge_kutta_4", 200},
                                  {"explicit_midpoint", 200},
                                  {"contact_gauss", 20},
                                  {"contact_variational_midpoint", 20},
                                  {"contact_galerkin_4", 20}}) {
    std::vector<double> start;
    for (int i = 0; i < n; ++i) start.push_back(place(i));
    for (int i = 0; i < n; ++i) start.push_back(momentum(i));
    const auto all = end_of(sized::stepped(scheme, oscillators(n), start, 2, 0.1));
    EXPECT_GT(sized::distance(all, start), 0.5) << scheme;
    for (int i = 0; i < n; ++i) {
      const auto alone = end_of(sized::stepped(scheme, one, {place(i), momentum(i)}, 2, 0.1));
      EXPECT_NEAR(all[std::size_t(i)], alone[0], 1e-13) << scheme << i;
      EXPECT_NEAR(all[std::size_t(n + i)], alone[1], 1e-13) << scheme << i;
    }
  }
  // √(1 + p²) + q²/2 is conserved.
  const auto end = end_of(sized::request_by("taylor", oscillators(50), std::vector<double>(100, 0.9), 20));
  for (std::size_t i = 0; i < 50; ++i)
    EXPECT_NEAR(std::hypot(1.0, end[50 + i]) + end[i] * end[i] / 2, std::hypot(1.0, 0.9) + 0.405, 1e-12) << i;
}

TEST(GeneralLagrangian, CouplesSomeVelocitiesOnly) {
  const auto coupled = [](int n) {
    text::TypedScene typed;
    typed.scene = of(lagrangian, {"q[n]"}, {{"n", double(n)}},
                     "sum(i=1..n, v[i]^2/2 + v[i]^4/4 - q[i]^2/2) + sum(i=1..n-1, v[i]*v[i+1])/4");
    return custom_mechanics(typed);
  };
  EXPECT_TRUE(std::holds_alternative<std::shared_ptr<const Mechanics>>(coupled(24)));
  const auto refused = coupled(25);
  const auto* const faults = std::get_if<std::vector<text::DefinitionFault>>(&refused);
  ASSERT_NE(faults, nullptr);
  EXPECT_EQ(faults->front().pointer, "/lagrangian");
  EXPECT_EQ(faults->front().fault.detail, "couples the velocities of too many coordinates");
}

/// Where ∂²L/∂v² vanishes there is no acceleration: a start there is refused, but not one near it.
TEST(GeneralLagrangian, StartsWhereItIsRegular) {
  struct Case {
    const char *text, *why;
    double momentum;
  };
  constexpr auto none = "", singular = "is not regular at the start: its second derivative by the velocities has no";
  for (const auto& [text, why, p] :
       {Case{"v^4/4 - q^2", singular, 0}, Case{"v^4/4 - q^2", none, 0.1}, Case{"v^4/4 + 1e-5*v^2 - q^2", none, 0},
        Case{"v^3/3 - q^2", singular, 0}, Case{"exp(v) - v - q^2", none, 0}, Case{"cosh(1e5*v) - q^2", none, 0},
        Case{"-1e-6*sqrt(1 - (1000*v)^2) - 1e-6*q^2", none, 0}, Case{"-sqrt(1 - v^2) - q^2", none, 50}}) {
    const auto mechanics = mechanics_of(of(lagrangian, {"q"}, {}, text));
    const auto half = static_cast<std::size_t>(mechanics->text()->capacity);
    std::vector<double> start(2 * half + 1, 0.0);
    start[0] = 1;
    start[half] = p;
    const auto objection = mechanics->text()->objection_to_start({}, 0, start);
    EXPECT_EQ(objection.has_value(), *why != 0) << text << ' ' << p;
    EXPECT_NE((objection ? objection->detail : "").find(why), std::string::npos) << text << ' ' << p;
  }
}

/// A chain of many pendulums has masses as regular as one of two.
TEST(GeneralLagrangian, IsRegularOfManyCoordinates) {
  const auto objection = [](const std::string& text) {
    std::vector<std::string> names;
    for (int i = 1; i <= 12; ++i) names.push_back(std::string("a").append(std::to_string(i)));
    const auto mechanics = mechanics_of(of(lagrangian, names, {}, text));
    const auto half = static_cast<std::size_t>(mechanics->text()->capacity);
    std::vector<double> start(2 * half, 0.0);
    for (std::size_t i = 0; i < 12; ++i) start[i] = 0.1 * double(i % 3);
    const auto found = mechanics->text()->objection_to_start({}, 0, start);
    return found ? found->detail : "";
  };
  std::string kinetic, together;
  for (int i = 1; i <= 12; ++i) {
    const std::string a = "a" + std::to_string(i);
    for (int j = 1; j <= 12; ++j) {
      const std::string b = "a" + std::to_string(j);
      kinetic += "+" + std::to_string(13 - std::max(i, j)) + "*v" + a + "*v" + b + "*cos(" + a + "-" + b + ")/2";
    }
    together += (i == 1 ? "" : "+") + std::string("v") + a;
  }
  EXPECT_EQ(objection(kinetic.substr(1) + "+cos(a1)"), "");
  EXPECT_NE(objection("(" + together + ")^2*(2+cos(a1))/2").find("not regular at the start"), std::string::npos);
}

}  // namespace

// Sums of many terms that stay sums on the tape: their values, in every number type, against the sums written out.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <variant>

#include "core/text/sized_scene.hpp"
#include "core/text/written_out.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/sized.hpp"

namespace kept_sums {
namespace {

using namespace texts;
using text::Form;
using text::SizedScene;
using text::TypedScene;
using Kind = Definition::Kind;

TypedScene typed(Kind kind, std::vector<std::string> variables, std::string formula) {
  TypedScene made;
  made.scene.kind = kind;
  made.scene.variables = std::move(variables);
  made.scene.formula = std::move(formula);
  made.scene.parameters = {{"n", 24}, {"g", 0.7}};
  std::vector<double> m;
  for (int i = 0; i < 24; ++i) m.push_back(0.5 + 0.1 * i);
  made.lists = {{"m", m}};
  return made;
}

struct Row {
  const char* name;
  TypedScene scene;
};
/// rows() returns scenes with sums of terms alike and not alike: nested, by definitions, with conditions, with
/// constants of their own, with the time, and in equations.
std::vector<Row> rows() {
  const std::string apart = "((x[i]-x[j])^2 + (y[i]-y[j])^2 + 0.1)";
  const auto plane = [](Kind kind, const std::string& formula) { return typed(kind, {"x[n]", "y[n]"}, formula); };
  Row defined{"defined", plane(Kind::potential, "4*sum(i=1..n, j=i+1..n, u(i, j)) + sum(i=1..n, x[i]^2 + y[i]^2)/2")};
  defined.scene.definitions = {{"r2(i, j)", apart}, {"u(i, j)", "1/r2(i, j)^6 - 1/r2(i, j)^3"}};
  Row masses{"masses", plane(Kind::potential, "-g*sum(i=1..n, sum(j=i+1..n, m[i]*m[j]/sqrt" + apart + "))")};
  masses.scene.scene.masses = {{"x", "m"}, {"y", "m"}};
  Row damped{"damped", plane(Kind::potential, "sum(i=1..n, j=1..n, if(i != j, m[j]*exp(-" + apart + "), g))")};
  damped.scene.scene.damping = "0.1";
  Row flow{"flow", typed(Kind::equations, {"th[100]", "z"}, "")};
  flow.scene.scene.equations = {{"th[i]", "g + z*sum(j=1..100, sin(th[j] - th[i] + t))/100"},
                                {"z", "sum(i=1..100, cos(th[i]))/100 - z"}};
  return {std::move(defined),
          std::move(masses),
          std::move(damped),
          std::move(flow),
          {"numbers", plane(Kind::potential, "sum(i=1..n, j=i+1..n, cos(x[i]-x[j]+i-2*j)/(j-i+x[i]^2+y[j]^2))")},
          {"powers", plane(Kind::potential, "sum(i=2..3, sum(j=1..n, k=1..n, (x[j]-y[k])^i/i))")},
          {"driven", plane(Kind::potential, "cos(t)*sum(i=1..n, j=1..n, if(i < j, abs(x[i]-y[j])^3, 0))")},
          {"lagrangian", plane(Kind::lagrangian,
                               "sum(i=1..n, m[i]*(vx[i]^2+vy[i]^2))/2 - "
                               "sum(i=1..n, j=i+1..n, m[i]/m[j]*" +
                                   apart + "^1.3)")},
          {"hamiltonian", plane(Kind::hamiltonian,
                                "sum(i=1..n, px[i]^2+py[i]^2)/2 + "
                                "sum(i=1..n, j=i+1..n, m[i]*log" +
                                    apart + ")")}};
}

std::shared_ptr<const Form> form_of(const TypedScene& scene) {
  auto written = text::WrittenOut::of(scene);
  auto form = text::form_of(std::get<text::WrittenOut>(written).definition());
  return std::get<std::shared_ptr<const Form>>(form);
}
std::vector<double> parameters_of(const TypedScene& scene) {
  std::vector<double> all;
  auto written = text::WrittenOut::of(scene);
  for (const auto& parameter : std::get<text::WrittenOut>(written).definition().parameters)
    all.push_back(parameter.second);
  return all;
}
std::vector<double> state(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<double> x(size);
  for (double& one : x) one = place(random);
  return x;
}
template <class Formula, class T, class S>
std::vector<T> values(const Formula& formula, const std::vector<T>& x, const S& t) {
  std::vector<T> out(formula.outputs());
  formula.evaluate(x.data(), t, out.data());
  return out;
}
void expect_near(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  double largest = 1;
  for (const double y : b) largest = std::max(largest, std::abs(y));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-14 * largest) << what << ' ' << i;
}

TEST(KeptSums, AreWorthWhatTheyAreWrittenOut) {
  for (const Row& row : rows()) {
    const auto kept = form_of(row.scene), plain = text::with_sums_written_out(kept);
    ASSERT_TRUE(kept->tape.has_terms()) << row.name;
    ASSERT_FALSE(plain->tape.has_terms()) << row.name;
    const std::vector<double> parameters = parameters_of(row.scene);
    const SizedScene one(*kept, parameters), other(*plain, parameters);
    ASSERT_TRUE(one.equations.has_terms()) << row.name;
    EXPECT_LT(one.equations.size(), other.equations.size() / 2) << row.name;
    for (const unsigned seed : {1, 2, 3}) {
      const auto x = state(one.components, seed);
      expect_near(values(one.rate, x, 0.3), values(other.rate, x, 0.3), row.name);
      for (const auto part : {&SizedScene::potential, &SizedScene::gradient})
        expect_near(values(one.*part, x, 0.3), values(other.*part, x, 0.3), std::string(row.name) + ", a part");
      expect_near(values(one.hamiltonian, x, 0.3), values(other.hamiltonian, x, 0.3), row.name);
    }
  }
}

// Derivatives along a direction, which implicit schemes and tangents need, and which derivatives vanish for every
// state.
TEST(KeptSums, HaveTheDerivativesOfWhatIsWrittenOut) {
  using Slope = Dual<double, 1>;
  for (const Row& row : rows()) {
    const auto kept = form_of(row.scene);
    const std::vector<double> parameters = parameters_of(row.scene);
    const SizedScene one(*kept, parameters), other(*text::with_sums_written_out(kept), parameters);
    const auto x = state(one.components, 4), u = state(one.components, 5);
    std::vector<Slope> moved;
    for (std::size_t i = 0; i < x.size(); ++i) moved.push_back({x[i], {u[i]}});
    std::vector<double> slopes, expected;
    for (const Slope& y : values(one.rate, moved, Slope(0.3))) slopes.push_back(y.slope[0]);
    for (const Slope& y : values(other.rate, moved, Slope(0.3))) expected.push_back(y.slope[0]);
    expect_near(slopes, expected, row.name);
    if (one.flow) {
      const tape::SparseJacobian a(one.equations, one.rates, one.components),
          b(other.equations, other.rates, other.components);
      EXPECT_EQ(a.pattern(), b.pattern()) << row.name;
    } else if (one.gradient.outputs() > 0) {
      EXPECT_EQ(one.curvature().pattern(), other.curvature().pattern()) << row.name;
    }
    EXPECT_EQ(one.plain()->rates.size(), other.rates.size()) << row.name;
  }
}

std::string fault_of(TypedScene scene) {
  const auto from = std::chrono::steady_clock::now();
  const auto made = custom_mechanics(std::move(scene));
  EXPECT_LT(std::chrono::steady_clock::now() - from, std::chrono::seconds(2));
  const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made);
  if (!faults) return "none";
  return faults->front().pointer + " " + std::to_string(faults->front().fault.position) + ": " +
         faults->front().fault.detail;
}

TEST(KeptSums, SayWhatIsWrongInTheirTerms) {
  const auto scene = [](const std::string& term, const char* bounds = "sum(i=1..n, j=i+1..n, ") {
    return typed(Kind::potential, {"x[n]"}, bounds + term + ")");
  };
  EXPECT_EQ(fault_of(scene("x[i]*k*x[j]")), "/potential 27: nobody knows the name k");
  EXPECT_EQ(fault_of(scene("x[i]*vx[j]")), "/potential 27: vx[2] is a velocity, on which this cannot depend");
  EXPECT_EQ(fault_of(scene("x[i]*x[j+1]")), "/potential 27: x[25] is beyond the list, for i = 1, j = 24");
  EXPECT_EQ(fault_of(scene("x[i]*(x[j]")), "/potential 3: ( is never closed");
  EXPECT_EQ(fault_of(scene("if(i == 3, k, x[i]*x[j])")), "/potential 0: nobody knows the name k")
      << "of a term that is not the first";
  EXPECT_EQ(fault_of(scene("x[1]", "sum(i=1..1000000000, ")),
            "/potential 0: takes too many operations when it is written out");
  TypedScene many = scene("((x[i]-x[j])^2 + sin(x[i]*x[j])^2 + exp(x[i]*x[j]) + cos(x[j]-x[i])/(x[i]^2 + 1))^3");
  many.scene.parameters[0].second = 512;
  many.lists.clear();
  EXPECT_EQ(fault_of(many), "/potential 0: takes too many operations");
}

// Five hundred bodies in the plane, whose terms would be a million operations, move as by a loop over pairs.
TEST(KeptSums, MoveFiveHundredBodies) {
  constexpr std::size_t n = 500;
  constexpr double h = 1.0 / 64;
  TypedScene many = typed(Kind::potential, {"x[n]", "y[n]"},
                          "-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + 0.01))/n");
  many.scene.parameters[0].second = n;
  many.lists.clear();
  const auto mechanics = sized::made(many);
  bodies::State x(n, 2);
  const auto result = runs::go(sized::stepped("leapfrog", mechanics, x.together(), 4 * h, h));
  ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  bodies::leapfrog(x, h, 4);
  EXPECT_LT(sized::distance(result.outcome.final, x.together()), 1e-12);
  for (const std::size_t scheme : mechanics->card().schemes)
    EXPECT_NE(schemes()[scheme].id, "taylor") << "whose series are made of the operations of all terms";
}

}  // namespace
}  // namespace kept_sums

// Texts with many variables of a kind: what they become when they are written out, and their faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <variant>

#include "core/catalogue/custom.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/sized.hpp"

namespace many_of_a_kind {
namespace {

using namespace texts;
using text::Expansion;
using text::Vocabulary;

Vocabulary words() {
  Vocabulary made;
  made.lists = {{"x", 4}, {"m", 4}};
  made.constants = {{"n", 4}, {"k", 2}};
  made.definitions = {{"r", {}, "sqrt(x[1]^2+x[2]^2)"},
                      {"d", {"i", "j"}, "(x[i]-x[j])"},
                      {"w", {"i"}, "sum(j=1..n, if(i != j, m[j]/d(i,j), 0))"}};
  return made;
}
std::string written(std::string_view text) {
  const auto made = Expansion::of(text, words());
  if (const auto* wrong = std::get_if<Expansion::Wrong>(&made)) return "wrong: " + wrong->fault.detail;
  return std::get<Expansion>(made).text();
}

// A condition is resolved as one of indices only where it contains an index, not where a parameter happens to be a
// whole number.
TEST(ManyOfAKind, ConditionsOnParametersStay) {
  for (const char* text : {"if(n>0.5, 1, 2)", "if(n > 3, 1, 2)", "if(0.5<1, 1, 2)", "if(2*n >= k and not k<1, 1, 2)"})
    EXPECT_EQ(written(text), text);
  EXPECT_EQ(written("sum(i=1..2, if(i>1.5, m[i], 0))"), "(( if(1>1.5, m[1], 0))+( if(2>1.5, m[2], 0)))");
  EXPECT_EQ(written("if(n == 4, 1, 2)"), "( 1)") << "whole numbers alone are compared like that";
  EXPECT_EQ(written("if(mod(n, 2) < 1, 1, 2)"), "( 1)");
  Vocabulary sized = words();
  sized.fixed = {"n"};
  const auto made = Expansion::of("if(n > 4, x[5], x[4])", sized);
  ASSERT_TRUE(std::holds_alternative<Expansion>(made)) << "a size is settled, and what is not taken is not read";
  EXPECT_EQ(std::get<Expansion>(made).text(), "( x[4])");
}

TEST(ManyOfAKind, AreWrittenOut) {
  EXPECT_EQ(written("1.5e3*x[2] - y_1^2 + 2e-4"), "1.5e3*x[2] - y_1^2 + 2e-4");
  EXPECT_EQ(written("sum(i=1..3, m[i])"), "(( m[1])+( m[2])+( m[3]))");
  EXPECT_EQ(written("prod(i = k .. n-1, x[ n - i ])"), "(( x[2])*( x[1]))");
  EXPECT_EQ(written("sum(i=1..k,j=i+1..k+1,i*j)"), "((1*2)+(1*3)+(2*3))");
  EXPECT_EQ(written("sum(i=2..1,x[i])*prod(i=2..1,x[i])"), "(0)*(1)");
  EXPECT_EQ(written("x[mod(n,n)+1]+x[mod(-1, n)+1]"), "x[1]+x[4]");
  EXPECT_EQ(written("sum(i=-1..0,i^2)"), "(((-1)^2)+(0^2))");
  EXPECT_EQ(written("r+d(1,n)"), "(sqrt(x[1]^2+x[2]^2))+((x[1]-x[4]))");
  EXPECT_EQ(written("if(k<n and not (k==1 or n<=3),x[1],x[2])"), "(x[1])");
  EXPECT_EQ(written("if(x[k]<1 and k<n,x[k],1)"), "if(x[2]<1 and k<n,x[2],1)") << "of the state it stays";
  EXPECT_EQ(written("if(x[2]<1, x[2], 1)"), "if(x[2]<1, x[2], 1)") << "what was written stays as it is";
  const auto nested = Expansion::of("w(k)", words());
  EXPECT_EQ(std::get<Expansion>(nested).text(),
            "((( ( m[1]/((x[2]-x[1]))))+( ( 0))+( ( m[3]/((x[2]-x[3]))))+( ( m[4]/((x[2]-x[4]))))))")
      << "of i = 2 the term of itself is left out";
}

TEST(ManyOfAKind, SayWhatIsWrongAndForWhichIndex) {
  const struct {
    const char* text;
    std::size_t position;
    const char* says;
  } rows[] = {{"1+sum(i=1..n, x[i+1])", 14, "x[5] is beyond the list, for i = 4"},
              {"x[0]", 0, "x[0] is beyond"},
              {"y[1]", 0, "y is no list"},
              {"x[y]", 2, "y is no index and no whole constant"},
              {"x[1", 1, "[ is never closed"},
              {"x[1+]", 4, "ends where an index is due"},
              {"x[1.5]", 3, "is no part of an index"},
              {"sum(i=1..n x[i])", 4, "is no range of an index"},
              {"sum(x[1])", 4, "is no range of an index"},
              {"sum(i=1..n, x[i]", 3, "( is never closed"},
              {"d(1)", 0, "d takes 2 indices"},
              {"d(1,2,3)", 0, "d takes 2 indices"},
              {"d", 0, "d is a definition with indices"},
              {"if(k == 1 and 1, 1, 2)", 15, "compares nothing"},
              {"if(1 < 2, 1)", 0, "if takes a condition and two formulas"},
              {"x[mod(1, 0)]", 10, "mod needs a number above 0"},
              {"sum(i=1..1000000000, x[1])", 0, "takes too many operations"},
              {"sum(i=1..99999, j=1..99999, k=1..0, 1)", 0, "takes too many operations"},
              {"x[99999999999999999999]", 2, "larger than an index may be"}};
  for (const auto& row : rows) {
    const auto from = std::chrono::steady_clock::now();
    const auto made = Expansion::of(row.text, words());
    const auto* wrong = std::get_if<Expansion::Wrong>(&made);
    ASSERT_TRUE(wrong) << row.text;
    EXPECT_NE(wrong->fault.detail.find(row.says), std::string::npos) << row.text << ": " << wrong->fault.detail;
    EXPECT_EQ(wrong->fault.position, row.position) << row.text;
    EXPECT_LT(std::chrono::steady_clock::now() - from, std::chrono::milliseconds(500)) << row.text;
  }
}

// A definition may use only those before it, so that none can contain itself.
TEST(ManyOfAKind, DefinitionsThatGrowEndSoon) {
  Vocabulary made;
  made.definitions.push_back({"a0", {}, "x+x"});
  for (int i = 1; i < 60; ++i) {
    const std::string before = "a" + std::to_string(i - 1);
    made.definitions.push_back({"a" + std::to_string(i), {}, before + "*" + before});
  }
  const auto grown = Expansion::of("a59", made);
  ASSERT_TRUE(std::holds_alternative<Expansion::Wrong>(grown));
  EXPECT_NE(std::get<Expansion::Wrong>(grown).fault.detail.find("too many operations"), std::string::npos);
  made.definitions = {{"b", {}, "b+c"}, {"c", {}, "b"}};
  const auto own = Expansion::of("c", made);
  EXPECT_EQ(std::get<Expansion>(own).text(), "((b+c))") << "names that nobody knows yet";
}

text::TypedScene chain() {
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[n]"}, {{"n", 4}, {"alpha", 0.25}},
                   "sum(i=0..n, stretch(i)^2/2 + alpha*stretch(i)^3/3)");
  typed.definitions = {{"at(i)", "if(i == 0, 0, x[i])"}, {"stretch(i)", "if(i < n, at(i+1), 0) - at(i)"}};
  typed.scene.masses = {{"x", "m"}};
  typed.lists = {{"m", {1, 2, 1, 2}}};
  return typed;
}

// A chain of Fermi, Pasta, Ulam and Tsingou has the same bits as one in which every spring was typed.
TEST(ManyOfAKind, MoveAsThoseThatWereTypedOneByOne) {
  const auto made = custom_mechanics(chain());
  ASSERT_TRUE(std::holds_alternative<std::shared_ptr<const Mechanics>>(made))
      << std::get<std::vector<text::DefinitionFault>>(made)[0].fault.detail;
  Definition each = of(Definition::Kind::potential, {"a", "b", "c", "d"}, {{"alpha", 0.25}},
                       "(a)^2/2 + alpha*a^3/3 + (b-a)^2/2 + alpha*(b-a)^3/3 + (c-b)^2/2 + alpha*(c-b)^3/3 + "
                       "(d-c)^2/2 + alpha*(d-c)^3/3 + (0-d)^2/2 + alpha*(0-d)^3/3");
  each.masses = {{"b", "2"}, {"d", "2"}};
  const auto run = [](std::shared_ptr<const Mechanics> mechanics, const char* first) {
    Request request = typed_as(runs::defaults("harmonic_oscillator", "leapfrog"), std::move(mechanics));
    runs::begin(request, first, 0.7);
    runs::only_final(request);
    request.end = 10;
    return runs::go(request).outcome.final;
  };
  const auto many = run(std::get<std::shared_ptr<const Mechanics>>(made), "x[1]"), one = run(mechanics_of(each), "a");
  ASSERT_EQ(many.size(), one.size());
  for (std::size_t i = 0; i < many.size(); ++i) EXPECT_NEAR(many[i], one[i], 1e-13) << i;
  EXPECT_GT(std::abs(many[3]), 1e-3) << "the last one moves";
}

// A cluster of a hundred bodies in space, whose pairs are 4,950 terms, moves as by a loop over pairs.
TEST(ManyOfAKind, AHundredBodiesMoveAsALoopOverPairsSays) {
  constexpr std::size_t n = 100;
  constexpr double h = 1.0 / 256;
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[n]", "y[n]", "z[n]"}, {{"n", n}},
                   "-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + (z[i]-z[j])^2 + 0.01))/n");
  const auto mechanics = sized::made(typed);
  bodies::State x(n, 3);
  const auto result = runs::go(sized::stepped("leapfrog", mechanics, x.together(), 16 * h, h));
  ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  bodies::leapfrog(x, h, 16);
  EXPECT_LT(sized::distance(result.outcome.final, x.together()), 1e-12);
  const auto is_taylor = [](std::size_t scheme) { return schemes()[scheme].id == "taylor"; };
  EXPECT_TRUE(std::ranges::any_of(mechanics->card().schemes, is_taylor)) << "for which the pairs are written out";
}

TEST(ManyOfAKind, WholeConstantsOfBoundsAreNoParameters) {
  const auto made = std::get<std::shared_ptr<const Mechanics>>(custom_mechanics(chain()));
  std::vector<std::string> names;
  for (const auto& parameter : made->card().parameters) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"alpha", "m[1]", "m[2]", "m[3]", "m[4]"}));
}

TEST(ManyOfAKind, FaultsPointToWhatWasTyped) {
  const auto first_fault = [](text::TypedScene typed) {
    const auto made = custom_mechanics(std::move(typed));
    const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made);
    if (!faults || faults->empty()) return std::string("none");
    const auto& one = faults->front();
    return one.pointer + (one.in_text ? " " + std::to_string(one.fault.position) : "") + ": " + one.fault.detail;
  };
  text::TypedScene typed = chain();
  typed.scene.formula = "sum(i=1..n, x[i]^2 + y)";
  EXPECT_EQ(first_fault(typed), "/potential 21: nobody knows the name y");
  typed = chain();
  typed.definitions[1].second = "x[i+1]*foo";
  EXPECT_EQ(first_fault(typed).substr(0, 29), "/definitions/stretch(i) 0: x[");
  typed.definitions[1].second = "at(i)*foo";
  EXPECT_EQ(first_fault(typed), "/definitions/stretch(i) 6: nobody knows the name foo");
  typed = chain();
  typed.scene.variables = {"x[n]", "y[1025]"};
  EXPECT_EQ(first_fault(typed).substr(0, 12), "/variables/1");
  typed = chain();
  typed.lists = {{"m", {1, 2, 1}}};
  EXPECT_EQ(first_fault(typed), "/masses/x: is a list of another length");
  typed = chain();
  typed.definitions.push_back({"x", "1"});
  EXPECT_EQ(first_fault(typed),
            "/definitions/x: x is something else already, a variable: it cannot be a definition, too");
}

TEST(ManyOfAKind, IsNotWrittenOutForMoreVariablesThanThereMayBe) {
  text::TypedScene typed;
  typed.scene.formula = "sum(i=1..1000, j=1..1000, a[i]*b[j])";
  typed.scene.variables = {"a[1000]", "b[1000]", "c[1000]"};
  const auto made = text::WrittenOut::of(typed);
  const auto* written = std::get_if<text::WrittenOut>(&made);
  ASSERT_TRUE(written);
  EXPECT_EQ(written->definition().variables.size(), text::most_coordinates + 1u);
  EXPECT_EQ(written->definition().formula, "");
  const auto refused = custom_mechanics(typed);
  const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&refused);
  ASSERT_TRUE(faults);
  ASSERT_EQ(faults->size(), 1u);
  EXPECT_EQ(faults->front().pointer + ": " + faults->front().fault.detail, "/variables: names too many variables");
}

TEST(ManyOfAKind, EquationsStandForEachOfThem) {
  text::TypedScene typed;
  typed.scene = flow({"x[3]", "v[3]"}, {}, {{"x[i]", "v[i]"}, {"v[i]", "-i*x[i]"}});
  const auto made = std::get<std::shared_ptr<const Mechanics>>(custom_mechanics(typed));
  Request request = typed_as(runs::defaults("van_der_pol", "taylor"), made);
  for (const char* name : {"x[1]", "x[2]", "x[3]"}) runs::begin(request, name, 1);
  runs::only_final(request);
  request.end = 2;
  const auto last = runs::go(request).outcome.final;
  for (int i = 1; i <= 3; ++i) EXPECT_NEAR(last[std::size_t(i - 1)], std::cos(2 * std::sqrt(i)), 1e-11) << i;
}

TEST(Formulas, HaveTwoWritingsOfPowersAndLogarithms) {
  const auto value = [](const char* text) { return text::constant_of(text).value_or(NAN); };
  EXPECT_EQ(value("-2**2"), -4);
  EXPECT_EQ(value("2**3**2"), 512);
  EXPECT_EQ(value("ln(exp(2))"), 2);
  EXPECT_EQ(value("4*pi^2"), 4 * M_PI * M_PI);
  EXPECT_FALSE(text::constant_of("x"));
  EXPECT_FALSE(text::constant_of("1/0"));
}

}  // namespace
}  // namespace many_of_a_kind

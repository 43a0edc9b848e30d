// taylor: the Taylor series of the motion itself, from the equations of motion that a problem states, recorded as a
// tape (core/tape). Of any order, so that a step is as long as the series converges well: a third of the way to the
// nearest singularity, in complex time, at twelve digits. Sets its own clock, reads the time, keeps no structure:
// energy drifts at a rate that the tolerance sets. What a state carries beyond the motion, an action or a tangent
// direction, has no say in the steps: asking for more never changes a run. Where the series of what is carried, such as
// an action of twice the frequency, is not accurate for all of a step, it is begun anew within the step, beside that of
// the motion. A step costs one pass over the tape per order; by convention it counts as many force evaluations as its
// order. The state within a step is the polynomial itself. Sums over steps are compensated. Velocities of a Lagrangian
// that is not quadratic in them have series of their own within a step, and are found anew from the momenta where it
// begins. The tape is recorded when a run begins, with the parameters of the problem as numbers, so that choices, whole
// exponents and zero terms make it shorter. Recording takes a few microseconds, so a thread keeps the expansions of the
// last two runs of a type of problem for runs with the same parameters. One interpreter runs all tapes, so a problem
// costs nothing but its recording to compile. Sources: Jorba & Zou, Experimental Mathematics 14, 99 (2005); Corliss &
// Chang, ACM Trans. Math. Softw. 8, 114 (1982); Biscani & Izzo, MNRAS 504, 2614 (2021).
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>
#include <tuple>

#include "core/problem_traits.hpp"
#include "core/scheme.hpp"
#include "core/schemes/expansion.hpp"
#include "core/tape/series.hpp"
#include "core/tape/steep.hpp"
#include "core/tape/symbol.hpp"

namespace least {

namespace taylor {

/// States whose numbers are doubles, plain or with one tangent direction.
template <class X>
concept Flat = std::is_same_v<typename X::Time, double> &&(std::is_same_v<typename X::Number, double> || Sloped<X>);
template <Flat X>
inline constexpr std::size_t components = Sloped<X> ? 2 * X::size : X::size;

/// The i-th component: values, then slopes.
template <class X>
constexpr auto& component(X& x, std::size_t i) {
  if constexpr (requires { x[0].slope; }) {
    return i < X::size ? x[i].value : x[i - X::size].slope[0];
  } else {
    return x[i];
  }
}

/// Writes the equations of motion of a problem, for states like X, on a tape. Returns the nodes of the rates, in the
/// order of `component`.
template <class X, VectorField P>
constexpr std::array<tape::Index, components<X>> write_equations(const P& problem, tape::Tape& tape) {
  std::array<tape::Index, components<X>> rates;
  using Number = std::conditional_t<Sloped<X>, Dual<Symbol, 1>, Symbol>;
  typename X::template in<Number, Symbol> x;
  for (std::size_t i = 0; i < components<X>; ++i) component(x, i) = Symbol::variable(tape, i);
  x.t = Symbol::time(tape);
  auto rate = derivative(problem, x);
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = component(rate, i).on(tape);
  return rates;
}
/// The numbers of a state without tangent direction.
template <class X>
auto values_of(const X& x) {
  std::array<typename X::Number, X::size> y;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i];
  return y;
}
template <class X, VectorField P>
tape::Program record(const P& problem) {
  tape::Tape tape;
  const auto rates = write_equations<X>(problem, tape);
  return program_of(tape, rates, StateOf<P>::size);
}

template <class X, VectorField P>
std::shared_ptr<Expansion> expand(const P& problem, tape::Program program, double tolerance, int order) {
  auto made = std::make_shared<Expansion>(std::move(program), tolerance, order);
  if constexpr (ConstantDamping<P>) made->limit(problem.damping());  // at which s decays, even where (q, p) is at rest
  return made;
}
/// Returns the expansion for the steps of a run. The thread keeps those of its last two runs of this type of problem:
/// one with the same parameters, tolerance and order is shared; of one with other tolerance or order, the program is
/// copied.
template <class X, VectorField P>
std::shared_ptr<Expansion> expansion_of(const P& problem, double tolerance, int order) {
  if constexpr (std::is_trivially_copyable_v<P>) {
    struct Left {
      P problem;
      double tolerance;
      int order;
      std::shared_ptr<Expansion> expansion;
    };
    thread_local std::array<Left, 2> all;  // runs side by side, as on the page; some 16 kB each
    thread_local std::size_t oldest = 0;
    const tape::Program* program = nullptr;
    for (const Left& left : all) {
      // Different padding only causes a miss. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
      if (!left.expansion || std::memcmp(&left.problem, &problem, sizeof(P)) != 0) continue;
      if (left.tolerance == tolerance && left.order == order) return left.expansion;
      program = &left.expansion->program();
    }
    const HeldByThread nobody(nullptr);  // it stays when its request is over
    auto made = expand<X>(problem, program ? *program : record<X>(problem), tolerance, order);
    all[oldest] = {problem, tolerance, order, made};
    oldest = (oldest + 1) % all.size();
    return made;
  } else {
    return expand<X>(problem, record<X>(problem), tolerance, order);
  }
}

}  // namespace taylor

struct Taylor {
  double tolerance = 1e-12;
  int order = 0;

  static constexpr std::string_view id = "taylor";
  static constexpr bool own_clock = true, on_equations = true;
  static constexpr bool remembers = true;  ///< its last step: adapts to the state
  static constexpr std::tuple fields{
      Field<Taylor>{
          "tolerance",
          "ε",
          "1",
          "what the last terms of a step may be, absolute and relative alike; where a motion starts below 1e-3, "
          "the absolute part is relative to its start",
          &Taylor::tolerance,
          {1e-15, 1e-2}},
      Field<Taylor, int>{"order",
                         "p",
                         "1",
                         "of the polynomial; 0: the one that is the cheapest at the tolerance",
                         &Taylor::order,
                         {0, 40}}};
  static SchemeCard card() {
    return {
        .id = std::string(id),
        .title = "Taylor series",
        .summary =
            "The Taylor series of the motion, of high order, by automatic differentiation of the scene's own "
            "equations. Steps are as long as the series allows, the state within a step is its polynomial.",
        .orders = {{"", 20}},
        .structure = "none",
        .good_for =
            "many digits, relaxation and close passages: every part of the motion goes at its own pace; samples "
            "between steps are as accurate as steps and cost no force",
        .fails_when =
            "runs are so long that the drift of the energy counts, which the tolerance sets; forces are not "
            "smooth; the motion is stiff (steps end where the series does). A step counts as many force "
            "evaluations as its order",
        .needs = "equations of motion",
        .references = {"Jorba, Zou, Experimental Mathematics 14, 99 (2005)", "Biscani, Izzo, MNRAS 504, 2614 (2021)"}};
  }
};

}  // namespace least

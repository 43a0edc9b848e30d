#include <algorithm>
#include <tuple>

#include "core/schemes/taylor.hpp"
#include "core/tape/unrolled.hpp"
#include "least_problems.hpp"

// These macros request registers of four numbers; results do not depend on them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LEAST_FOURS [[gnu::target("avx2")]]
#define LEAST_HAS_FOURS __builtin_cpu_supports("avx2")
#define LEAST_MORE_FOURS [[gnu::target("avx2,avx512f,avx512vl")]]
#define LEAST_HAS_MORE_FOURS (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
#else
#define LEAST_FOURS
#define LEAST_HAS_FOURS true
#define LEAST_MORE_FOURS
#define LEAST_HAS_MORE_FOURS false
#endif

namespace least::tape {
namespace {

/// ParameterValues are parameters for which series are unrolled: the defaults, for which a zero removes terms and an
/// integer exponent becomes products; or generic numbers in place of all.
enum class ParameterValues { defaults, general };

template <template <class> class P, ParameterValues values>
constexpr P<double> problem_of() {
  P<double> problem;
  const auto change = [](auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>)
      if (values == ParameterValues::general) value = 1.0625 * value + (value == 0 ? 0.0625 : 0);
  };
  std::apply([&](const auto&... field) { (change(problem.*field.member), ...); }, About<P>::fields);
  return problem;
}
template <template <class> class P, ParameterValues values, bool full>
constexpr Program program_of() {
  using Plain = StateOf<P<double>>;
  Tape tape;
  const auto rates =
      taylor::write_equations<std::conditional_t<full, FullStateOf<P<double>>, Plain>>(problem_of<P, values>(), tape);
  return lowered(tape, rates, Plain::size);
}
template <template <class> class P, ParameterValues values, bool full>
constexpr Measured size_of_structure = measured(program_of<P, values, full>());
template <template <class> class P, ParameterValues values, bool full>
constexpr auto program_structure = shrunk<size_of_structure<P, values, full>>();
/// structure is the program of the full state or of the components that move. If the motion needs all, both are one:
/// the compiler takes a quarter of a second for each.
template <template <class> class P, ParameterValues values, bool full>
constexpr auto& structure =
    program_structure<P, values, full && !std::is_same_v<FullStateOf<P<double>>, StateOf<P<double>>>>;

template <const auto& S>
LEAST_FOURS void expand(const Program& program, const Workspace& of) {
  Unrolled<S>::expand(program, of);
}
template <const auto& S>
LEAST_FOURS void begin(const Program& program, double* values) {
  Unrolled<S>::begin(program, values);
}

/// The same for programs with more sums than sixteen registers hold, on processors with thirty-two.
template <const auto& S>
LEAST_MORE_FOURS void expand_in_more(const Program& program, const Workspace& of) {
  Unrolled<S>::expand(program, of);
}
template <const auto& S>
UnrolledSeries unrolled() {
  constexpr std::size_t many = 12;
  UnrolledSeries made{&Unrolled<S>::fits, &expand<S>, &begin<S>};
  if constexpr (S.low.size() >= many)
    if (LEAST_HAS_MORE_FOURS) made.expand = &expand_in_more<S>;
  return made;
}

template <const auto& A, const auto& B>
constexpr bool alike = std::ranges::equal(A.structure, B.structure);

/// all_of returns all different programs of a problem.
template <template <class> class P>
std::vector<UnrolledSeries> all_of() {
  constexpr auto &a = structure<P, ParameterValues::defaults, false>,
                 &b = structure<P, ParameterValues::defaults, true>;
  constexpr auto &c = structure<P, ParameterValues::general, false>, &d = structure<P, ParameterValues::general, true>;
  std::vector<UnrolledSeries> all{unrolled<a>()};
  if constexpr (!alike<a, b>) all.push_back(unrolled<b>());
  if constexpr (!alike<a, c>) {
    all.push_back(unrolled<c>());
    if constexpr (!alike<c, d>) all.push_back(unrolled<d>());
  }
  return all;
}

}  // namespace

std::span<const UnrolledSeries> unrolled_series() {
  static const std::vector<UnrolledSeries> all = [] {
    std::vector<UnrolledSeries> made;
    if (!LEAST_HAS_FOURS) return made;
#ifndef LEAST_READ_SERIES  // sanitized builds interpret all series, since unrolled ones are the same code many times
#define LEAST_SERIES(id, Class) \
  for (const UnrolledSeries& one : all_of<problems::Class>()) made.push_back(one);
    LEAST_FOR_EACH_PROBLEM(LEAST_SERIES)
#undef LEAST_SERIES
#endif
    return made;
  }();
  return all;
}

}  // namespace least::tape

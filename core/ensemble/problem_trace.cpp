#include "core/ensemble/step_tracer.hpp"
#include "core/from_values.hpp"
#include "core/parameters.hpp"
#include "least_problems.hpp"

namespace least {
namespace {

/// problem_on returns the problem with its parameters as numbers of the trace.
template <template <class> class P>
P<Traced> problem_on(StepTrace& made, const Scene& scene, std::span<const std::size_t> varied) {
  auto problem = parameters::in<Traced>(from_values<P<double>>(About<P>::fields, scene.parameters));
  const auto& cards = scene.card().parameters;
  made.parameters.assign(varied.size(), -1);
  parameters::for_each_number<P>([&](const Field<P<double>>& field) {
    const auto place = std::ranges::find(cards, field.name, &ParameterCard::name) - cards.begin();
    const auto found = std::ranges::find(varied, static_cast<std::size_t>(place));
    if (found == varied.end()) return;
    parameters::with_member(problem, field, [&](Traced& member) {
      member = Traced::unfolded(made.trace, member.constant());
      made.parameters[static_cast<std::size_t>(found - varied.begin())] = member.on(made.trace);
    });
  });
  return problem;
}

template <template <class> class P>
bool trace(const Request& request, std::span<const std::size_t> varied, std::optional<std::size_t> scheme, bool full,
           StepTrace& made) {
  using Problem = P<double>;
  const Scene& scene = *request.scene;
  if constexpr (HasSeries<Problem>)  // the first steps are those of the series
    if (scene.start >= 0 && scene.start <= Problem::series_until) return false;
  if (full && !std::is_same_v<FullRunState<Problem>, FullStateOf<Problem>>) return false;
  std::size_t capacity = 0;
  if constexpr (!Flow<Problem>) capacity = Problem::dof;
  const auto problem = problem_on<P>(made, scene, varied);
  // A parameter that is a choice cannot vary as a number
  if (std::ranges::find(made.parameters, -1) != made.parameters.end()) return false;
  StepTracer<P<Traced>> tracer(request, problem, capacity, full, made);
  bool good = !scheme;
  if (scheme) with_lane_scheme(*scheme, request.settings, [&](const auto& s) { good = tracer.trace_steps(s, s.step); });
  return good;
}

}  // namespace

std::optional<StepTrace> trace_problem(const Request& request, std::span<const std::size_t> varied,
                                       std::optional<std::size_t> scheme, bool full) {
  std::optional<StepTrace> made(std::in_place);
  bool good = false;
#define LEAST_TRACED_PROBLEM(name, Class) \
  if (request.scene->card().id == #name) good = trace<problems::Class>(request, varied, scheme, full, *made);
  LEAST_FOR_EACH_PROBLEM(LEAST_TRACED_PROBLEM)
#undef LEAST_TRACED_PROBLEM
  if (!good) made.reset();
  return made;
}

}  // namespace least

// The two endpoints agree: beyond the longest stable step of a pair that /v1/stability gives, a run stops or grows.
#include <cmath>
#include <cstdio>

#include "tests/study/studies.hpp"

namespace {

using namespace studies;

/// wrong() says how a run of 2,000 steps, or over the default span, goes wrong, by its status and its own samples;
/// empty where it does not. It measures this without the study's code.
std::string wrong(const Request& scene, const SchemeConfig& scheme, double step) {
  const auto known = conditioning(scene, always);
  Request request = with(scene, scheme);
  runs::set(request, "step", step);
  const double span = request.end - scene.scene->start;
  const bool follows = known->ends || known->size > 2.5 * known->size_halfway;  // nothing is known beyond the span
  request.until_steps = !follows;
  request.steps = std::max<std::int64_t>(static_cast<std::int64_t>(std::min(std::ceil(span / step), 1e5)), 2000);
  if (known->ends) request.end = known->reached;
  const bool energy = runs::card(request).keeps_energy;
  if (energy) request.columns.push_back(runs::position(runs::card(request).columns, "energy", &ColumnCard::name));
  const auto result = runs::go(request);
  const ReturnCode reason = result.outcome.stop.reason;
  for (const Warning& warning : result.outcome.warnings)
    if (warning.code == "damping_sign" || warning.code == "grows_at_every_step") return std::string(warning.code);
  if (reason != ReturnCode::completed && reason != ReturnCode::left_domain) return std::string(name(reason));
  double sizes[2] = {0, 0}, low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  const double middle = (result.rows.front()[0] + result.rows.back()[0]) / 2;
  for (const auto& row : result.rows) {
    const int half = row[0] > middle ? 1 : 0;
    for (std::size_t i = 1; i <= known->variables; ++i) sizes[half] = std::max(sizes[half], std::abs(row[i]));
    if (energy) low[half] = std::min(low[half], row.back()), high[half] = std::max(high[half], row.back());
  }
  const double first = energy ? (high[0] - low[0]) / known->energy : sizes[0] / known->size,
               second = energy ? (high[1] - low[1]) / known->energy : sizes[1] / known->size;
  const double spans = (result.outcome.t - scene.scene->start) / span;
  const double travels = known->travels() ? std::max(spans, 1.0) : 1;
  if (std::max(sizes[0], sizes[1]) > 1000 * known->size * travels) return "runs away";
  const double twice = !energy && known->travels()  // a rotating angle doubles with time
                           ? 2 * std::max(spans, known->size_halfway / known->size) /
                                 std::max(spans / 2, known->size_halfway / known->size)
                           : 2;
  if (second > twice * first && second > 1e-3) return "grows";
  return {};
}

class Agreement : public testing::TestWithParam<std::size_t> {};

TEST_P(Agreement, OfStabilityAndRuns) {
  const ProblemCard& problem = runs::problem_cards()[GetParam()];
  const Request origin = scene(problem.id);
  int limits = 0, waived = 0;
  for (const std::size_t index : problem.schemes) {
    const SchemeCard& card = schemes()[index];
    if (card.own_clock || !card.find("step")) continue;
    const StabilityLimit found = longest_stable_step_of(origin, choice(origin, card.id), never);
    if (std::isnan(found.step)) continue;
    SCOPED_TRACE(std::string(problem.id) + ' ' + std::string(card.id) + ' ' + std::to_string(found.step));
    ++limits;
    if (found.step == 0) {
      EXPECT_EQ(found.theory, 0);
      continue;
    }
    EXPECT_EQ(wrong(origin, found.scheme, 0.98 * found.step), "");
    const double longer = 1.05 * found.step;
    if (!wrong(origin, found.scheme, longer).empty()) continue;
    // Steps beyond the limit may be stable again: then the run at the limit itself has to go wrong.
    const std::string at_limit = wrong(origin, found.scheme, found.failing);
    EXPECT_FALSE(at_limit.empty());
    EXPECT_LT(found.failing, 1.001 * found.step);
    std::printf("%s %s: stable again at %.6g, beyond %.6g, where it %s\n", problem.id.c_str(), card.id.c_str(), longer,
                found.failing, at_limit.c_str());
    ++waived;
  }
  std::printf("%s: %d limits, %d with steps beyond that are stable again\n", problem.id.c_str(), limits, waived);
  // Two splittings and Euler's steps for the thermostat, and five of nine schemes for perturbed_kepler: near their
  // limits, resonances that lie closer than a twentieth decide.
  EXPECT_LE(2 * waived, limits + 2);
}
INSTANTIATE_TEST_SUITE_P(Stability, Agreement, testing::Range<std::size_t>(0, problem_list().size()),
                         [](const auto& test) { return std::string(runs::problem_cards()[test.param].id); });

}  // namespace

// Random scenes under random schemes at coarse settings, drawn from the whole catalogue (the k-th is always the same),
// and checks whether the warnings of their runs are right.
#pragma once

#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "core/state_error.hpp"
#include "tests/support/runs.hpp"

namespace coarse {

using least::Request;

class Draw {
 public:
  explicit Draw(std::uint64_t k) : bits_(k * 0x9e3779b97f4a7c15U + 1) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform(0, static_cast<double>(n))); }

 private:
  std::mt19937_64 bits_;
};

/// watched() makes the request record its motion at 65 times, with a control run and limits.
inline Request watched(Request request) {
  const double start = runs::scene(request).start;
  std::vector<double> times;
  constexpr int looks = 64;
  for (int j = 0; j <= looks; ++j) times.push_back(start + (request.end - start) * j / looks);
  runs::at_times(request, times);
  request.columns.clear();
  for (std::size_t i = 0; i < runs::card(request).variables.size(); ++i)
    if (!runs::card(request).variables[i].optional) request.columns.push_back(i + 1);
  request.limits = {2, 2'000'000, 1'000'000};
  request.control = true;
  return request;
}

/// request() draws the k-th request: some parameters between half and twice their default, start values up to half off,
/// a tenth to all of the span, steps up to 64 times as long as the catalogue suggests.
inline Request request(std::uint64_t k) {
  Draw draw(k);
  const auto& cards = runs::problem_cards();
  const least::ProblemCard& problem = cards[draw.below(cards.size())];
  Request request =
      runs::defaults(problem.id, least::schemes()[problem.schemes[draw.below(problem.schemes.size())]].id);
  least::Scene& scene = runs::scene(request);
  for (std::size_t i = 0; i < scene.parameters.size(); ++i) {
    const least::ParameterCard& card = problem.parameters[i];
    if (card.kind == least::Kind::choice) scene.parameters[i] = static_cast<double>(draw.below(card.choices.size()));
    const double varied = scene.parameters[i] * std::exp2(draw.uniform(-1, 1));
    if (card.kind == least::Kind::number && draw.below(2) == 0 && card.range.contains(varied))
      scene.parameters[i] = varied;
  }
  const bool star = problem.id == "lane_emden";  // its start is the centre
  for (std::size_t i = 0; i < scene.initial.size() && !star; ++i)
    if (!problem.variables[i].optional) scene.initial[i] *= 1 + 0.5 * draw.uniform(-1, 1);
  request.end = scene.start + (request.end - scene.start) * draw.uniform(0.1, 1);
  const least::SchemeCard& scheme = least::schemes()[request.scheme];
  for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
    const least::ParameterCard& card = scheme.parameters[i];
    double& setting = request.settings[i];
    if (card.kind == least::Kind::choice && draw.below(2) == 0)
      setting = static_cast<double>(draw.below(card.choices.size()));
    if (card.kind == least::Kind::integer) setting = std::floor(draw.uniform(card.range.low, card.range.high + 1));
    if (card.name == "tolerance") setting = std::pow(10, draw.uniform(-7, -1));
    if (card.suggested == "step" || card.suggested == "theta" || card.suggested == "sigma")
      setting = std::min(setting * std::exp2(draw.uniform(0, 6)), card.range.high);
  }
  if (scheme.conflicts && !scheme.conflicts(request.settings, problem).empty())
    request.settings = runs::defaults(problem.id, scheme.id).settings;
  return watched(std::move(request));
}

struct Verdict {
  bool known = false;  ///< two control runs agree, so that the error is known
  bool completed = false;
  double error = NAN;    ///< the largest along the run
  std::string warnings;  ///< their codes, separated by spaces
};

/// Controls holds the runs of a scene by two schemes at the tolerance 1e-13.
struct Controls {
  runs::Result truth;  ///< by Bulirsch and Stoer
  runs::Result other;  ///< by Dormand and Prince
};

/// controls_of() returns the control runs of the request's scene at its recorded times. It caches them, because many
/// schemes share a scene.
inline const Controls& controls_of(const Request& request) {
  static std::map<std::string, Controls> known;
  std::string key = runs::card(request).id;
  const auto& scene = *request.scene;
  for (const auto* numbers : {&scene.parameters, &scene.initial, &request.record.times})
    key.append(reinterpret_cast<const char*>(numbers->data()), numbers->size() * sizeof(double));
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  const auto run = [&](std::string_view scheme) {
    Request control = runs::defaults(runs::card(request).id, scheme);
    control.scene = request.scene;
    control.columns = request.columns;
    control.limits = request.limits;
    runs::at_times(control, request.record.times);
    runs::set(control, "tolerance", 1e-13);
    return runs::go(control);
  };
  constexpr std::size_t most = 16;
  if (known.size() == most) known.clear();
  return known.emplace(key, Controls{run("bulirsch_stoer"), run("dormand_prince_5")}).first->second;
}

/// judge() measures the error of a run against the first control; it is known where the other control agrees within
/// 1e-3.
inline Verdict judge(const Request& request) {
  Verdict verdict;
  const auto largest = [](const runs::Result& a, const runs::Result& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.rows.size() && i < b.rows.size(); ++i)
      most = std::max(most, least::state_error(a.rows[i], b.rows[i], b.rows[i].size()));
    return most;
  };
  const auto own = runs::go(request);
  for (const auto& warning : own.outcome.warnings)
    verdict.warnings += (verdict.warnings.empty() ? "" : " ") + std::string(warning.code);
  verdict.completed = own.outcome.stop.reason == least::ReturnCode::completed;
  const auto& [truth, other] = controls_of(request);
  verdict.known = truth.rows.size() == other.rows.size() && largest(other, truth) < 1e-3 &&
                  truth.rows.size() >= own.rows.size() && !own.rows.empty();
  verdict.error = largest(own, truth);
  return verdict;
}

struct Count {
  int runs = 0, completed = 0, wrong = 0, silent = 0, right = 0, alarmed = 0;
  std::map<std::string, int> by_scheme;  ///< the number of `silent` runs of each scheme
};

/// sample() judges the first `count` requests. It prints runs that are wrong without a warning, or right with one, to
/// the standard error.
inline Count sample(std::uint64_t count) {
  Count all;
  for (std::uint64_t k = 0; k < count; ++k) {
    const Request drawn = request(k);
    const Verdict verdict = judge(drawn);
    if (!verdict.known) continue;
    ++all.runs;
    if (!verdict.completed) continue;
    ++all.completed;
    const bool wrong = !(verdict.error <= 0.3), right = verdict.error < 0.01, warned = !verdict.warnings.empty();
    all.wrong += wrong;
    all.silent += wrong && !warned;
    all.right += right;
    all.alarmed += right && warned;
    if ((wrong && !warned) || (right && warned))
      std::fprintf(stderr, "%s %d: %s %s, %g: error %.2g, %s\n", wrong ? "silent" : "alarm", static_cast<int>(k),
                   runs::card(drawn).id.c_str(), least::schemes()[drawn.scheme].id.c_str(), drawn.settings[0],
                   verdict.error, verdict.warnings.c_str());
  }
  return all;
}

}  // namespace coarse

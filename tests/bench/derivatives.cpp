// The cost of derivatives of a motion: runs with sensitivities against the same runs without.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/variations/varied_run.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;
using variations::Quantity;
using variations::SensitivitiesAsked;

const std::atomic<bool> never{false};

/// bare() requests a run by `taylor` that keeps only its final state.
Request bare(std::string_view problem, double until) {
  Request request = runs::defaults(problem, "taylor");
  request.end = until;
  request.columns = {0};
  request.limits = {1e9, 1'000'000'000, 1'000'000};
  runs::only_final(request);
  return request;
}
Request typed(std::string_view id, const Request& request) {
  static const std::vector<texts::Typed> all = texts::all();
  const auto known = std::ranges::find(all, id, [](const texts::Typed& one) { return std::string_view(one.id); });
  return texts::typed_as(request, texts::mechanics_of(known->definition));
}

std::shared_ptr<const SensitivitiesAsked> asked_by(const Request& request, std::vector<Quantity> by) {
  auto asked = std::make_shared<SensitivitiesAsked>();
  asked->by = std::move(by);
  asked->names.resize(asked->by.size());
  const std::vector<bool> varied = varied_parameters(*asked, request.scene->card().parameters.size());
  asked->equations = std::get<std::shared_ptr<const variations::ParametricScene>>(
      variations::parametric_scene(*request.scene, varied));
  return asked;
}

/// shortest() returns the seconds that each function takes: the shortest mean of several time windows. The windows are
/// equally long and take turns, so that other work on the machine disturbs all functions alike.
std::vector<double> shortest(const std::vector<std::function<void()>>& all) {
  constexpr double window = 2e-3;
  constexpr int windows = 60;
  std::vector<double> best(all.size(), std::numeric_limits<double>::infinity());
  for (int i = 0; i < windows; ++i)
    for (std::size_t one = 0; one < all.size(); ++one) {
      const bench::Stopwatch watch;
      int count = 0;
      do {
        all[one]();
        ++count;
      } while (watch.seconds() < window);
      best[one] = std::min(best[one], watch.seconds() / count);
    }
  return best;
}

struct Case {
  std::string title;
  Request request;
  std::vector<Quantity> by;
};
std::vector<Case> cases() {
  const auto start = [](std::size_t i) { return Quantity{Quantity::Kind::variable, i}; };
  const auto parameter = [](std::size_t i) { return Quantity{Quantity::Kind::parameter, i}; };
  const Request kepler = bare("kepler", 100), lorenz = bare("lorenz", 20), pendulum = bare("double_pendulum", 20);
  return {{"`kepler`", kepler, {start(0), start(1), start(2), start(3), parameter(0)}},
          {"`kepler` as text", typed("kepler", kepler), {start(0), start(1), start(2), start(3), parameter(0)}},
          {"`lorenz`", lorenz, {start(0), start(1), start(2), parameter(0), parameter(1), parameter(2)}},
          {"`double_pendulum`",
           pendulum,
           {start(0), start(1), start(2), start(3), parameter(0), parameter(1), parameter(2), parameter(3)}}};
}

}  // namespace

void bench::derivatives() {
  heading("Derivatives of motions");
  std::printf(
      "What a run by `taylor` takes together with the derivatives of its end by the first n numbers of its start and\n"
      "its parameters, in runs without derivatives, with the control that `uncertainty` comes from. The shortest\n"
      "of several repetitions that take turns. The goal is 1 + 1.2 n.\n\n"
      "| scene | run, µs | n = 1 | 2 | 4 | 8, or all there are |\n|---|---|---|---|---|---|\n");
  for (const Case& one : cases()) {
    if (!is_wanted(one.title)) continue;
    const Progress progress(one.title);
    std::vector<std::function<void()>> all{[&one] {
      Samples none;
      one.request.scene->mechanics->run(one.request, none, never);
    }};
    std::vector<std::size_t> counts;
    for (const std::size_t n : {1, 2, 4, 8}) {
      counts.push_back(std::min(n, one.by.size()));
      all.emplace_back(
          [&one, asked = asked_by(one.request,
                                  {one.by.begin(), one.by.begin() + static_cast<std::ptrdiff_t>(counts.back())})] {
            Samples none;
            variations::VariedRun varied(one.request, asked);
            const Solution outcome = varied.go(none, never);
            if (varied.sensitivities(outcome, never).final.empty()) std::printf(" not found");
          });
    }
    const std::vector<double> took = shortest(all);
    std::printf("| %s | %.1f |", one.title.c_str(), 1e6 * took[0]);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double runs = took[i + 1] / took[0];
      std::printf(" %.1f%s |", runs, runs <= 1 + 1.2 * static_cast<double>(counts[i]) ? "" : ", over");
    }
    std::printf("\n");
  }
}

#include "core/study/pilot.hpp"

#include <algorithm>

#include "core/study/error_study.hpp"

namespace least {

Pilot Pilot::run(const Request& scene, std::span<const SchemeConfig> candidates, double accuracy, double seconds,
                 const std::atomic<bool>& cancelled) {
  const auto cards = scene.scene->mechanics->schemes();
  Request request = scene;
  request.record = {Record::Mode::every, 0, {}};
  request.columns.clear();
  request.measures = {};
  request.diagnostics.clear();
  request.control = false;
  request.probe = true;
  if (std::ranges::none_of(request.events, &EventAsked::stop)) {
    request.watched = {};
    request.events.clear();
    request.section.reset();
  }
  constexpr double finer = 30;  // the error of a motion is a few tolerances of its steps
  Pilot best;
  const Deadline deadline(seconds);
  for (const std::string_view id : {"taylor", "dormand_prince_5"}) {
    const auto found =
        std::ranges::find_if(candidates, [&](const SchemeConfig& one) { return cards[one.scheme].id == id; });
    if (found == candidates.end()) continue;
    const SchemeConfig choice = ResolutionParameter(cards[found->scheme]).at(*found, accuracy / finer);
    request.scheme = choice.scheme;
    request.settings = choice.settings;
    request.limits.seconds = std::max(deadline.left(), 0.0);
    Samples none;
    const Solution outcome = scene.scene->mechanics->run(request, none, cancelled);
    if (best.choice && !(outcome.t > best.end)) continue;
    best = {choice, outcome.t, outcome.event, outcome.stop.reason == ReturnCode::completed, outcome.cost.seconds, {}};
    if (best.completed) break;
  }
  for (const SchemeConfig& one : candidates)
    if (best.choice && cards[one.scheme].id == "fehlberg_78") best.others.push_back(one);
  return best;
}

}  // namespace least

// Scenes and schemes for the tests of studies.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "core/study/error_study.hpp"
#include "tests/support/runs.hpp"

namespace studies {

using namespace least;

inline const std::atomic<bool> never{false};
inline bool always() { return true; }
inline auto truth(const Request& request, const std::vector<double>& times, const KeepGoing& keep_going) {
  return least::truth(*request.scene, times, keep_going);
}
inline auto conditioning(const Request& request, const KeepGoing& keep_going) {
  return least::conditioning(*request.scene, request.end, keep_going);
}
inline std::string name(const SchemeConfig& choice) { return least::name(schemes()[choice.scheme], choice); }
inline ResolutionParameter dial_of(const SchemeConfig& choice) { return ResolutionParameter(schemes()[choice.scheme]); }
inline bool watch(std::size_t, const StudyCurve&) { return true; }

/// scene() returns a problem's default scene, to the time `end` where that is not 0. Its scheme is only a placeholder.
inline Request scene(std::string_view problem, double end = 0) {
  const std::size_t first = runs::problem_card(problem).schemes.front();
  Request request = runs::defaults(problem, schemes()[first].id);
  if (end > 0) request.end = end;
  return request;
}

/// choice() returns a scheme with the settings that the catalogue suggests for the scene's problem.
inline SchemeConfig choice(const Request& scene, std::string_view scheme, std::string_view composition = "") {
  Request request = runs::defaults(scene.scene->card().id, scheme);
  if (!composition.empty()) runs::set(request, "composition", composition);
  return {request.scheme, request.settings};
}

/// with() returns the scene with this scheme.
inline Request with(Request scene, const SchemeConfig& choice) {
  scene.scheme = choice.scheme;
  scene.settings = choice.settings;
  return scene;
}

}  // namespace studies

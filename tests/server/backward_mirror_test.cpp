// Runs backward in time over HTTP that mirror runs forward: defaults, and steps of schemes with a clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class BackwardMirror : public Asking {};

// Every default comes from the catalogue, in either direction: also of its problems that are given as text.
TEST_F(BackwardMirror, HasTheSameDefaults) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    for (const std::size_t place : card.schemes) {
      const std::string& scheme = schemes()[place].id;
      if (scheme == "contact_splitting" && !card.keeps_form) continue;
      Json request{{"problem", card.id}, {"scheme", scheme}, {"until", 1e-3}, {"record", {{"every", 0}}}};
      const Json forward = answer(request);
      request["until"] = -1e-3;
      const Json back = answer(request);
      EXPECT_EQ(back["scheme"], forward["scheme"]) << card.id;
    }
  }
}

// adaptive_verlet follows the same local frequency in either direction. With q(−t), −p(−t) a motion of the same scene,
// a run backward is the mirror of the run forward whose momenta have the opposite sign.
TEST_F(BackwardMirror, AdaptiveVerletIsTheMirrorOfTheRunForward) {
  std::size_t mirrored = 0;
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (std::ranges::none_of(card.schemes, [](std::size_t place) { return schemes()[place].id == "adaptive_verlet"; }))
      continue;
    for (const char* monitor : {"frequency", "arclength"}) {
      Json request{{"problem", card.id},
                   {"scheme", {{"id", "adaptive_verlet"}, {"monitor", monitor}}},
                   {"until", -card.span / 4},
                   {"record", {{"every", 0}}}};
      const Json back = answer(request);
      request["until"] = card.span / 4;
      for (const VariableCard& variable : card.variables)
        if (variable.name.starts_with('p')) request["initial"][variable.name] = -variable.value;
      const Json forward = answer(request);
      SCOPED_TRACE(card.id + " " + monitor);
      EXPECT_EQ(back["cost"]["steps"], forward["cost"]["steps"]);
      for (const auto& [name, value] : forward["final"].items()) {
        if (name.starts_with('p') || name == "t") continue;
        EXPECT_NEAR(back["final"][name], value, 1e-9 * std::max(1.0, std::abs(value.get<double>()))) << name;
      }
      ++mirrored;
    }
  }
  EXPECT_GT(mirrored, 0U);
}

}  // namespace
}  // namespace least::server::test

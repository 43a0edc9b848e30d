// A ball that bounces, for tests of events that act.
#pragma once

#include "tests/server/fixture.hpp"

namespace least::server::test {

/// ball() asks for a ball that falls from the height 1 with g = 1 and keeps the part `restitution` of its speed at each
/// bounce.
inline Json ball(double restitution) {
  return {
      {"problem", {{"id", "custom"}, {"variables", {"x"}}, {"parameters", {{"r", restitution}}}, {"potential", "x"}}},
      {"initial", {{"x", 1}}},
      {"scheme", "taylor"},
      {"until", 20},
      {"record", {{"every", 0}}},
      {"events", {{{"name", "floor"}, {"expression", "x"}, {"direction", "down"}, {"set", {{"vx", "-r*vx"}}}}}}};
}

}  // namespace least::server::test

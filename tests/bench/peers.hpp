// Solvers of other libraries on our scenes, as one would use them by hand: what ours are measured against.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/request.hpp"

namespace bench {

/// Runs from the start to the last of the increasing times; `states` receives the components of the state at each, by a
/// shorter step of its own where it lies within a step. How many force evaluations the run took, without those shorter
/// steps; 0: it gave up, or came to what is not finite.
using Solver = std::function<std::int64_t(std::span<const double> times, double* states)>;

struct Peer {
  std::string_view name;                             ///< fehlberg_78 | dormand_prince_5 | rk8pd
  std::function<Solver(double tolerance)> prepared;  ///< the tolerance of a step, absolute and relative alike
};

/// Boost.Odeint's, and GSL's where there is one. Of one name there may be several: ways to configure it. A scene that
/// starts where its equations of motion are singular begins where its series ends, which is before the first time.
std::vector<Peer> peers(const least::Request& scene);

}  // namespace bench

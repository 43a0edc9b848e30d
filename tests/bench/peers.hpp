// Solvers of other libraries on our scenes, used as one would use them by hand: ours are measured against them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/request.hpp"

namespace bench {

/// Solver runs from the start to the last of the increasing times and writes the components of the state at each time
/// to `states`; a time within a step is reached by a shorter step aside. It returns the number of force evaluations
/// without those shorter steps; 0 where it gave up or a state is not finite.
using Solver = std::function<std::int64_t(std::span<const double> times, double* states)>;

struct Peer {
  std::string_view name;                             ///< fehlberg_78 | dormand_prince_5 | rk8pd
  std::function<Solver(double tolerance)> prepared;  ///< tolerance of a step, absolute and relative alike
};

/// peers() returns the solvers of Boost.Odeint, and of GSL where it is installed. Several have the same name: they are
/// configured differently. A scene whose equations of motion are singular at its start begins where its series ends,
/// which is before the first time.
std::vector<Peer> peers(const least::Request& scene);

}  // namespace bench

#if defined(__x86_64__)
#define LEAST_LANE_BYTES 64
#include "tests/bench/peer_lanes.hpp"

double odeint_members_avx512(std::int64_t members, std::int64_t steps, double h);
double odeint_members_avx512(std::int64_t members, std::int64_t steps, double h) {
  return odeint_members(members, steps, h);
}
#endif

// An ensemble as one would write it with Boost.Odeint: its velocity_verlet on arrays of registers, eight in flight, for
// Kepler's problem.
#pragma once

#include <cstdint>

/// So many members at least, so many steps of the length h each, from about (0, -4) with (-0.1, -0.1), in registers of
/// so many bytes: 64 or 32. A number that depends on all of them.
template <int Bytes>
double odeint_members(std::int64_t members, std::int64_t steps, double h);
template <>
double odeint_members<64>(std::int64_t members, std::int64_t steps, double h);
template <>
double odeint_members<32>(std::int64_t members, std::int64_t steps, double h);

// An ensemble as one would write it with Boost.Odeint: its velocity_verlet on arrays of registers, eight registers of
// members at a time, for Kepler's problem.
#pragma once

#include <cstdint>

/// odeint_members() moves at least `members` members from about (0, -4) with momenta (-0.1, -0.1) by `steps` steps of
/// length h, in registers of 64 or 32 bytes. It returns a number that depends on all of them, so that nothing is
/// optimized away.
template <int Bytes>
double odeint_members(std::int64_t members, std::int64_t steps, double h);
template <>
double odeint_members<64>(std::int64_t members, std::int64_t steps, double h);
template <>
double odeint_members<32>(std::int64_t members, std::int64_t steps, double h);

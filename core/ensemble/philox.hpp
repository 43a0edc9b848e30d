// Philox4x32-10: random numbers as a function of a counter and a key, so that each can be computed without the previous
// ones.
// Source: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3, SC11 (2011).
#pragma once

#include <array>
#include <cstdint>

namespace least {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// philox returns four random words for the counter x.
constexpr PhiloxCounter philox(PhiloxCounter x, PhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * x[0], b = std::uint64_t{0xCD9E8D57} * x[2];
    x = {static_cast<std::uint32_t>(b >> 32U) ^ x[1] ^ key[0], static_cast<std::uint32_t>(b),
         static_cast<std::uint32_t>(a >> 32U) ^ x[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return x;
}

/// uniform returns a number in (0, 1), one of 2⁵² equidistant ones, for the k-th quantity of the i-th member.
constexpr double uniform(std::uint64_t seed, std::uint64_t i, std::uint32_t k) {
  const PhiloxCounter bits = philox({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i >> 32U), k, 0},
                                    {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)});
  const std::uint64_t all = std::uint64_t{bits[1]} << 32U | bits[0];
  return (static_cast<double>(all >> 12U) + 0.5) * 0x1p-52;
}

}  // namespace least

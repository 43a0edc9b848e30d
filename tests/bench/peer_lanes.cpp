// This file is compiled once for each instruction set, with LEAST_LANE_BYTES bytes a register. All types are local to
// the file, so that the linker does not mix up code for different instruction sets.
#include "tests/bench/peer_lanes.hpp"

#include <immintrin.h>

#include <array>
#include <boost/numeric/odeint/stepper/velocity_verlet.hpp>
#include <cstddef>
#include <utility>

namespace {

struct Wide {
  typedef double Register __attribute__((vector_size(LEAST_LANE_BYTES)));
  Register x;
  friend Wide operator*(double a, const Wide& b) { return {a * b.x}; }
  friend Wide operator+(const Wide& a, const Wide& b) { return {a.x + b.x}; }
};
inline Wide::Register root(const Wide::Register& x) {
#if LEAST_LANE_BYTES == 64
  return _mm512_sqrt_pd(x);
#else
  return _mm256_sqrt_pd(x);
#endif
}

constexpr std::size_t in_flight = 8, width = LEAST_LANE_BYTES / sizeof(double);
using Coordinates = std::array<Wide, 2 * in_flight>;

struct Attraction {
  void operator()(const Coordinates& q, const Coordinates&, Coordinates& f, double) const {
    for (std::size_t j = 0; j < q.size(); j += 2) {
      const auto &x = q[j].x, &y = q[j + 1].x, square = x * x + y * y;
      const auto inverse = -1.0 / (square * root(square));
      f[j] = {x * inverse};
      f[j + 1] = {y * inverse};
    }
  }
};

}  // namespace

template <>
double odeint_members<LEAST_LANE_BYTES>(std::int64_t members, std::int64_t steps, double h) {
  double sum = 0;
  for (std::int64_t first = 0; first < members; first += std::int64_t{in_flight * width}) {
    auto state = std::make_pair(Coordinates{}, Coordinates{});
    for (std::size_t j = 0; j < 2 * in_flight; ++j)
      for (std::size_t lane = 0; lane < width; ++lane) {
        const double share = 0.01 * static_cast<double>(lane) / static_cast<double>(width);
        state.first[j].x[lane] = j % 2 == 0 ? share : -4;
        state.second[j].x[lane] = -0.1;
      }
    boost::numeric::odeint::velocity_verlet<Coordinates, Coordinates, double> stepper;
    for (std::int64_t n = 0; n < steps; ++n) stepper.do_step(Attraction{}, state, static_cast<double>(n) * h, h);
    for (const Wide& q : state.first)
      for (std::size_t lane = 0; lane < width; ++lane) sum += q.x[lane];
  }
  return sum;
}

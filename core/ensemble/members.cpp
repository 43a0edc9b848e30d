#include "core/ensemble/members.hpp"

#include <sleef.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/ensemble/philox.hpp"

namespace least {
namespace {

template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// The C library's logarithm may differ in the last bit between instruction sets.
double log_everywhere(double x) { return Sleef_cinz_logd1_u10purec(x); }

/// numbers_of returns which of a member's random numbers each variation takes: in the order of the scene's variables,
/// velocities and parameters, so that members do not depend on the order in which the request lists variations.
std::vector<std::uint32_t> numbers_of(const std::vector<Variation>& vary) {
  std::vector<std::size_t> in_order(vary.size());
  std::iota(in_order.begin(), in_order.end(), std::size_t{0});
  std::ranges::sort(in_order, {}, [&](std::size_t k) { return std::pair(vary[k].of, vary[k].index); });
  std::vector<std::uint32_t> numbers(vary.size());
  for (std::size_t rank = 0; rank < in_order.size(); ++rank) numbers[in_order[rank]] = static_cast<std::uint32_t>(rank);
  return numbers;
}

}  // namespace

double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    constexpr std::array a{3.3871328727963666080,   1.3314166789178437745e2, 1.9715909503065514427e3,
                           1.3731693765509461125e4, 4.5921953931549871457e4, 6.7265770927008700853e4,
                           3.3430575583588128105e4, 2.5090809287301226727e3};
    constexpr std::array b{1.0,
                           4.2313330701600911252e1,
                           6.8718700749205790830e2,
                           5.3941960214247511077e3,
                           2.1213794301586595867e4,
                           3.9307895800092710610e4,
                           2.8729085735721942674e4,
                           5.2264952788528545610e3};
    return q * polynomial(a, r) / polynomial(b, r);
  }
  const double r = std::sqrt(-log_everywhere(q < 0 ? p : 1 - p));
  double x = 0;
  if (r <= 5) {
    constexpr std::array c{1.42343711074968357734,    4.63033784615654529590,   5.76949722146069140550,
                           3.64784832476320460504,    1.27045825245236838258,   2.41780725177450611770e-1,
                           2.27238449892691845833e-2, 7.74545014278341407640e-4};
    constexpr std::array d{1.0,
                           2.05319162663775882187,
                           1.67638483018380384940,
                           6.89767334985100004550e-1,
                           1.48103976427480074590e-1,
                           1.51986665636164571966e-2,
                           5.47593808499534494600e-4,
                           1.05075007164441684324e-9};
    x = polynomial(c, r - 1.6) / polynomial(d, r - 1.6);
  } else {
    constexpr std::array e{6.65790464350110377720,    5.46378491116411436990,    1.78482653991729133580,
                           2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                           2.71155556874348757815e-5, 2.01033439929228813265e-7};
    constexpr std::array f{1.0,
                           5.99832206555887937690e-1,
                           1.36929880922735805310e-1,
                           1.48753612908506148525e-2,
                           7.86869131145613259100e-4,
                           1.84631831751005468180e-5,
                           1.42151175831644588870e-7,
                           2.04426310338993978564e-15};
    x = polynomial(e, r - 5) / polynomial(f, r - 5);
  }
  return q < 0 ? -x : x;
}

double logistic_quantile(double p) { return log_everywhere(p / (1 - p)); }

std::int64_t Variation::size() const {
  return spread == Spread::grid ? static_cast<std::int64_t>(numbers[2]) : static_cast<std::int64_t>(numbers.size());
}

std::vector<double> Members::of(std::int64_t i) const {
  std::vector<double> values(vary.size());
  const std::vector<std::uint32_t> numbers = numbers_of(vary);
  std::int64_t rest = i;
  for (std::size_t k = vary.size(); k-- > 0;) {
    const Variation& v = vary[k];
    const auto& n = v.numbers;
    if (!v.drawn()) {
      const std::int64_t at = rest % v.size();
      rest /= v.size();
      if (v.spread == Spread::values) {
        values[k] = n[static_cast<std::size_t>(at)];
      } else {
        const bool last = at + 1 == v.size() && at > 0;
        values[k] = last ? n[1] : n[0] + (n[1] - n[0]) * (static_cast<double>(at) / std::max(n[2] - 1, 1.0));
      }
      continue;
    }
    const double u = uniform(seed, static_cast<std::uint64_t>(i), numbers[k]);
    if (v.spread == Spread::uniform) values[k] = n[0] + (n[1] - n[0]) * u;
    if (v.spread == Spread::normal) values[k] = n[0] + n[1] * normal_quantile(u);
    if (v.spread == Spread::logistic) values[k] = n[0] + n[1] * logistic_quantile(u);
  }
  return values;
}

}  // namespace least

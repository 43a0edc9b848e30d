#include "core/schemes/taylor.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/tape/series_rules.hpp"

namespace least::taylor {
namespace {

using tape::Index;
using tape::Program;

constexpr int most_chosen = 40;
constexpr double allowed = 1.0 / 16;  // of the tolerance the last terms: the first left out are a quarter of them
constexpr std::size_t places = 4;     // of a step at which it is held against the equations

/// What a step of the order p costs, about, in nanoseconds, of a program that is unrolled: measured where a leapfrog
/// step of Kepler's problem takes 14. Those that are read take longer, at much the same best order.
double cost(const Program& program, double p) {
  double fixed = 68;
  for (std::size_t i = 0; i < program.motion_steps; ++i) {
    const tape::Step& step = program.steps[i];
    const bool called = step.function != tape::Op::constant && step.products == 0;
    if (called || step.rule == tape::Rule::power || step.rule == tape::Rule::root) fixed += 14;
  }
  std::size_t slots = 3;  // in whole fours
  for (std::size_t i = 0; i < program.motion_lanes; ++i) slots += program.lane_a[i] == program.lane_b[i] ? 1 : 2;
  slots /= 4;
  const auto steps = static_cast<double>(program.motion_steps), fours = static_cast<double>(slots);
  return fixed + p * (4.5 + 0.3 * steps + 0.045 * fours * p);
}

/// ln n!
double log_factorial(int n) {
  static const auto all = [] {
    std::array<double, tape::Series::most_orders + 1> sums{};
    for (std::size_t k = 2; k < sums.size(); ++k) sums[k] = sums[k - 1] + std::log(static_cast<double>(k));
    return sums;
  }();
  return all[static_cast<std::size_t>(n)];
}

/// Jorba and Zou's argument with that cost: a step is ρ ε^{1/p} long where the series converges up to ρ, (ε p!)^{1/p}
/// where it converges everywhere. There its terms first grow, to eʰ, and what rounding takes from them has to stay
/// below the tolerance.
int cheapest_order(const Program& program, double tolerance) {
  // Of few terms the first are no sign yet of how far a series converges, and steps are shorter than they may be.
  const int least_chosen = program.whole ? 4 : 14;
  // What the last terms may be; where rounding comes near, longer steps of higher orders would lose digits to it.
  const double least = std::max(allowed * tolerance, std::min(tolerance, 0x1p-47));
  const double digits = -std::log(least), longest = std::log(std::max(1.5, std::log(0x1p53 * tolerance)));
  const auto length = [&](int p) { return ((program.whole ? log_factorial(p) : 0) - digits) / p; };
  const auto dear = [&](int p) { return std::log(cost(program, p)) - length(p); };
  int best = program.whole ? most_chosen : std::clamp(static_cast<int>(digits) + 2, least_chosen, most_chosen);
  while (program.whole && best > least_chosen && length(best) > longest) --best;
  double price = dear(best);
  const auto walk = [&](int by, int end) {  // it has one minimum
    while (best != end)
      if (const double next = dear(best + by); next < price) {
        price = next;
        best += by;
      } else {
        return;
      }
  };
  const int before = best;
  walk(-1, least_chosen);
  if (best == before && !program.whole) walk(1, most_chosen);
  return best;
}

constexpr std::int64_t one = std::bit_cast<std::int64_t>(1.0), mantissa = (std::int64_t{1} << 52) - 1;
/// log₂ ((a/b)^{1/k}) of numbers ≥ 0, in units of 2⁻⁵²: read off their bits, which are a logarithm to 0.09. So a k-th
/// power of what follows from it is right to 6 per cent: enough for the length of a step.
std::int64_t rough_log2_root(double a, double b, int k) {
  constexpr int shift = 62;
  static constexpr auto parts = [] {
    std::array<std::int64_t, tape::Series::most_orders + 1> all{};
    for (std::size_t i = 1; i < all.size(); ++i) all[i] = (std::int64_t{1} << shift) / static_cast<std::int64_t>(i);
    return all;
  }();
  __extension__ using Wide = __int128;
  const std::int64_t log_ratio = std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b);
  return static_cast<std::int64_t>((Wide{log_ratio} * parts[tape::at(k)]) >> shift);
}
/// 2ˣ of x in these units to 0.2 per cent, 0 where that is less than a normal number.
double rough_exp2(std::int64_t x) {
  constexpr double third = 1.0 / 3;
  const std::int64_t bits = x + one;
  if (bits <= mantissa) return 0;
  const double part = std::bit_cast<double>((bits & mantissa) | one);
  return std::bit_cast<double>(bits & ~mantissa) * ((2 + part * part) * third);
}
constexpr std::int64_t whole_log2(int n) { return std::int64_t{n} * (mantissa + 1); }

/// Components by two, wherever they stand.
typedef double Two __attribute__((vector_size(16)));
typedef double Apart __attribute__((vector_size(16), aligned(8), may_alias));
typedef std::int64_t Bits __attribute__((vector_size(16)));

constexpr Bits both{INT64_MAX, INT64_MAX}, first{INT64_MAX, 0};
/// A sum, and what rounding has kept from it.
template <class X>
struct Sum {
  X value, kept;
};
template <class X>
Sum<X> added(X from, X by, X kept) {
  const X change = by + kept, end = from + change, back = end - from;
  return {end, (from - (end - back)) + (change - back)};
}
template <class X>
X larger(const X& a, const X& b) {
  return a < b ? b : a;
}
/// The sizes of two components, of which only those of the motion have a say. Read one by one, as they have just been
/// written so: a processor would wait until it can read both at once.
Two sizes(const double* c, const Bits& kept) {
  double a = c[0], b = c[1];
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  asm("" : "+x"(a), "+x"(b));
#endif
  return std::bit_cast<Two>(std::bit_cast<Bits>(Two{a, b}) & kept);
}

bool reads_time(const Program& program) {
  const Index time = program.time();
  const auto is_time = [time](Index value) { return value == time; };
  return !program.linear.empty() ||
         std::ranges::any_of(program.steps,
                             [&](const tape::Step& s) { return s.a == time || s.b == time || s.w == time; }) ||
         std::ranges::any_of(program.values, is_time, &Program::Value::value) ||
         std::ranges::any_of(program.products, is_time, &Program::Product::a) ||
         std::ranges::any_of(program.products, is_time, &Program::Product::b) ||
         std::ranges::any_of(program.rate, is_time);
}

tape::Series series_of(Program program, double tolerance, int order) {
  const int chosen = order > 0 ? order : cheapest_order(program, tolerance);
  return {std::move(program), chosen};
}

}  // namespace

Expansion::Expansion(Program program, double tolerance, int order)
    : series_(series_of(std::move(program), tolerance, order)),
      tolerance_(tolerance),
      inverse_root_(std::pow(tolerance, -1.0 / series_.order())),
      variables_(series_.program().variables),
      moving_(series_.program().moving),
      reads_time_(reads_time(series_.program())),
      way_(places * variables_),
      slopes_(way_) {}

void Expansion::limit(double rate) {
  if (rate != 0)
    longest_ = std::exp(log_factorial(series_.order()) / series_.order()) / (inverse_root_ * std::abs(rate));
}

double Expansion::largest(int k) const {
  Two most{}, sums{};
  for (std::size_t begin = 0; begin < moving_; begin += 2) {
    const Two here = sizes(series_.coefficients(k) + begin, begin + 1 < moving_ ? both : first);
    most = most < here ? here : most;
    sums += here;
  }
  const double sum = sums[0] + sums[1];
  return sum < std::numeric_limits<double>::infinity() ? std::max(most[0], most[1]) : sum;  // NaN comes in and stays
}

double Expansion::largest_carried(int k) const {
  double most = 0;
  for (std::size_t i = moving_; i < variables_; ++i) {
    const double here = std::abs(series_.coefficients(k)[i]);
    if (!(here <= most)) most = here;
    if (std::isnan(most)) break;
  }
  return most;
}

double Expansion::carried_step() const {
  constexpr double slack = 10;  // more than of the motion: derivatives of its series by the start are somewhat larger
  double h = std::numeric_limits<double>::infinity();
  const double log_term = std::log2(slack * tolerance_ * std::max({1.0, largest(0), largest_carried(0)}));
  for (const int k : {used_ - 1, used_})
    if (const double c = k > 0 ? largest_carried(k) : 0; c > 0)
      h = std::min(h, std::exp2((log_term - std::log2(c)) / k));
  return h;
}

void Expansion::make_beside() {
  if (beside_) return;
  beside_ = std::make_unique<Expansion>(program(), tolerance_, order());
  beside_->longest_ = longest_;
}

void Expansion::move(const double* y, double t) {
  if (t == t_ && std::equal(y, y + variables_, series_.coefficients(0))) return;
  series_.expand(y, t);
  t_ = t;
  used_ = series_.order();
  last_ = largest(used_);
  if (std::isfinite(last_)) return;
  used_ = 0;  // near a singularity high orders overflow before low ones mean nothing
  last_ = 0;
  for (double next = largest(1); std::isfinite(next); next = largest(used_ + 1)) ++used_, last_ = next;
}

double Expansion::step(double most) {
  double h = used_ == 0 ? 0 : moving_ <= 2 ? series_step<1>() : moving_ <= 4 ? series_step<2>() : series_step<0>();
  h = std::min(h, most);
  if (may_hide_what_comes(h, most))
    while (h > 0 && !solves(h)) h *= 0.5;
  return h;
}

/// A force that sleeps, as t⁴⁰ or a pulse that is yet to come, leaves no trace in the series: its last terms vanish, or
/// it hardly moves, or it seems good up to the end, or as far as one likes.
bool Expansion::may_hide_what_comes(double h, double most) const {
  constexpr double little = 0.01;
  if (!reads_time_ || used_ == 0) return false;
  return series_.program().whole || !(h < most) || (last_ == 0 && (used_ == 1 || largest(used_ - 1) == 0)) ||
         largest(1) * h < little * std::max(1.0, largest(0));
}
/// Whether the polynomials solve the equations at a few places within the step, to about the tolerance.
bool Expansion::solves(double h) {
  constexpr double slack = 100, grain = 1e-12;
  const double most = std::max(1.0, largest(0)) * std::max(slack * tolerance_, grain);
  std::array<double, places> part, value, slope;
  for (std::size_t place = 0; place < places; ++place) part[place] = h * static_cast<double>(place + 1) / places;
  for (std::size_t i = 0; i < variables_; ++i) {
    value.fill(0);
    slope.fill(0);
    for (int k = used_; k >= 0; --k)
      for (std::size_t place = 0; place < places; ++place) {  // side by side, as each alone waits for itself
        slope[place] = slope[place] * part[place] + value[place];
        value[place] = value[place] * part[place] + series_.coefficients(k)[i];
      }
    for (std::size_t place = 0; place < places; ++place) {
      way_[place * variables_ + i] = value[place];
      slopes_[place * variables_ + i] = slope[place];
    }
  }
  for (std::size_t place = 0; place < places; ++place) {
    if (!series_.defined(way_.data() + place * variables_, t_ + part[place])) return false;
    for (std::size_t i = 0; i < moving_; ++i)
      if (!(std::abs(series_.rate(i) - slopes_[place * variables_ + i]) * h <= most)) return false;
  }
  return true;
}

double Expansion::heeded(double h, int from, int to, double most, double rho, double scale) const {
  for (int k = from; k >= to; --k)
    if (const double c = largest(k); c > (most *= rho))
      h = std::min(h, rough_exp2(rough_log2_root(scale, c, k)) * std::pow(tolerance_, 1.0 / used_));
  return h;
}

template <std::size_t Pairs>
double Expansion::series_step() const {
  constexpr double slack = 10;  // by how much other coefficients may exceed what the last two promise
  constexpr int looked_at = 8;
  constexpr double far = 0.5, hush = 0.01;  // of the size of the state; of what those before the last ought to be
  const std::size_t pairs = Pairs > 0 ? Pairs : (moving_ + 1) / 2;
  const Bits kept = moving_ % 2 == 0 ? both : first;
  const auto sizes_of = [&](int k, std::size_t pair) {
    return sizes(series_.coefficients(k) + 2 * pair, pair + 1 < pairs ? both : kept);
  };
  const auto size_of = [&](int k) {
    Two most = sizes_of(k, 0);
    for (std::size_t pair = 1; pair < pairs; ++pair) most = larger(most, sizes_of(k, pair));
    return larger(most[0], most[1]);
  };
  const double size = larger(1.0, size_of(0)), scale = allowed * size, term = scale * tolerance_;
  if (!(term > 0)) return 0;
  const double before = used_ > 1 ? size_of(used_ - 1) : 0;
  std::int64_t log_h = std::numeric_limits<std::int64_t>::max();
  if (last_ > 0) log_h = rough_log2_root(term, last_, used_);
  if (before > 0) log_h = std::min(log_h, rough_log2_root(term, before, used_ - 1));
  constexpr std::int64_t long_step = whole_log2(20), longest = whole_log2(500);  // its square is finite
  const bool cut = log_h > long_step;
  if (cut) {
    const std::int64_t log_t = rough_log2_root(std::abs(t_), 1, 1);
    log_h = std::min(log_h, std::min(std::max(long_step, log_t - long_step), longest));
  }
  double h = rough_exp2(log_h);
  if (!series_.program().whole && h > 0) {
    // Where these two happen to vanish, as on an axis of symmetry, those before them speak: cₖ ρᵏ is to be of one size,
    // where ρ = h ε^{−1/p} is how far the series seems to converge.
    const double inverse_root = used_ == series_.order() ? inverse_root_ : std::pow(tolerance_, -1.0 / used_);
    const double rho = h * inverse_root;  // of the order before the last:
    const double promised = cut ? scale * std::pow(rho, 1 - used_) : larger(last_ * rho, before * inverse_root);
    const int low = std::max(1, used_ - looked_at + 1);
    double here = promised;  // of the order low
    for (int k = used_ - 2; k >= low; --k) here *= rho;
    Two above{};  // the largest of cₖ ρᵏ⁻ˡ
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      Two most{};
      for (int k = used_ - 2; k >= low; --k) most = larger(most * rho, sizes_of(k, pair));
      above = larger(above, most);
    }
    const auto heed = [&](int from, int to, double most) { h = heeded(h, from, to, slack * most, rho, scale); };
    if (larger(above[0], above[1]) > slack * here) heed(used_ - 2, low, promised);
    // A row that only begins to be something says nothing of how far it converges: then all of it is heeded.
    if (low > 1 && h * size_of(1) > far * size && size_of(low) < hush * here && size_of(low + 1) * rho < hush * here)
      heed(low - 1, 1, here);
  }
  h = std::min(h, longest_);
  for (const Index pole : series_.program().poles) {  // never over it, whatever the coefficients say
    const double ahead = -series_.coefficient(pole, 0) / series_.coefficient(pole, 1);
    if (ahead > 0) h = std::min(h, 0.5 * ahead);
  }
  return series_.program().switches.empty() ? h : until_switch(h);
}

/// Up to h, or to shortly behind the first time at which a formula changes.
double Expansion::until_switch(double h) const {
  constexpr std::size_t parts = 8;
  double end = h;
  for (const Index value : series_.program().switches) {
    double most = 0;
    for (int k = used_ - 1; k > 0; --k) most = (most + std::abs(series_.coefficient(value, k))) * end;
    if (most < std::abs(series_.coefficient(value, 0))) continue;  // it stays on its side
    const bool before = series_.coefficient(value, 0) < 0;
    std::array<double, parts> times, sums{};  // side by side, as each alone waits for itself
    for (std::size_t part = 0; part < parts; ++part) times[part] = end * static_cast<double>(part + 1) / parts;
    for (int k = used_ - 1; k >= 0; --k)
      for (std::size_t part = 0; part < parts; ++part)
        sums[part] = sums[part] * times[part] + series_.coefficient(value, k);
    for (std::size_t part = 0; part < parts; ++part) {
      if ((sums[part] < 0) == before) continue;
      double low = part > 0 ? times[part - 1] : 0, high = times[part];
      double time = low > 0 ? low : 0.5 * high;
      for (int i = 0; i < 60 && high - low > 1e-16 * high; ++i) {  // Newton's method, within these two
        double sum = 0, slope = 0;
        for (int k = used_ - 1; k >= 0; --k) {
          slope = slope * time + sum;
          sum = sum * time + series_.coefficient(value, k);
        }
        ((sum < 0) == before ? low : high) = time;
        const double next = time - sum / slope;
        if (std::abs(next - time) <= 4 * std::numeric_limits<double>::epsilon() * time) {
          high = time;
          break;
        }
        time = low < next && next < high ? next : 0.5 * (low + high);
      }
      const double beyond = 4 * std::numeric_limits<double>::epsilon();
      end = std::min(end, high * (1 + beyond) + beyond * std::abs(t_));
      break;
    }
  }
  return end;
}

void Expansion::evaluate(double h, double* low, double* y) const {
  const double square = h * h, fourth = std::min(square * square, std::numeric_limits<double>::max());
  for (std::size_t begin = 0; begin < variables_; begin += 2) {
    const auto at = [&](int k) -> Two { return *reinterpret_cast<const Apart*>(series_.coefficients(k) + begin); };
    Two a{}, b{}, c{}, d{};  // of every fourth power of h: sums that do not wait for each other
    int k = used_;
    switch (k % 4) {
      case 3:
        c = at(k--);
        [[fallthrough]];
      case 2:
        b = at(k--);
        [[fallthrough]];
      case 1:
        a = at(k--);
        break;
      default:
        break;
    }
    for (; k > 0; k -= 4) {
      d = d * fourth + at(k);
      c = c * fourth + at(k - 1);
      b = b * fourth + at(k - 2);
      a = a * fourth + at(k - 3);
    }
    const Two sum = ((a + b * h) + (c + d * h) * square) * h;
    if (begin + 1 < variables_) {  // written by two, as they are copied: what is written one by one cannot be handed on
      Apart *const to = reinterpret_cast<Apart*>(y + begin), *const kept = reinterpret_cast<Apart*>(low + begin);
      const Sum<Two> end = added<Two>(*to, sum, *kept);
      *to = end.value;
      *kept = end.kept;
    } else {
      const Sum<double> end = added(y[begin], sum[0], low[begin]);
      y[begin] = end.value;
      low[begin] = end.kept;
    }
  }
}

}  // namespace least::taylor

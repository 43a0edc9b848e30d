#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/schemes/taylor.hpp"
#include "core/tape/series_rules.hpp"

// How long a step of a Taylor series may be.

namespace least::taylor {
namespace {

using tape::Index;

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

/// Components by two.
typedef double Two __attribute__((vector_size(16)));
typedef std::int64_t Bits __attribute__((vector_size(16)));

constexpr Bits both{INT64_MAX, INT64_MAX}, first{INT64_MAX, 0};
template <class X>
X larger(const X& a, const X& b) {
  return a < b ? b : a;
}
/// Returns the sizes of two components; the mask `kept` clears those beyond the motion.
Two sizes(const double* c, const Bits& kept) {
  return std::bit_cast<Two>(std::bit_cast<Bits>(Two{tape::read_alone(c[0]), c[1]}) & kept);
}

constexpr std::int64_t long_step = whole_log2(20), longest_step = whole_log2(500);  // its square is finite
constexpr double before_switch = 0.999;   // part of a step that ends shortly behind a switch
constexpr int looked_at = 8;              // orders
constexpr double excess = 10;             // by how much their coefficients may exceed what the last two promise
constexpr double far = 0.5, hush = 0.01;  // parts of the state's size; of the size expected of earlier orders

/// Whether the coefficients of the two highest orders vanish, or underflow.
bool vanish(const tape::Series& series, std::size_t moving) {
  constexpr double nothing = 1e-290;  // below it digits are lost
  for (int k = series.order(); k > 0 && k > series.order() - 2; --k)
    for (std::size_t i = 0; i < moving; ++i)
      if (!(std::abs(series.coefficients(k)[i]) <= nothing)) return false;
  return true;
}

/// Whether the polynomials of this order solve the equations within the step h from the time t, every component of the
/// motion to 12 digits of its own size: where forces are weak, positions and momenta differ by many orders. `state` has
/// room for all variables.
bool solve_closely(tape::Series& series, int order, double t, double h, double* state) {
  constexpr double closely = 1e-12;
  constexpr int looks = 4;
  const auto coefficient = [&](int k, std::size_t i) { return series.coefficients(k)[i]; };
  for (int look = 1; look <= looks; ++look) {
    const double part = h * look / looks;
    for (std::size_t i = 0; i < series.program().variables; ++i) {
      state[i] = 0;
      for (int k = order; k >= 0; --k) state[i] = state[i] * part + coefficient(k, i);
    }
    if (!series.defined(state, t + part)) return false;
    for (std::size_t i = 0; i < series.program().moving; ++i) {
      double slope = 0;
      for (int k = order; k > 0; --k) slope = slope * part + k * coefficient(k, i);
      const double size = std::max(std::abs(coefficient(0, i)), std::abs(state[i]));
      if (!(std::abs(series.rate(i) - slope) * h <= closely * size)) return false;
    }
  }
  return true;
}

}  // namespace

double Expansion::size(int k) const {
  double sum = 0;
  for (std::size_t i = 0; i < moving_; ++i) sum += std::abs(series_.coefficients(k)[i]);
  return sum;
}

double Expansion::largest(int k) const {
  double most = 0;
  for (std::size_t i = 0; i < moving_; ++i) most = std::max(most, std::abs(series_.coefficients(k)[i]));
  return most;
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
  const double log_term = std::log2(slack * tolerance_ * std::max({least_size_, largest(0), largest_carried(0)}));
  for (const int k : {used_ - 1, used_})
    if (const double c = k > 0 ? largest_carried(k) : 0; c > 0)
      h = std::min(h, std::exp2((log_term - std::log2(c)) / k));
  return h;
}

double Expansion::length_by_series() const {
  return used_ == 0 ? 0 : moving_ <= 2 ? series_step<1>() : moving_ <= 4 ? series_step<2>() : series_step<0>();
}

double Expansion::step(double most) {
  double h = std::min(length_by_series(), told_);
  // Where the last coefficients vanish or underflow, as those of free motion and of one in a very weak force, they say
  // nothing of how long a step may be. Then the equations say it: the step is doubled as long as the polynomials solve
  // them in one that is much longer, so that it is itself good to many more digits. Where no end is known, it takes at
  // most as long as the motion has taken before. What depends on the time may come from nowhere.
  const bool silent = !reads_time_ && used_ > 0 && vanish(series_, moving_);
  if (silent) {
    constexpr double much = 16;
    const double ahead = std::isfinite(most) ? most : std::abs(t_);
    const double end = std::min({ahead, longest_, told_, rough_exp2(longest_step)});
    while (h < end && solve_closely(series_, used_, t_, much * h, way_.data())) h *= 2;
  }
  h = until_pole(h);
  const std::optional<double> behind = program().switches.empty() ? std::nullopt : until_switch(h);
  h = std::min(h, most);
  const bool hides = guarded_ && until_hidden(h);
  if (hides || silent || (reads_time_ && may_hide_what_comes(h, most)))  // behind a switch the equations are other ones
    for (double told = h == behind ? before_switch * h : h; h > 0 && !solves(told); told = h) h *= 0.5;
  return reads_time_ && h < most ? up_to_number(h) : h;
}

/// Shortens the step h for what a series does not show. Returns whether the step has to be checked all the same.
bool Expansion::until_hidden(double& h) const {
  for (const Index value : program().branches) {  // not over a branch point, however smooth the polynomials look
    const double ahead = -series_.coefficient(value, 0) / series_.coefficient(value, 1);
    if (ahead > 0) h = std::min(h, ahead);
  }
  return until_steep(h) || program().conceals;
}

/// Returns a step of at most h that ends at a time that is a double, if there is one: where equations read the time,
/// its rounding matters, as close to a pole.
double Expansion::up_to_number(double h) const {
  double end = t_ + h;
  if (end - t_ > h) end = std::nextafter(end, -std::numeric_limits<double>::infinity());
  return end > t_ ? end - t_ : h;
}

/// Shortens the step h until steep functions are resolved in it. Returns whether the argument of any of them moves.
bool Expansion::until_steep(double& h) const {
  bool moves = false;
  for (const tape::SteepArgument& steep : program().steep) {
    const auto term = [&](int k) { return series_.coefficient(steep.argument, k); };
    double change = 0;
    for (int k = used_ - 1; k > 0; --k) change = (change + std::abs(term(k))) * h;
    if (steep.calm(term(0), change)) continue;
    moves = true;
    tape::SteepLooks times, looks{};
    for (std::size_t i = 0; i < times.size(); ++i)
      times[i] = h * static_cast<double>(i) / static_cast<double>(times.size() - 1);
    for (int k = used_ - 1; k >= 0; --k)
      for (std::size_t i = 0; i < times.size(); ++i) looks[i] = looks[i] * times[i] + term(k);
    h = tape::resolved_length(steep, h, tape::most_of_series, looks, [&](double time) {
      double value = 0;
      for (int k = used_ - 1; k >= 0; --k) value = value * time + term(k);
      return value;
    });
  }
  return moves;
}

/// Whether a dormant force, such as t⁴⁰ or a pulse that is yet to come, may leave no trace in the series: its last
/// terms vanish, or it hardly moves, or it seems accurate up to the end or everywhere.
bool Expansion::may_hide_what_comes(double h, double most) const {
  constexpr double little = 0.01;
  if (used_ == 0) return false;
  return series_.program().whole || !(h < most) || (largest(used_) == 0 && (used_ == 1 || largest(used_ - 1) == 0)) ||
         largest(1) * h < little * std::max(least_size_, largest(0));
}
/// Returns a bound of the second derivative of component i within the step.
double Expansion::turning(std::size_t i, double h) const {
  double sum = 0;
  for (int k = used_; k > 1; --k) sum = sum * h + k * (k - 1) * std::abs(series_.coefficients(k)[i]);
  return sum;
}

/// Whether, at a few places within the step, the polynomials solve the equations to about the tolerance, or to what the
/// rounding of the time makes of it, and give the right arguments of steep functions.
bool Expansion::solves(double h) {
  constexpr double slack = 100, grain = 1e-12, told = 0.5, part_told = 1e-3;
  const double most = std::max(least_size_, largest(0)) * std::max(slack * tolerance_, grain);
  const double blur = reads_time_ ? 4 * std::numeric_limits<double>::epsilon() * std::abs(t_) : 0;
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
    for (std::size_t i = 0; i < moving_; ++i) {
      const double defect = std::abs(series_.rate(i) - slopes_[place * variables_ + i]) * h;
      if (!(defect <= most) && !(defect <= most + blur * h * turning(i, h)) &&
          !(defect <= most + series_.blur_of_trial() * h))
        return false;
    }
    for (const tape::SteepArgument& steep : program().steep) {
      double argument = 0;
      for (int k = used_ - 1; k >= 0; --k) argument = argument * part[place] + series_.coefficient(steep.argument, k);
      const double right = series_.value(steep.argument);
      if (std::abs(argument - right) > told / std::abs(steep.factor) + part_told * std::abs(right)) return false;
    }
  }
  return true;
}

/// Whether the state changes within h: then h is long because the unit of time is short, not because nothing happens.
bool Expansion::moves(double h) const {
  constexpr double little = 1e-3;
  double power = 1, size = std::max(least_size_, largest(0));
  for (int k = 1; k <= used_; ++k)
    if (power *= h; largest(k) * power > little * size) return true;
  return false;
}

double Expansion::heeded(double h, int from, int to, double most, double rho, double scale) const {
  for (int k = from; k >= to; --k)
    if (const double c = largest(k); c > (most *= rho))
      h = std::min(h, rough_exp2(rough_log2_root(scale, c, k)) * std::pow(tolerance_, 1.0 / used_));
  return h;
}

template <std::size_t Pairs>
double Expansion::series_step() const {
  const std::size_t pairs = Pairs > 0 ? Pairs : (moving_ + 1) / 2, stride = series_.stride();
  const Bits kept = moving_ % 2 == 0 ? both : first;
  const double *const newest = series_.coefficients(used_), *const oldest = series_.coefficients(0);
  const auto sizes_at = [&](const double* c, std::size_t pair) {
    return sizes(c + 2 * pair, pair + 1 < pairs ? both : kept);
  };
  const auto size_at = [&](const double* c) {
    Two most = sizes_at(c, 0);
    for (std::size_t pair = 1; pair < pairs; ++pair) most = larger(most, sizes_at(c, pair));
    return larger(most[0], most[1]);
  };
  const double size = larger(least_size_, size_at(oldest)), scale = allowed * size, term = scale * tolerance_;
  if (!(term > 0)) return 0;
  const double last = size_at(newest), before = used_ > 1 ? size_at(newest - stride) : 0;
  std::int64_t log_h = std::numeric_limits<std::int64_t>::max();
  if (last > 0) log_h = rough_log2_root(term, last, used_);
  if (before > 0) log_h = std::min(log_h, rough_log2_root(term, before, used_ - 1));
  const bool cut = log_h > long_step && (log_h > longest_step || !moves(rough_exp2(log_h)));
  if (cut) {
    const std::int64_t log_t = rough_log2_root(std::abs(t_), 1, 1);
    log_h = std::min(log_h, std::min(std::max(long_step, log_t - long_step), longest_step));
  }
  double h = rough_exp2(log_h);
  if (!series_.program().whole && h > 0) {
    // Where these two happen to vanish, as on an axis of symmetry, those before them decide: cₖ ρᵏ should be of one
    // size, where ρ = h ε^{−1/p} is the apparent radius of convergence.
    const double inverse_root = used_ == series_.order() ? inverse_root_ : std::pow(tolerance_, -1.0 / used_);
    const double rho = h * inverse_root;  // of the order before the last:
    const double promised = cut ? scale * std::pow(rho, 1 - used_) : larger(last * rho, before * inverse_root);
    double here = promised;  // of the lowest order looked at
    Two above{};             // the largest of cₖ ρᵏ there
    const auto look = [&](int rows) __attribute__((always_inline)) {
#pragma GCC unroll 8
      for (int row = 0; row < rows; ++row) here *= rho;
      for (std::size_t pair = 0; pair < pairs; ++pair) {
        const double* c = newest - 2 * stride;
        Two most{};
#pragma GCC unroll 8
        for (int row = 0; row < rows; ++row, c -= stride) most = larger(most * rho, sizes_at(c, pair));
        above = larger(above, most);
      }
    };
    const int low = used_ - looked_at + 1;
    if (low > 1)
      look(looked_at - 2);
    else if (used_ > 2)
      look(used_ - 2);
    if (larger(above[0], above[1]) > excess * here)
      h = heeded(h, used_ - 2, std::max(1, low), excess * promised, rho, scale);
    // If the lowest orders looked at are negligible although the state moves far, those looked at say nothing of how
    // far the series converges: then all lower orders are taken into account, too.
    const double little = hush * here;
    if (low > 1 && h * size_at(oldest + stride) > far * size) [[unlikely]]
      if (size_at(newest - (looked_at - 1) * stride) < little &&
          size_at(newest - (looked_at - 2) * stride) * rho < little)
        h = heeded(h, low - 1, 1, excess * here, rho, scale);
  }
  return std::min(h, longest_);
}

/// Shortens the step so that it does not lead over a pole of the rates, whatever the last coefficients suggest. Each
/// coefficient of R/(t − t*) determines R: where R is 0 to many digits, formulas are 0/0 there, and the motion goes on.
double Expansion::until_pole(double h) const {
  constexpr double none = 1e-28;
  constexpr int last_orders = 3;
  for (const Index pole : series_.program().poles) {
    const double ahead = -series_.coefficient(pole, 0) / series_.coefficient(pole, 1);
    if (!(ahead > 0 && 0.5 * ahead < h)) continue;
    double most = close_ && used_ > last_orders ? 0 : 1;
    for (int k = used_; k + last_orders > used_ && k > 0; --k)
      most = std::max(most, k * largest(k) * std::pow(ahead, k));
    if (!(most <= none * std::max(least_size_, largest(0)))) h = 0.5 * ahead;
  }
  return h;
}

}  // namespace least::taylor

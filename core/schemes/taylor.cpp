#include "core/schemes/taylor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/tape/wide.hpp"

namespace least::taylor {
namespace {

using tape::Index;
using tape::Program;

constexpr int most_chosen = 40;
constexpr double underflows = 1e-290, far_from_any = 1e-200;  // coefficients

/// What a step of the order p costs, about, in nanoseconds, of a program that is unrolled: measured where a leapfrog
/// step of Kepler's problem takes 14. Those that are read take longer, at much the same best order.
double cost(const Program::Effort& effort, double p) {
  const auto steps = static_cast<double>(effort.steps), fours = static_cast<double>(effort.fours);
  return 68 + 14 * static_cast<double>(effort.dear) + p * (4.5 + 0.3 * steps + 0.045 * fours * p);
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
  const double least = std::max(Expansion::allowed * tolerance, std::min(tolerance, 0x1p-47));
  const double digits = -std::log(least), longest = std::log(std::max(1.5, std::log(0x1p53 * tolerance)));
  const auto length = [&](int p) { return ((program.whole ? log_factorial(p) : 0) - digits) / p; };
  const auto dear = [&](int p) { return std::log(cost(program.effort, p)) - length(p); };
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

/// Components side by side.
template <std::size_t N>
struct Side {
  typedef double Lane __attribute__((vector_size(8 * N)));
  static void read(const double* from, Lane& lane) { std::memcpy(&lane, from, sizeof(lane)); }
  static void write(const Lane& lane, double* to) { std::memcpy(to, &lane, sizeof(lane)); }
};

/// Polynomials of the components, from their coefficients of order 1 at `first`, of the next `stride` behind.
struct Polynomials {
  const double* first;
  std::size_t stride;
  int order;
  double h, square, fourth;

  /// The change of N components by h is added to y, with what rounding has kept from it. From fours of terms, which do
  /// not wait for each other.
  template <std::size_t N>
  [[gnu::always_inline]] inline void add(std::size_t begin, const double* y, const double* low, double* end,
                                         double* rest) const {
    using One = Side<N>;
    using Lane = typename One::Lane;
    const double* from = first + begin;
    const auto next = [&](Lane & value) __attribute__((always_inline)) {
      One::read(from, value);
      from += stride;
    };
    Lane sum{}, a{}, b{}, c{}, d{};
    double power = h;
    int k = order;
    for (; k >= 4; k -= 4, power *= fourth) {
      next(a);
      next(b);
      next(c);
      next(d);
      sum += ((a + b * h) + (c + d * h) * square) * power;
    }
    if (k > 0) {
      b = c = Lane{};
      next(a);
      if (k > 1) next(b);
      if (k > 2) next(c);
      sum += ((a + b * h) + c * square) * power;
    }
    compensate<N>(sum, y + begin, low + begin, end + begin, rest + begin);
  }
  /// The same of one component, where powers of h may not be finite.
  void add_far(std::size_t i, const double* y, const double* low, double* end, double* rest) const {
    Side<1>::Lane sum{};
    for (int k = order; k > 0; --k) sum = (sum + first[i + static_cast<std::size_t>(k - 1) * stride]) * h;
    compensate<1>(sum, y + i, low + i, end + i, rest + i);
  }

 private:
  /// Written in one piece: what is written one by one cannot be handed on.
  template <std::size_t N>
  [[gnu::always_inline]] static inline void compensate(const typename Side<N>::Lane& sum, const double* y,
                                                       const double* low, double* end, double* rest) {
    typename Side<N>::Lane start, kept;
    Side<N>::read(y, start);
    Side<N>::read(low, kept);
    const typename Side<N>::Lane change = sum + kept, to = start + change, back = to - start;
    Side<N>::write(to, end);
    Side<N>::write((start - (to - back)) + (change - back), rest);
  }
};
constexpr double most_raised = 0x1p21;  // of which powers of any order are finite

/// Of a series and its program, about, in bytes, at the highest order that is chosen.
std::size_t bytes_of(const Program& program, int order) {
  const auto orders = static_cast<std::size_t>(std::max(order, most_chosen)) + 1;
  const std::size_t rows = static_cast<std::size_t>(program.rows), slots = program.low.size();
  return sizeof(double) * orders * (rows + 2 * slots) + sizeof(tape::Step) * program.steps.size() +
         sizeof(Program::Value) * program.values.size() + 2 * sizeof(Program::Product) * program.products.size();
}

/// Where an argument of a steep power or a branch value is asked for, the program is read: only then every value stands
/// at every order.
tape::Series series_of(Program program, double tolerance, int order, bool all_values = false) {
  const int chosen = order > 0 ? order : cheapest_order(program, tolerance);
  const bool unroll =
      !all_values && program.branches.empty() &&
      std::ranges::count(program.steep, tape::SteepArgument::Kind::power, &tape::SteepArgument::kind) == 0;
  return {std::move(program), chosen, unroll};
}

}  // namespace

Expansion::Expansion(Program program, double tolerance, int order)
    : Expansion{HeldByThread::take(bytes_of(program, order)), series_of(std::move(program), tolerance, order),
                tolerance} {}

Expansion Expansion::of_all_values(Program program, double tolerance, int order) {
  Held held = HeldByThread::take(bytes_of(program, order));
  return {std::move(held), series_of(std::move(program), tolerance, order, true), tolerance};
}

Expansion::Expansion(Held held, tape::Series series, double tolerance)
    : held_(std::move(held)),
      series_(std::move(series)),
      tolerance_(tolerance),
      inverse_root_(std::pow(tolerance, -1.0 / series_.order())),
      variables_(series_.program().variables),
      moving_(series_.program().moving),
      reads_time_(series_.program().reads_time),
      guarded_(!series_.program().steep.empty() || series_.program().conceals),
      way_(places * variables_),
      slopes_(way_) {
  if (const std::size_t bytes = series_.bytes(); bytes > held_.bytes()) held_.add(bytes - held_.bytes());
}

void Expansion::limit(double rate) {
  if (rate != 0)
    longest_ = std::exp(log_factorial(series_.order()) / series_.order()) / (inverse_root_ * std::abs(rate));
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
  if (!program().switches.empty() && leave_border(y)) series_.expand(y, t);
  bool bounded = false;
  if (!std::isfinite(size(series_.order())) && !program().steep.empty()) {  // one that overflows may be in a divisor
    series_.expand(y, t, true);
    bounded = std::isfinite(size(series_.order()));
    if (!bounded) series_.expand(y, t);
  }
  find_used();
  blur_ = 0;
  told_ = std::numeric_limits<double>::infinity();
  close_ = false;
  if (!bounded && series_.divides() && used_ > 0) look_closer(y);
}

/// Where rates have few digits, or something that is divided by may vanish within the step that the series seems to
/// allow, coefficients may be those of rounding: then they are computed to more digits, and told as far as these do.
void Expansion::look_closer(const double* y) {
  const double h = length_by_series(), reach = series_.reach(used_, h), blur = series_.blur();
  const auto far = [&](double part) {  // to where the last coefficient, by rounding alone, is a part of that times
    return std::exp((std::log(may_be_off() / blur / part) + used_ * std::log(reach)) / (used_ + 1));
  };
  // It is no number where something overflows.
  if (!std::isfinite(blur) || (blur * h <= may_be_off() && h <= far(1) && until_pole(h) == h)) return;
  constexpr double closer = 0x1p-53;
  series_.expand_closely(y, t_);
  close_ = true;
  find_used();
  blur_ = closer * blur;
  told_ = std::max(far(closer), 0.5 * reach);
}
/// What a step may be off in any case.
double Expansion::may_be_off() const {
  constexpr double rounding = 0x1p-45;  // of some hundred operations
  return std::max(allowed * tolerance_, rounding) * std::max(1.0, largest(0));
}

void Expansion::find_used() {
  used_ = series_.order();
  const double last = size(used_);
  if (!std::isfinite(last)) [[unlikely]] {
    used_ = 0;  // near a singularity high orders overflow before low ones mean nothing
    while (std::isfinite(size(used_ + 1))) ++used_;
  } else if (!(last > underflows)) [[unlikely]] {
    // Where the unit of time is short beside the motion, high orders underflow before low ones mean nothing. Of a
    // polynomial the last one that is not zero is no such number.
    int told = used_;
    while (told > 0 && !(largest(told) > underflows)) --told;
    if (told > 0 && largest(told) < far_from_any) used_ = told;
  }
}

LEAST_WIDE void Expansion::evaluate(double h, const double* y, const double* low, double* end, double* rest,
                                    bool room) const {
  const double square = h * h, fourth = square * square;
  const Polynomials of{series_.coefficients(1), series_.stride(), used_, h, square, fourth};
  std::size_t begin = 0;
  if (h > most_raised) {
    for (; begin < variables_; ++begin) of.add_far(begin, y, low, end, rest);
    return;
  }
  for (const std::size_t least = room ? 3 : 4; begin + least <= variables_; begin += 4)
    of.add<4>(begin, y, low, end, rest);
  for (; begin + 2 <= variables_; begin += 2) of.add<2>(begin, y, low, end, rest);
  for (; begin < variables_; ++begin) of.add<1>(begin, y, low, end, rest);
}

}  // namespace least::taylor

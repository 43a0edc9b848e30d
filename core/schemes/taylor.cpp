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

/// Estimates the cost of a step of the order p in nanoseconds, for an unrolled program and a machine on which a
/// leapfrog step of Kepler's problem takes 14. Interpreted programs take longer, but their best order is about the
/// same.
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

/// Returns the order with the cheapest steps per unit of time, by Jorba and Zou's argument with that cost: a step is ρ
/// ε^{1/p} long where the series converges up to ρ, and (ε p!)^{1/p} where it converges everywhere. In the latter case
/// its terms first grow, to eʰ, and their rounding errors have to stay below the tolerance.
int cheapest_order(const Program& program, double tolerance) {
  // The first few terms do not show yet how far a series converges: steps would be shorter than necessary.
  const int least_chosen = program.whole ? 4 : 14;
  // The size that the last terms may have; near that of rounding, longer steps of higher orders would lose digits.
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

/// N components side by side in a register.
template <std::size_t N>
struct Side {
  typedef double Lane __attribute__((vector_size(8 * N)));
  static void read(const double* from, Lane& lane) { std::memcpy(&lane, from, sizeof(lane)); }
  static void write(const Lane& lane, double* to) { std::memcpy(to, &lane, sizeof(lane)); }
};

/// The polynomials of the components: coefficients of order 1 are at `first`, those of the next orders `stride` apart.
struct Polynomials {
  const double* first;
  std::size_t stride;
  int order;
  double h, square, fourth;

  /// Writes y plus its change in the time h, for N components, to `end`, and the rounding error of the result to
  /// `rest`; `low` is the one that y carries. Terms are summed by fours, which do not wait for each other.
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
  /// The same for one component, without powers of h, which might overflow.
  void add_far(std::size_t i, const double* y, const double* low, double* end, double* rest) const {
    Side<1>::Lane sum{};
    for (int k = order; k > 0; --k) sum = (sum + first[i + static_cast<std::size_t>(k - 1) * stride]) * h;
    compensate<1>(sum, y + i, low + i, end + i, rest + i);
  }

 private:
  /// Stores whole registers: a processor cannot forward single stores to a wide load.
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
constexpr double most_raised = 0x1p21;  // times of which the powers of all orders are finite

/// Estimates the bytes of a series and its program, at the highest order that may be chosen.
std::size_t bytes_of(const Program& program, int order) {
  const auto orders = static_cast<std::size_t>(std::max(order, most_chosen)) + 1;
  const std::size_t rows = static_cast<std::size_t>(program.rows), slots = program.low.size();
  return sizeof(double) * orders * (rows + 2 * slots) + sizeof(tape::Step) * program.steps.size() +
         sizeof(Program::Value) * program.values.size() + 2 * sizeof(Program::Product) * program.products.size();
}

/// Makes the series. A program with steep powers or branch values is interpreted, because only then all values are
/// known at every order.
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
  if (!std::isfinite(size(series_.order())) && !program().steep.empty()) {  // they may overflow in a divisor
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

/// Where rates have few correct digits, or a divisor may vanish within the step that the series seems to allow,
/// coefficients may be rounding errors: then they are computed in double-double, and told_ is how far these are
/// accurate.
void Expansion::look_closer(const double* y) {
  const double h = length_by_series(), reach = series_.reach(used_, h), blur = series_.blur();
  const auto far = [&](double part) {  // the h at which `part` · blur · h (h/reach)^used_ comes to may_be_off()
    return std::exp((std::log(may_be_off() / blur / part) + used_ * std::log(reach)) / (used_ + 1));
  };
  // The rounding error is not finite where something overflows.
  if (!std::isfinite(blur) || (blur * h <= may_be_off() && h <= far(1) && until_pole(h) == h)) return;
  constexpr double closer = 0x1p-53;
  series_.expand_closely(y, t_);
  close_ = true;
  find_used();
  blur_ = closer * blur;
  told_ = std::max(far(closer), 0.5 * reach);
}
/// Returns the error that a step may have in any case.
double Expansion::may_be_off() const {
  constexpr double rounding = 0x1p-45;  // of some hundred operations
  return std::max(allowed * tolerance_, rounding) * std::max(least_size_, largest(0));
}

void Expansion::find_used() {
  used_ = series_.order();
  const double last = size(used_);
  if (!std::isfinite(last)) [[unlikely]] {
    used_ = 0;  // near a singularity, high orders overflow while low ones are still useful
    while (std::isfinite(size(used_ + 1))) ++used_;
  } else if (!(last > underflows)) [[unlikely]] {
    // Where the unit of time is short compared with the motion, high orders underflow while low ones are still useful.
    // The last nonzero order of a polynomial is not that small.
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

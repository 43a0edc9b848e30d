#include "core/periodic/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace least::periodic {
namespace {

using Complex = std::complex<double>;
constexpr double dependent = 1e-7;  // columns with a smaller independent part count as dependent
constexpr double at_one = 1e-7;     // a multiplier this close to the unit circle may be on either side of it

/// eigenvalues_of_product returns the eigenvalues of a product of m blocks, the first applied first. The product may be
/// ill-conditioned: its eigenvalues are the m-th powers of those of the block-cyclic matrix, of which one sector of
/// angle 2π/m contains each once. Source: Bojanczyk, Golub, Van Dooren, Proc. SPIE 1770, 31 (1992).
std::vector<Complex> eigenvalues_of_product(const std::vector<Matrix>& blocks) {
  const std::size_t count = blocks.size(), n = blocks[0].rows;
  if (count == 1 || n == 0) return eigenvalues(blocks[0]);
  Matrix circle(count * n, count * n);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) circle((i + 1) % count * n + a, i * n + b) = blocks[i](a, b);
  const std::vector<Complex> roots = eigenvalues(circle);
  // The sector begins in the middle of the largest gap of the angles modulo 2π/m.
  const double width = 2 * std::numbers::pi / double(count);
  std::vector<double> angles;
  angles.reserve(roots.size());
  for (const Complex& root : roots) angles.push_back(std::fmod(std::arg(root) + 4 * std::numbers::pi, width));
  std::ranges::sort(angles);
  double begin = (angles.back() + angles.front() + width) / 2, gap = angles.front() + width - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (angles[i] - angles[i - 1] <= gap) continue;
    gap = angles[i] - angles[i - 1];
    begin = (angles[i] + angles[i - 1]) / 2;
  }
  std::vector<Complex> found;
  found.reserve(n);
  for (const Complex& root : roots) {
    const double angle = std::fmod(std::arg(root) - begin + 6 * std::numbers::pi, 2 * std::numbers::pi);
    if (angle >= width) continue;
    Complex power = std::pow(root, double(count));
    if (std::abs(power.imag()) < 1e-9 * std::abs(power)) power = power.real();
    found.push_back(power);
  }
  return found;
}

/// Eigenvalue; `lost` means that its value is within the errors of the blocks.
struct Eigenvalue {
  Complex value;
  bool lost = false;
  double error = 0;  ///< by how much the errors of the blocks move it, where another eigenvalue is near; else 0
};

/// is_near tells whether another eigenvalue lies within a distance.
template <class Values>
bool is_near(const Values& all, std::size_t one, double distance) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i != one && std::abs(all[i].value - all[one].value) <= distance) return true;
  return false;
}

/// eigenvalues_with_errors changes the entries of the blocks by `errors`, with either sign. An eigenvalue that changes
/// strongly is marked as lost. Two that are near each other move by the square root of the errors.
/// Source: Golub & Van Loan, Matrix Computations, 2013, 7.2.
std::vector<Eigenvalue> eigenvalues_with_errors(const std::vector<Matrix>& blocks, std::span<const double> errors) {
  constexpr double surely = 1e-4, another = 0.25;  // larger ones than `surely` cannot be lost, as segments are short
  constexpr double near = 1e-2, few = 4, safely = 16;  // of eigenvalues that are near each other
  std::vector<Eigenvalue> all;
  for (const Complex& value : eigenvalues_of_product(blocks)) all.push_back({value});
  std::vector<bool> beside(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) beside[i] = std::abs(all[i].value) > surely && is_near(all, i, near);
  const bool simple = std::ranges::none_of(beside, [](bool one) { return one; });
  if (simple && std::ranges::all_of(all, [](const Eigenvalue& one) { return std::abs(one.value) > surely; }))
    return all;
  for (const double share : {1.0, -1.0, safely, -safely}) {
    const bool of_near = std::abs(share) > 1;
    if (of_near && simple) break;
    std::vector<Matrix> changed = blocks;
    Spread spread;
    for (std::size_t i = 0; i < changed.size(); ++i)
      for (double& entry : changed[i].a) entry += spread() < 0 ? -share * errors[i] : share * errors[i];
    const std::vector<Complex> others = eigenvalues_of_product(changed);
    for (std::size_t i = 0; i < all.size(); ++i) {
      double moved = std::numeric_limits<double>::infinity();
      for (const Complex& other : others) moved = std::min(moved, std::abs(other - all[i].value));
      const double size = std::abs(all[i].value);
      if (!of_near && size <= surely && moved > another * size) all[i].lost = true;
      if (of_near && beside[i]) all[i].error = std::max(all[i].error, few * moved);
    }
  }
  return all;
}

/// block_of returns the Jacobian of a segment in units of the extents; in contact scenes, restricted to the hyperplanes
/// δs = p·δq.
Matrix block_of(const Motion& motion, const Setting& setting, const std::vector<double>& from, const Matrix& slopes) {
  const std::size_t n = motion.coordinates(), all = motion.size();
  const std::size_t size = motion.equations().acting ? 2 * n : all;
  Matrix made(size, size);
  for (std::size_t a = 0; a < size; ++a)
    for (std::size_t b = 0; b < size; ++b) {
      const double through_s = size < all && b < n ? slopes(a, 2 * n) * from[n + b] : 0;
      made(a, b) = (slopes(a, b) + through_s) * setting.extents[b] / setting.extents[a];
    }
  return made;
}

/// gradients_in returns gradients restricted to the contact hyperplanes.
Matrix gradients_in(const Motion& motion, const Setting& setting, const std::vector<double>& at, Matrix all) {
  const std::size_t n = motion.coordinates();
  if (!motion.equations().acting) return all;
  Matrix made(2 * n, all.columns);
  for (std::size_t k = 0; k < all.columns; ++k)
    for (std::size_t i = 0; i < 2 * n; ++i)
      made(i, k) = all(i, k) + (i < n ? all(2 * n, k) * at[n + i] * setting.extents[i] / setting.extents[2 * n] : 0);
  return made;
}

/// symmetries_in returns symmetries in the coordinates (q, p) of the contact hyperplanes; ẋ lies in these where H = 0.
Matrix symmetries_in(const Motion& motion, const std::vector<double>& at, double t, Matrix all) {
  const std::size_t n = motion.coordinates();
  if (!motion.equations().acting) return all;
  const std::vector<double> rates = motion.rates(at, t);
  double h = -rates[2 * n], size = std::abs(rates[2 * n]);
  for (std::size_t i = 0; i < n; ++i) {
    h += at[n + i] * rates[i];
    size += std::abs(at[n + i] * rates[i]);
  }
  Matrix made(2 * n, std::abs(h) <= at_one * size ? all.columns : 0);
  for (std::size_t k = 0; k < made.columns; ++k)
    for (std::size_t i = 0; i < 2 * n; ++i) made(i, k) = all(i, k);
  return made;
}

/// error_of estimates the error of a block's entries: by how much the block misses the known images of symmetries, at
/// least rounding.
double error_of(const Matrix& block, const Matrix& here, const Matrix& there) {
  constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
  double error = rounding * length(block.a);
  for (std::size_t k = 0; k < std::min(here.columns, there.columns); ++k) {
    const std::vector<double> way = here.column(k), to = there.column(k), made = block * way;
    double missing = 0;
    for (std::size_t i = 0; i < to.size(); ++i) missing = std::hypot(missing, made[i] - to[i]);
    if (const double size = length(way); size > 0) error = std::max(error, 2 * missing / size);
  }
  return error;
}

MultiplierKind kind_of(const Complex& value, double error) {
  const double modulus = std::abs(value), known = std::max(at_one, error);
  if (std::abs(value - 1.0) <= known) return MultiplierKind::unit;
  if (std::abs(value.imag()) > 1e-9 * modulus)
    return std::abs(modulus - 1) <= known ? MultiplierKind::elliptic : MultiplierKind::complex;
  return value.real() > 0 ? MultiplierKind::hyperbolic : MultiplierKind::inverse_hyperbolic;
}

/// pairing_defect returns the largest |λμ/product − 1|, pairing the largest remaining multiplier with its best partner.
double pairing_defect(std::vector<Complex> all, double product) {
  std::ranges::sort(all, std::greater(), [](const Complex& value) { return std::abs(value); });
  double most = 0;
  while (all.size() > 1) {
    const Complex one = all.front();
    all.erase(all.begin());
    const auto defect = [&](const Complex& other) { return std::abs(one * other / product - 1.0); };
    const auto partner = std::ranges::min_element(all, {}, defect);
    most = std::max(most, defect(*partner));
    all.erase(partner);
  }
  return most;
}

/// integral_along integrates a function of state and time along an orbit, by five-point Gauss quadrature on ever more
/// parts. NaN where the orbit cannot be followed or the integral does not converge.
template <class Function>
double integral_along(Motion& motion, const Setting& setting, const Trial& trial, Effort& effort, Function&& function) {
  constexpr std::array<double, 5> places{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                         0.9061798459386640};
  constexpr std::array<double, 5> weights{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
  const std::size_t count = trial.nodes.size();
  const auto with = [&](std::size_t parts) {
    double integral = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double from = setting.start() + trial.at[i] * trial.period;
      const double span = ((i + 1 < count ? trial.at[i + 1] : 1) - trial.at[i]) * trial.period;
      const double part = span / double(parts);
      std::vector<double> times;
      times.reserve(parts * places.size());
      for (std::size_t k = 0; k < parts; ++k)
        for (const double place : places) times.push_back(from + part * (double(k) + (1 + place) / 2));
      std::string reason;
      const auto states = motion.path(trial.nodes[i], from, times, effort, reason);
      if (states.size() < times.size()) return std::numeric_limits<double>::quiet_NaN();
      for (std::size_t k = 0; k < times.size(); ++k)
        integral += part / 2 * weights[k % places.size()] * function(states[k], times[k]);
    }
    return integral;
  };
  constexpr std::size_t first = 64, most = 1 << 14;
  constexpr double same = 1e-9;
  double last = with(first);
  for (std::size_t parts = 2 * first; parts <= most; parts *= 2) {
    const double next = with(parts);
    if (std::isnan(next) || std::abs(next - last) <= same * std::max(1.0, std::abs(next))) return next;
    last = next;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// product_of_pairs returns e^{−∫∂H/∂s dt}, exactly 1 where the integral is only rounding, as for damping of mean 0.
double product_of_pairs(Motion& motion, const Setting& setting, const Trial& trial, Effort& effort) {
  constexpr double rounding = 1e-13;
  if (motion.symplectic()) return 1;
  double most = 0;
  const double integral = integral_along(motion, setting, trial, effort, [&](std::span<const double> x, double t) {
    const double damping = motion.action_slope(x, t);
    most = std::max(most, std::abs(damping));
    return damping;
  });
  return std::abs(integral) <= rounding * most * trial.period ? 1 : std::exp(-integral);
}

/// settle determines a single lost multiplier from the product of all, e^{∫div ẋ dt} by Liouville's theorem; in
/// mechanics from the product of pairs.
void settle(std::vector<Eigenvalue>& others, double pair_product, Motion& motion, const Setting& setting,
            const Trial& trial, Effort& effort) {
  if (std::ranges::count(others, true, &Eigenvalue::lost) != 1) return;
  const double product =
      std::isnan(pair_product)
          ? std::exp(integral_along(motion, setting, trial, effort,
                                    [&](std::span<const double> x, double t) { return motion.divergence(x, t); }))
          : std::pow(pair_product, double(motion.coordinates()));
  if (!std::isfinite(product)) return;
  Complex rest = 1;
  for (const Eigenvalue& one : others)
    if (!one.lost) rest *= one.value;
  const auto last = std::ranges::find(others, true, &Eigenvalue::lost);
  *last = {product / rest.real(), false};
}

std::optional<bool> verdict(const Stability& found) {
  bool tells = true;
  const std::span others = std::span(found.multipliers).subspan(found.trivial());
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto& [value, kind, error] = others[i];
    const double modulus = std::abs(value), known = std::max(at_one, error);
    if (modulus > 1 + known) return false;
    if (modulus < 1 - known) continue;
    // Where pairs have the product 1, single ones on the circle stay there, whereas two that errors do not tell apart
    // may leave it; in dissipative motion, multipliers must be strictly inside.
    const bool stays = found.pair_product == 1 && kind == MultiplierKind::elliptic;
    if (!stays || (error > at_one && is_near(others, i, error))) tells = false;
  }
  return tells ? std::optional(true) : std::nullopt;
}

}  // namespace

Stability stability_of(const Shooting& shooting, Motion& motion, const Setting& setting, const Trial& trial,
                       const Look& look, Effort& effort) {
  const std::size_t count = trial.nodes.size();
  const Conserved& conserved = shooting.conserved();
  std::vector<Matrix> kept, ways, inner;
  kept.reserve(count);
  ways.reserve(count);
  inner.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double>& at = trial.nodes[i];
    const double t = setting.start() + trial.at[i] * trial.period;
    kept.push_back(gradients_in(motion, setting, at, conserved.gradients(at, t)));
    ways.push_back(symmetries_in(motion, at, t, conserved.symmetries(at, t)));
  }
  // Gradients of conserved quantities are left eigenvectors to the multiplier 1, symmetries right ones. Only symmetries
  // tangent to the common level set of the conserved quantities count for multipliers within it.
  const Matrix span = span_of(kept[0], dependent);
  Matrix in_level = ways[0].columns > 0 ? ways[0] : Matrix(kept[0].rows, 0);
  Matrix mixing = in_level.columns > 0 ? Matrix::identity(in_level.columns) : Matrix();
  if (in_level.columns > 0 && span.columns > 0)
    mixing = orthogonal_to(transposed(transposed(span) * ways[0]), dependent, 1);
  if (in_level.columns > 0) in_level = span_of(ways[0] * mixing, dependent, 1);

  Stability found;
  found.by_invariants = span.columns;
  found.by_time = motion.autonomous() && in_level.columns > 0 ? 1 : 0;
  found.by_symmetries = in_level.columns - found.by_time;
  for (std::size_t i = 0; i < count; ++i) {
    Matrix out = kept[i];
    if (mixing.rows > 0) {
      const Matrix moves = ways[i] * mixing;
      for (std::size_t k = 0; k < moves.columns; ++k) out.add_column(moves.column(k));
    }
    inner.push_back(complement_of(out, found.trivial()));
  }
  std::vector<Matrix> blocks;
  std::vector<double> errors;
  blocks.reserve(count);
  errors.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    const Matrix whole = block_of(motion, setting, trial.nodes[i], look.segments[i].by_start);
    blocks.push_back(transposed(inner[next]) * (whole * inner[i]));
    errors.push_back(error_of(whole, ways[i], ways[next]));
  }
  found.multipliers.assign(found.trivial(), Multiplier{1.0, MultiplierKind::unit});
  std::vector<Eigenvalue> others = eigenvalues_with_errors(blocks, errors);
  const bool pairs = motion.coordinates() > 0 && !motion.equations().forced;
  if (pairs) found.pair_product = product_of_pairs(motion, setting, trial, effort);
  const bool all_known = std::ranges::none_of(others, &Eigenvalue::lost);
  settle(others, found.pair_product, motion, setting, trial, effort);
  std::ranges::sort(others, {},
                    [](const Eigenvalue& one) { return std::pair(-std::abs(one.value), -one.value.imag()); });
  for (const auto& [value, lost, error] : others)
    found.multipliers.push_back({value, lost ? std::nullopt : std::optional(kind_of(value, error)), error});

  if (pairs && all_known) {
    std::vector<Complex> all;
    all.reserve(found.multipliers.size());
    for (const Multiplier& one : found.multipliers) all.push_back(one.value);
    found.pairing_defect = pairing_defect(std::move(all), found.pair_product);
  }
  found.stable = verdict(found);
  return found;
}

}  // namespace least::periodic

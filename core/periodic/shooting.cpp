#include "core/periodic/shooting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace least::periodic {
namespace {

constexpr double no_pivot = 1e-10;  // relative to the largest pivot, below which a pivot counts as zero
constexpr double hardly_independent = 1e-8;
constexpr double hardly_broken = 1e-6;

/// equations_with returns the scene's equations for another value of the varied parameter.
Motion::Equations equations_with(const Setting& setting, double value) {
  Scene scene = *setting.scene;
  std::vector<bool> varied(scene.card().parameters.size(), false);
  if (setting.varied) {
    scene.parameters[*setting.varied] = value;
    varied[*setting.varied] = true;
  }
  return std::get<Motion::Equations>(variations::parametric_scene(scene, varied));
}

double size_of_defects(const Look& look, const FurtherRow* further) {
  const double more = further ? further->missing : 0;
  return std::sqrt(dot(look.defects, look.defects) + more * more);
}

}  // namespace

double Setting::period_at(double value) const {
  if (law == PeriodLaw::inverse) return guess_period * guess_value / value;
  if (law == PeriodLaw::proportional) return guess_period * value / guess_value;
  return guess_period;
}

double Setting::period_slope(double value) const {
  if (law == PeriodLaw::inverse) return -guess_period * guess_value / (value * value);
  if (law == PeriodLaw::proportional) return guess_period / guess_value;
  return 0;
}

Trial moved(const Trial& trial, const Setting& setting, std::span<const double> way, double by) {
  Trial made = trial;
  const std::size_t n = trial.nodes[0].size(), count = trial.nodes.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t a = 0; a < n; ++a) made.nodes[i][a] += by * way[i * n + a] * setting.extents[a];
  if (setting.varied) made.value += by * way[count * n + 1] * setting.value_unit;
  if (setting.law == PeriodLaw::free)
    made.period += by * way[count * n] * setting.guess_period;
  else
    made.period = setting.period_at(made.value);
  return made;
}

Shooting::Shooting(const Setting& setting, std::shared_ptr<Motion> motion, Effort& effort)
    : setting_(setting), effort_(effort), motion_(std::move(motion)), value_(setting.guess_value) {}

Motion& Shooting::prepare(const Trial& trial) {
  if (trial.value != value_) {
    conserved_.reset();
    value_ = trial.value;
    motion_ = std::make_shared<Motion>(equations_with(setting_, value_), setting_.varied, setting_.tolerance);
  }
  if (!conserved_) {
    Scene scene = *setting_.scene;
    if (setting_.varied) scene.parameters[*setting_.varied] = trial.value;
    conserved_.emplace(*motion_, scene, trial.nodes[0], setting_.extents, setting_.start(), trial.period);
  }
  return *motion_;
}

std::optional<Look> Shooting::look(const Trial& trial, std::string& reason) {
  Motion& by = prepare(trial);
  const std::size_t n = by.size(), count = trial.nodes.size();
  Look made;
  made.segments.reserve(count);
  made.defects.reserve(count * n);
  for (std::size_t i = 0; i < count; ++i) {
    const double to = i + 1 < count ? trial.at[i + 1] : 1;
    auto reached = by.follow(trial.nodes[i], setting_.start() + trial.at[i] * trial.period,
                             (to - trial.at[i]) * trial.period, effort_, reason);
    if (!reached) return std::nullopt;
    const bool last = i + 1 == count;
    for (std::size_t a = 0; a < n; ++a) {
      const double aim = trial.nodes[last ? 0 : i + 1][a] + (last ? setting_.turns[a] : 0);
      made.defects.push_back((reached->state[a] - aim) / setting_.extents[a]);
      made.closure = std::max(made.closure, std::abs(made.defects.back()));
    }
    made.segments.push_back(std::move(*reached));
  }
  return made;
}

bool Shooting::refine(Trial& trial, std::string& reason) {
  constexpr double most_in_all = 1e4, most_of_one = 3e3, wanted = 300;
  constexpr int rounds = 8;
  constexpr std::size_t most_equations = 512;  // the solution of n equations takes of the order n³
  const std::size_t most_nodes = std::max<std::size_t>(most_equations / trial.nodes[0].size(), 1);
  for (int round = 0; round < rounds; ++round) {
    const auto seen = look(trial, reason);
    if (!seen) return false;
    Trial finer{{}, {}, trial.period, trial.value};
    const std::size_t count = trial.nodes.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Matrix& slopes = seen->segments[i].by_start;
      double growth = 0;
      for (std::size_t a = 0; a < slopes.rows; ++a)
        for (std::size_t b = 0; b < slopes.columns; ++b)
          growth = std::max(growth, std::abs(slopes(a, b)) * setting_.extents[b] / setting_.extents[a]);
      const bool enough = growth <= (count == 1 ? most_in_all : most_of_one);
      const auto parts =
          enough ? std::size_t(1) : static_cast<std::size_t>(std::ceil(std::log(growth) / std::log(wanted)));
      const double from = trial.at[i], to = i + 1 < count ? trial.at[i + 1] : 1;
      std::vector<double> times;
      for (std::size_t k = 0; k < parts; ++k) {
        finer.at.push_back(from + (to - from) * double(k) / double(parts));
        times.push_back(setting_.start() + finer.at.back() * trial.period);
      }
      const auto states = motion_->path(trial.nodes[i], times[0], times, effort_, reason);
      if (states.size() < parts) return false;
      finer.nodes.insert(finer.nodes.end(), states.begin(), states.end());
    }
    if (finer.nodes.size() == count || finer.nodes.size() > most_nodes) return true;
    trial = std::move(finer);
  }
  return true;
}

Shooting::Equations Shooting::equations(const Trial& trial, const Look& look, const FurtherRow* further) {
  const Motion& by = prepare(trial);
  const std::size_t n = by.size(), count = trial.nodes.size(), size = count * n;
  const std::size_t at_period = size, at_value = size + 1;
  const std::vector<double>& unit = setting_.extents;
  Matrix rows(size, size + 2);
  Matrix kept(size, 0);  // directions of the defects that conserved quantities make redundant
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    const double from = trial.at[i], to = next > 0 ? trial.at[next] : 1;
    const Reached& reached = look.segments[i];
    const auto begins = by.rates(trial.nodes[i], setting_.start() + from * trial.period);
    const auto ends = by.rates(reached.state, setting_.start() + to * trial.period);
    const std::vector<double> carried = reached.by_start * begins;
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t row = i * n + a;
      for (std::size_t b = 0; b < n; ++b) rows(row, i * n + b) += reached.by_start(a, b) * unit[b] / unit[a];
      rows(row, next * n + a) -= 1;
      const double by_period = (ends[a] * to - carried[a] * from) / unit[a];
      if (setting_.law == PeriodLaw::free) rows(row, at_period) = by_period * setting_.guess_period;
      if (setting_.varied)
        rows(row, at_value) =
            (reached.by_parameter[a] / unit[a] + by_period * setting_.period_slope(trial.value)) * setting_.value_unit;
    }
  }
  for (std::size_t row = 0; row < size; ++row)
    for (std::size_t i = 0; i < n; ++i)
      if (setting_.fixed[i]) rows(row, i) = 0;

  Equations made{std::move(rows), look.defects};
  Matrix all_kept;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    const double to = next > 0 ? trial.at[next] : 1;
    const Matrix gradients = conserved_->gradients(trial.nodes[next], setting_.start() + to * trial.period);
    if (i == 0) all_kept = Matrix(size, gradients.columns);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t k = 0; k < gradients.columns; ++k) all_kept(i * n + a, k) = gradients(a, k);
  }
  const Matrix basis = span_of(all_kept, hardly_independent);
  const double drift = length(made.rows.column(at_value));
  double broken = 0;
  for (std::size_t k = 0; k < basis.columns; ++k) {
    const std::vector<double> one = basis.column(k);
    const std::vector<double> along = transposed(made.rows) * one;
    const double missing = dot(one, made.right);
    broken = std::hypot(broken, along[at_value]);
    for (std::size_t row = 0; row < size; ++row) {
      for (std::size_t j = 0; j < size + 2; ++j) made.rows(row, j) -= one[row] * along[j];
      made.right[row] -= one[row] * missing;
    }
  }
  made.breaks = broken > hardly_broken * drift + close_enough;

  const Matrix still = ways_that_rest(trial);
  const auto add_row = [&](std::span<const double> coefficients, double missing) {
    made.rows.a.insert(made.rows.a.end(), coefficients.begin(), coefficients.end());
    made.rows.a.resize(++made.rows.rows * made.rows.columns);
    made.right.push_back(missing);
  };
  for (std::size_t k = 0; k < still.columns; ++k) add_row(still.column(k), 0);
  if (further) add_row(further->coefficients, further->missing);
  for (double& part : made.right) part = -part;
  return made;
}

/// ways_that_rest returns, as columns, the directions of symmetries along which the first node must not move: all of
/// them, except combinations that fixed components rule out already, and the one that moves the component `led` of a
/// family.
Matrix Shooting::ways_that_rest(const Trial& trial) const {
  constexpr double hardly = 1e-4;
  Matrix ways = conserved_->symmetries(trial.nodes[0], setting_.start());
  if (ways.columns == 0) return ways;
  Matrix pinned(0, ways.columns);
  for (std::size_t i = 0; i < ways.rows; ++i) {
    if (!setting_.fixed[i]) continue;
    for (std::size_t k = 0; k < ways.columns; ++k) pinned.a.push_back(ways(i, k));
    ++pinned.rows;
  }
  Matrix still = ways;
  if (pinned.rows > 0) still = ways * orthogonal_to(transposed(pinned), hardly, 1);
  still = span_of(still, hardly_independent, 1);
  if (!setting_.led) return still;
  // Moving the orbit along itself gives the same orbit: the direction must be orthogonal to ẋ.
  Matrix along(ways.rows, 0);
  if (motion_->autonomous()) along.add_column(ways.column(0));
  const Matrix across = still * orthogonal_to(transposed(still) * along, hardly, 1);
  Matrix moves(across.columns, 1);
  for (std::size_t k = 0; k < across.columns; ++k) moves(k, 0) = across(*setting_.led, k);
  const Matrix rest = across * orthogonal_to(moves, hardly, 1);
  for (std::size_t k = 0; k < rest.columns; ++k) along.add_column(rest.column(k));
  return span_of(along, hardly_independent, 1);
}

Shooting::Corrected Shooting::correct(Trial trial, const std::function<FurtherRow(const Trial&)>& further,
                                      int iterations_allowed) {
  constexpr double round_off = 2e-14, longest = 0.3, slow = 0.3;
  constexpr int most_halves = 8;
  Corrected best;
  best.trial = trial;
  auto seen = look(trial, best.reason);
  if (!seen) return best;
  best.look = *seen;
  const auto row_of = [&](const Trial& of) { return further ? std::optional(further(of)) : std::nullopt; };
  double least = std::numeric_limits<double>::infinity();
  for (int iteration = 0;; ++iteration) {
    const auto row = row_of(trial);
    const double missing = row ? std::abs(row->missing) : 0, size = size_of_defects(*seen, row ? &*row : nullptr);
    const bool still_nearer = size <= slow * least;
    if (size < least) {
      least = size;
      best.trial = trial;
      best.look = *seen;
      best.closed = seen->closure <= close_enough && missing <= close_enough;
    }
    best.iterations = iteration;
    if ((best.closed && (least <= round_off || !still_nearer)) || iteration == iterations_allowed) break;

    const Equations made = equations(trial, *seen, row ? &*row : nullptr);
    std::vector<double> change = decompose(made.rows, made.right, no_pivot).solution;
    double most = 0;
    for (const double part : change) most = std::max(most, std::abs(part));
    if (!std::isfinite(most)) break;
    double share = most > longest ? longest / most : 1;
    std::optional<Look> better;
    Trial tried;
    for (int half = 0; half < most_halves; ++half, share /= 2) {
      tried = moved(trial, setting_, change, share);
      if (!(tried.period > 0)) continue;
      std::string why;
      better = look(tried, why);
      if (effort_.over()) {
        best.reason = why;
        return best;
      }
      if (!better) continue;
      const auto there = row_of(tried);
      const double size_there = size_of_defects(*better, there ? &*there : nullptr);
      if (size_there < (1 - 0.1 * share) * size || size_there < close_enough) break;
      better.reset();
    }
    if (!better) break;
    trial = std::move(tried);
    seen = std::move(better);
  }
  return best;
}

std::vector<double> Shooting::along_family(const Trial& trial, const Look& look, std::vector<double> wish) {
  Equations made = equations(trial, look, nullptr);
  if (made.breaks) {
    made.rows.a.resize(++made.rows.rows * made.rows.columns);
    made.rows.a.back() = 1;
    made.right.push_back(0);
  }
  const Matrix null = decompose(made.rows, made.right, no_pivot).null;
  std::vector<double> way(wish.size());
  for (std::size_t k = 0; k < null.columns; ++k) {
    const std::vector<double> one = null.column(k);
    const double share = dot(one, wish);
    for (std::size_t j = 0; j < way.size(); ++j) way[j] += share * one[j];
  }
  const std::size_t size = way.size() - 2;
  for (std::size_t i = 0; i < trial.nodes[0].size(); ++i)
    if (setting_.fixed[i]) way[i] = 0;
  if (setting_.law != PeriodLaw::free) way[size] = 0;
  if (!setting_.varied) way[size + 1] = 0;
  return way;
}

}  // namespace least::periodic

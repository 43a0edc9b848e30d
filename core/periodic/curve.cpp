#include "core/periodic/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace least::periodic {
namespace {

constexpr double hardly_moves = 1e-9;  // relative to what was wished for

}  // namespace

Curve::Curve(const FamilyAsked& asked, Setting setting, std::shared_ptr<Motion> motion, Effort& effort)
    : asked_(asked), setting_(std::move(setting)), effort_(effort), shooting_(setting_, std::move(motion), effort_) {}

std::optional<Step> Curve::begin(const Trial& first, std::string& reason) {
  Step here;
  here.trial = first;
  here.trial.value = setting_.guess_value;
  auto look = shooting_.look(here.trial, reason);
  if (!look) return std::nullopt;
  here.look = std::move(*look);
  const double from = value_of(here.trial);
  setting_.value_unit = asked_.to != from ? std::abs(asked_.to - from) : 1;
  std::vector<double> wish = gradient(here.trial);
  const double steepness = length(wish);
  if (asked_.to < from)
    for (double& part : wish) part = -part;
  const auto moves = [&] { return finish(here, wish) && std::abs(here.pace) > hardly_moves * steepness; };
  const bool by_fixed = holds_components();
  if (moves() || (let_more_move(here) && moves())) return here;
  reason = "the orbit is alone: no family of closed orbits goes through it along which " + asked_.name + " moves; " +
           (by_fixed                     ? "fewer variables in `fixed`"
            : asked_.by == By::parameter ? "another number"
                                         : "a parameter") +
           " may do so";
  return std::nullopt;
}

double Curve::value_of(const Trial& trial) {
  switch (asked_.by) {
    case By::parameter:
      return trial.value;
    case By::period:
      return trial.period;
    case By::energy:
      return shooting_.prepare(trial).energy(trial.nodes[0], setting_.start());
    case By::start:
      return trial.nodes[0][component()];
  }
  return 0;
}
std::size_t Curve::component() const {
  const auto& variables = shooting_.equations().variables;
  return static_cast<std::size_t>(std::ranges::find(variables, asked_.index) - variables.begin());
}

bool Curve::holds_components() const {
  return std::ranges::any_of(setting_.fixed, [](bool one) { return one; });
}
/// let_more_move releases a constraint that was set only to make members unique for each value, where it leaves no
/// family at all: in a family by parameter, the period (an oscillator may have the same period for all amplitudes);
/// in a family by start, the symmetries that move the start (such as rotations of the whole orbit). False: there was
/// no such constraint.
bool Curve::let_more_move(const Step& first) {
  if (asked_.by == By::start && !holds_components()) {
    setting_.led = component();
    return true;
  }
  if (asked_.by != By::parameter || !setting_.period_held) return false;
  setting_.law = PeriodLaw::free;
  hold_start(first);
  return true;
}

/// hold_start fixes components of the start that could change independently of the family's parameter, as an
/// amplitude can: for each such direction, the component that changes most.
void Curve::hold_start(const Step& first) {
  constexpr double hardly = 1e-6;
  const std::vector<double> wish = gradient(first.trial);
  for (std::size_t round = 0; round < setting_.fixed.size(); ++round) {
    const std::vector<double> tangent = shooting_.along_family(first.trial, first.look, wish);
    const double size = dot(tangent, tangent);
    if (!(size > 0)) return;
    double most = hardly;
    std::size_t freest = setting_.fixed.size();
    for (std::size_t i = 0; i < setting_.fixed.size(); ++i) {
      std::vector<double> one(wish.size());
      one[i] = 1;
      std::vector<double> way = shooting_.along_family(first.trial, first.look, one);
      const double share = dot(way, tangent) / size;
      for (std::size_t k = 0; k < way.size(); ++k) way[k] -= share * tangent[k];
      if (!(std::abs(way[i]) > most)) continue;
      most = std::abs(way[i]);
      freest = i;
    }
    if (freest == setting_.fixed.size()) return;
    setting_.fixed[freest] = true;
  }
}

/// gradient returns the derivative of the family's number by the unknowns, both in their units.
std::vector<double> Curve::gradient(const Trial& trial) {
  std::vector<double> made(Shooting::unknowns(trial));
  const std::size_t at_period = made.size() - 2, at_value = made.size() - 1;
  if (asked_.by == By::parameter) made[at_value] = 1;
  if (asked_.by == By::period) made[at_period] = setting_.guess_period / setting_.value_unit;
  if (asked_.by == By::start) made[component()] = setting_.extents[component()] / setting_.value_unit;
  if (asked_.by == By::energy) {
    const auto slopes = shooting_.prepare(trial).energy_gradient(trial.nodes[0], setting_.start());
    for (std::size_t i = 0; i < slopes.size(); ++i) made[i] = slopes[i] * setting_.extents[i] / setting_.value_unit;
  }
  return made;
}

/// velocity_at returns ẋ at the first node, in units of the extents.
std::vector<double> Curve::velocity_at(const Trial& trial) {
  std::vector<double> made = shooting_.prepare(trial).rates(trial.nodes[0], setting_.start());
  for (std::size_t i = 0; i < made.size(); ++i) made[i] /= setting_.extents[i];
  return made;
}

/// symmetries_of returns the symmetries at all nodes as columns of changes of the unknowns.
Matrix Curve::symmetries_of(const Trial& trial) {
  shooting_.prepare(trial);
  const std::size_t n = trial.nodes[0].size();
  Matrix made;
  for (std::size_t i = 0; i < trial.nodes.size(); ++i) {
    const double t = setting_.start() + trial.at[i] * trial.period;
    const Matrix at_node = shooting_.conserved().symmetries(trial.nodes[i], t);
    if (i == 0) made = Matrix(Shooting::unknowns(trial), at_node.columns);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t k = 0; k < at_node.columns; ++k) made(i * n + a, k) = at_node(a, k);
  }
  return made;
}

/// finish computes the tangent closest to a wish, the test functions and the orbit. False: there is no tangent.
bool Curve::finish(Step& step, const std::vector<double>& wish) {
  step.tangent = shooting_.along_family(step.trial, step.look, wish);
  const double size = length(step.tangent);
  if (!(size > hardly_moves * length(wish)) || !std::isfinite(size)) return false;
  for (double& part : step.tangent) part /= size;
  step.value = value_of(step.trial);
  step.pace = dot(gradient(step.trial), step.tangent);
  const bool autonomous = shooting_.prepare(step.trial).autonomous();
  step.velocity = autonomous ? velocity_at(step.trial) : std::vector<double>();
  step.symmetries = symmetries_of(step.trial);
  step.orbit = orbit_of(shooting_, setting_, step.trial, step.look, effort_);
  step.crossings = crossings_of(step.orbit.stability);
  return true;
}

Curve::Made Curve::along(const Step& here, double ds) {
  return corrected(here, ds, [&](const Trial& trial) {
    return FurtherRow{here.tangent, dot(here.tangent, change(here.trial, trial)) - ds};
  });
}

Curve::Made Curve::landed(const Step& here, double ds) {
  return corrected(here, ds, [&](const Trial& trial) {
    return FurtherRow{gradient(trial), (value_of(trial) - asked_.to) / setting_.value_unit};
  });
}

/// corrected applies Newton's method from the point at the distance ds along the tangent, with a further equation.
Curve::Made Curve::corrected(const Step& here, double ds, const std::function<FurtherRow(const Trial&)>& further) {
  constexpr int most_corrections = 12;
  const Trial aim = moved(here.trial, setting_, here.tangent, ds);
  if (!(aim.period > 0)) return {};
  auto made = shooting_.correct(aim, further, most_corrections);
  if (!made.closed) return {std::nullopt, made.iterations};
  Step next;
  next.trial = std::move(made.trial);
  next.look = std::move(made.look);
  if (!finish(next, way_on(here, next.trial)) || !connected(here, next, ds)) return {std::nullopt, made.iterations};
  return {std::move(next), made.iterations};
}

/// way_on returns the direction to which the next tangent should be close: the previous tangent, or, where symmetries
/// leave several, the direction in which the family's number changes most.
std::vector<double> Curve::way_on(const Step& from, const Trial& at) {
  if (!setting_.led) return from.tangent;
  std::vector<double> wish = gradient(at);
  if (from.pace < 0)
    for (double& part : wish) part = -part;
  return wish;
}

/// change returns the differences of all unknowns, in their units.
std::vector<double> Curve::change(const Trial& from, const Trial& to) const {
  const std::size_t n = from.nodes[0].size();
  std::vector<double> made;
  made.reserve(Shooting::unknowns(from));
  for (std::size_t i = 0; i < from.nodes.size(); ++i)
    for (std::size_t a = 0; a < n; ++a) made.push_back((to.nodes[i][a] - from.nodes[i][a]) / setting_.extents[a]);
  made.push_back(setting_.law == PeriodLaw::free ? (to.period - from.period) / setting_.guess_period : 0);
  made.push_back((to.value - from.value) / setting_.value_unit);
  return made;
}

double Curve::distance(const Step& a, const Step& b) const { return dot(a.tangent, change(a.trial, b.trial)); }

/// connected tells whether a step stayed on its curve, or Newton's method jumped to a neighbouring one. On a smooth
/// curve the chord of a short arc is parallel to the mean of the tangents at its ends up to the square of the arc's
/// length, whereas the angle of a jump grows as the step is shortened. Shifts of an orbit along its symmetries do not
/// count, unless they are what moves the number. Between members without a fold the family's number moves in one
/// direction.
bool Curve::connected(const Step& a, const Step& b, double ds) const {
  constexpr double too_far = 3, least_between = 0.5, parallel = 0.999, dependent = 1e-6;
  std::vector<double> chord = change(a.trial, b.trial), mean = a.tangent;
  if (!(length(chord) < too_far * ds) || !(dot(a.tangent, b.tangent) > least_between)) return false;
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += b.tangent[i];
  Matrix shifts(mean.size(), 0);
  const std::size_t count = std::min(a.symmetries.columns, b.symmetries.columns);
  for (std::size_t k = 0; k < (setting_.led ? std::min<std::size_t>(count, 1) : count); ++k) {
    std::vector<double> shift = a.symmetries.column(k);
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] += b.symmetries(i, k);
    shifts.add_column(shift);
  }
  const Matrix basis = span_of(shifts, dependent);
  for (std::size_t k = 0; k < basis.columns; ++k) {
    const std::vector<double> shift = basis.column(k);
    const double of_chord = dot(shift, chord), of_mean = dot(shift, mean);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      chord[i] -= of_chord * shift[i];
      mean[i] -= of_mean * shift[i];
    }
  }
  if (!(dot(chord, mean) > parallel * length(chord) * length(mean))) return false;
  const double gain = (b.value - a.value) / setting_.value_unit;
  return a.pace * b.pace <= 0 || gain * a.pace > 0 || std::abs(gain) < hardly_moves;
}

std::optional<double> Curve::value_at_rest(Step a, const Step& b) {
  constexpr int rounds = 3;
  constexpr double slow = 0.3, almost = 0.95;
  const auto share = [&] {
    const double ahead = dot(a.velocity, a.velocity), back = -dot(a.velocity, b.velocity);
    return ahead / (ahead + back);
  };
  Trial between = a.trial;
  for (std::size_t i = 0; i < between.nodes[0].size(); ++i)
    between.nodes[0][i] += share() * (b.trial.nodes[0][i] - a.trial.nodes[0][i]);
  between.value += share() * (b.trial.value - a.trial.value);
  const double speed = std::min(length(a.velocity), length(b.velocity));
  if (!(length(velocity_at(between)) < slow * speed)) return std::nullopt;
  for (int round = 0; round < rounds; ++round) {
    auto nearer = along(a, almost * share() * distance(a, b)).step;
    if (!nearer || dot(nearer->velocity, b.velocity) >= 0) break;
    a = std::move(*nearer);
  }
  // The cubic polynomial through values and slopes at both ends.
  const double x = share(), y = 1 - x, slope = distance(a, b) * setting_.value_unit;
  return y * y * ((1 + 2 * x) * a.value + x * slope * a.pace) + x * x * ((1 + 2 * y) * b.value - y * slope * b.pace);
}

Step Curve::zero_between(const Step& a, const Step& b, double ds, const TestFunction& test) {
  constexpr int rounds = 24;
  constexpr double close = 1e-9;
  double low = 0, high = ds, at_low = test(a), at_high = test(b);
  Step best = b;
  int side = 0;
  for (int round = 0; round < rounds && std::abs(high - low) > close * std::abs(ds); ++round) {
    const double middle = low + (high - low) * at_low / (at_low - at_high);
    auto made = along(a, middle).step;
    if (!made) break;
    const double here = test(*made);
    const bool nearer =
        // The test for a torus may be a mere sign, so that sizes do not compare
        std::abs(here) <= std::abs(test(best)) || round == 0;
    if (nearer) best = std::move(*made);
    if (here == 0) break;
    if ((here < 0) == (at_low < 0)) {
      low = middle;
      at_low = here;
      if (side == 1) at_high /= 2;
      side = 1;
    } else {
      high = middle;
      at_high = here;
      if (side == -1) at_low /= 2;
      side = -1;
    }
  }
  return best;
}

/// more_nodes refines a member whose differences grow too fast, keeping the known parts of its tangent.
bool Curve::more_nodes(Step& step) {
  Trial finer = step.trial;
  std::string reason;
  if (!shooting_.refine(finer, reason)) return false;
  if (finer.nodes.size() == step.trial.nodes.size()) return true;
  const std::size_t n = finer.nodes[0].size();
  std::vector<double> wish(Shooting::unknowns(finer));
  std::copy_n(step.tangent.begin(), n, wish.begin());
  std::copy_n(step.tangent.end() - 2, 2, wish.end() - 2);
  auto look = shooting_.look(finer, reason);
  if (!look) return false;
  step.trial = std::move(finer);
  step.look = std::move(*look);
  return finish(step, wish);
}

double Curve::extent(const Step& step) {
  std::string reason;
  const auto extents = extents_of(shooting_.prepare(step.trial), step.trial, setting_.start(), effort_, reason);
  if (extents.empty()) return std::numeric_limits<double>::quiet_NaN();
  double largest = 0;
  for (std::size_t i = 0; i < extents.size(); ++i) largest = std::max(largest, extents[i] / setting_.extents[i]);
  return largest;
}

double Curve::period_slope(const Step& step) const {
  if (!(std::abs(step.pace) > 1e-9)) return std::numeric_limits<double>::quiet_NaN();
  double period = step.tangent[step.tangent.size() - 2] * setting_.guess_period;
  if (setting_.law != PeriodLaw::free)
    period = setting_.period_slope(step.trial.value) * step.tangent.back() * setting_.value_unit;
  return period / (step.pace * setting_.value_unit);
}

}  // namespace least::periodic

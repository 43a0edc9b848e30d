// Families of closed orbits by pseudo-arclength: a step along the tangent, and Newton's method at right angles to it,
// so that folds are no end. Steps grow and shrink by how many iterations that takes. Between two members a bifurcation
// is told by what changes its sign, and found by the secant method. Sources: Keller, in Applications of Bifurcation
// Theory, 1977, 359; Doedel, Keller, Kernévez, Int. J. Bifurcation and Chaos 1, 493 (1991); Kuznetsov, Elements of
// Applied Bifurcation Theory, 2004, 10.3.
#include <algorithm>
#include <cmath>

#include "core/periodic/orbits.hpp"
#include "core/run/messages.hpp"

namespace least::periodic {
namespace {

using By = FamilyAsked::By;

/// A member on the way.
struct Step {
  Trial trial;
  Look look;
  Orbit orbit;
  std::vector<double> tangent;  ///< of length 1
  double value = 0, pace = 0;   ///< pace: dvalue/ds, in units of the value
  // Zero where a multiplier is −1, where one is 1, and where a pair goes through the unit circle.
  double doubling = 0, branching = 0, torus = 0;
  bool keeps_pairs = false;
};

class Family {
 public:
  Family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, Effort& effort,
         const std::function<bool(Member&&)>& take)
      : asked_(*question.family),
        setting_(std::move(setting)),
        effort_(effort),
        take_(take),
        shooting_(setting_, std::move(motion), effort_) {}

  std::string go(const Trial& first) {
    Trial trial = first;
    trial.value = setting_.guess_value;
    std::string reason;
    auto look = shooting_.look(trial, reason);
    if (!look) return reason;
    const double from = value_of(trial);
    setting_.value_unit = asked_.to != from ? std::abs(asked_.to - from) : 1;
    Step here;
    here.trial = std::move(trial);
    here.look = std::move(*look);
    std::vector<double> wish = gradient(here.trial);
    const double steepness = length(wish);
    if (asked_.to < from)
      for (double& part : wish) part = -part;
    if (!finish(here, wish) || !(std::abs(here.pace) > 1e-9 * steepness))
      return "the orbit is alone: no family of closed orbits goes through it along which " + asked_.name +
             " moves; a parameter may do so";
    if (!give(here, Bifurcation::none)) return "cancelled";
    if (asked_.to == from) return "";
    return walk(std::move(here));
  }

 private:
  double value_of(const Trial& trial) {
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
  std::size_t component() {
    const auto& variables = shooting_.equations().variables;
    return static_cast<std::size_t>(std::ranges::find(variables, asked_.index) - variables.begin());
  }

  /// Of the value, in its unit, by the unknowns in theirs.
  std::vector<double> gradient(const Trial& trial) {
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

  /// The tangent next to a wish, what is tested, the orbit. False: there is no tangent.
  bool finish(Step& step, const std::vector<double>& wish) {
    step.tangent = shooting_.along_family(step.trial, step.look, wish);
    const double size = length(step.tangent);
    if (!(size > 0) || !std::isfinite(size)) return false;
    for (double& part : step.tangent) part /= size;
    step.value = value_of(step.trial);
    step.pace = dot(gradient(step.trial), step.tangent);
    step.orbit = orbit_of(shooting_, setting_, step.trial, step.look, effort_);
    const Stability& of = step.orbit.stability;
    std::complex<double> doubling = 1, branching = 1;
    double largest_pair = 0;
    for (std::size_t i = of.trivial(); i < of.multipliers.size(); ++i) {
      const std::complex<double> value = of.multipliers[i].value;
      doubling *= value + 1.0;
      branching *= value - 1.0;
      if (std::abs(value.imag()) > 1e-9) largest_pair = std::max(largest_pair, std::abs(value));
    }
    step.doubling = doubling.real();
    step.branching = branching.real();
    step.keeps_pairs = of.pair_product == 1;
    step.torus = step.keeps_pairs ? (largest_pair > 1 + 1e-6 ? 1 : -1) : largest_pair > 0 ? largest_pair - 1 : 0;
    return true;
  }

  bool give(const Step& step, Bifurcation bifurcation) {
    Member member;
    member.value = step.value;
    member.bifurcation = bifurcation;
    member.orbit = step.orbit;
    const std::size_t at_period = step.tangent.size() - 2;
    double period = step.tangent[at_period] * setting_.guess_period;
    if (setting_.law != PeriodLaw::free)
      period = setting_.period_slope(step.trial.value) * step.tangent.back() * setting_.value_unit;
    const double value = step.pace * setting_.value_unit;
    if (std::abs(step.pace) > 1e-9) member.period_slope = period / value;
    ++given_;
    return take_(std::move(member));
  }

  /// The member at the distance ds along the tangent of another one; at `to` itself where that is asked for.
  std::optional<Step> step_from(const Step& here, double ds, bool land, int& iterations) {
    constexpr int most_corrections = 12;
    const Trial aim = moved(here.trial, setting_, here.tangent, ds);
    if (!(aim.period > 0)) return std::nullopt;
    const auto further = [&](const Trial& trial) {
      if (land) return FurtherRow{gradient(trial), (value_of(trial) - asked_.to) / setting_.value_unit};
      FurtherRow row{here.tangent, -ds};
      const std::size_t n = trial.nodes[0].size(), at_period = row.coefficients.size() - 2;
      for (std::size_t i = 0; i < trial.nodes.size(); ++i)
        for (std::size_t a = 0; a < n; ++a)
          row.missing += here.tangent[i * n + a] * (trial.nodes[i][a] - here.trial.nodes[i][a]) / setting_.extents[a];
      if (setting_.law == PeriodLaw::free)
        row.missing += here.tangent[at_period] * (trial.period - here.trial.period) / setting_.guess_period;
      row.missing += here.tangent[at_period + 1] * (trial.value - here.trial.value) / setting_.value_unit;
      return row;
    };
    auto made = shooting_.correct(aim, further, most_corrections);
    iterations = made.iterations;
    if (!made.closed) return std::nullopt;
    Step next;
    next.trial = std::move(made.trial);
    next.look = std::move(made.look);
    if (!finish(next, here.tangent)) return std::nullopt;
    constexpr double too_far = 3;
    return std::abs(dot(next.tangent, here.tangent)) > 0.5 && length_between(here, next) < too_far * std::abs(ds)
               ? std::optional(std::move(next))
               : std::nullopt;
  }
  double length_between(const Step& a, const Step& b) const {
    const std::size_t n = a.trial.nodes[0].size();
    double sum = 0;
    for (std::size_t i = 0; i < a.trial.nodes.size(); ++i)
      for (std::size_t k = 0; k < n; ++k)
        sum += std::pow((b.trial.nodes[i][k] - a.trial.nodes[i][k]) / setting_.extents[k], 2);
    return std::sqrt(sum + std::pow((b.trial.period - a.trial.period) / setting_.guess_period, 2) +
                     std::pow((b.trial.value - a.trial.value) / setting_.value_unit, 2));
  }

  std::string walk(Step here) {
    constexpr double least = 1e-7, far = 0.6;
    const double per_member = 1.25 / std::max(asked_.count - 1, 1),
                 longest = far * std::sqrt(double(here.trial.nodes.size()));
    double ds = std::min(per_member / std::abs(here.pace), longest);
    const double first_ds = ds;
    while (given_ < asked_.count) {
      if (effort_.over()) return over();
      ds = std::min({ds, longest, per_member / std::max(std::abs(here.pace), 1e-3)});
      const double ahead = (asked_.to - here.value) / setting_.value_unit, gain = here.pace * ds;
      const bool land = gain * ahead > 0 && std::abs(gain) >= std::abs(ahead);
      int iterations = 0;
      auto next = step_from(here, land ? ahead / here.pace : ds, land, iterations);
      if (!next) {
        ds /= land ? std::max(2.0, ds / std::abs(ahead / here.pace)) * 1.5 : 2;
        if (effort_.over()) return over();
        if (ds < least * first_ds)
          return "no closed orbit was found beyond " + asked_.name + " = " + messages::number(here.value);
        continue;
      }
      if (std::string why = vanishes(*next); !why.empty()) return why;
      if (!look_between(here, *next, land ? ahead / here.pace : ds)) return "cancelled";
      if (!give(*next, Bifurcation::none)) return "cancelled";
      if (land) return "";
      ds *= iterations <= 3 ? 1.6 : iterations <= 5 ? 1 : 0.5;
      here = std::move(*next);
      if (!more_nodes(here)) return "the orbit cannot be followed any more";
    }
    return "it has as many members as were asked for, and goes on";
  }
  std::string over() const { return effort_.why(); }

  /// Whether the family ends in an equilibrium, or its period grows beyond all bounds.
  std::string vanishes(const Step& step) {
    constexpr double hardly = 1e-5, endless = 1e3;
    Motion& motion = shooting_.prepare(step.trial);
    std::string reason;
    const auto extents = extents_of(motion, step.trial, setting_.start(), effort_, reason);
    double size = 0;
    for (std::size_t i = 0; i < extents.size(); ++i) size = std::max(size, extents[i] / setting_.extents[i]);
    const std::string where = asked_.name + " = " + messages::number(step.value);
    if (!extents.empty() && size < hardly) return "the family ends in an equilibrium at " + where;
    if (step.trial.period > endless * setting_.guess_period) return "the period grows beyond all bounds at " + where;
    return {};
  }

  /// A bifurcation between two members, found and given. False: no more is wanted.
  bool look_between(const Step& a, const Step& b, double ds) {
    using Test = double Step::*;
    const auto changes = [&](Test test) { return (a.*test < 0) != (b.*test < 0) && a.*test != 0; };
    const bool same_count = a.orbit.stability.trivial() == b.orbit.stability.trivial();
    const std::pair<Test, Bifurcation> tests[] = {{&Step::pace, Bifurcation::fold},
                                                  {&Step::doubling, Bifurcation::period_doubling},
                                                  {&Step::branching, Bifurcation::pitchfork_or_transcritical},
                                                  {&Step::torus, Bifurcation::torus}};
    const auto found = std::ranges::find_if(tests, [&](const auto& one) {
      const Test of = one.first;
      return changes(of) && (of == &Step::pace || same_count) && (of != &Step::torus || b.torus != 0);
    });
    if (found == std::end(tests)) return true;
    const auto [test, kind] = *found;
    // The secant method that keeps its bracket, halving what does not move (Illinois).
    constexpr int rounds = 24;
    constexpr double close = 1e-9;
    double low = 0, high = ds, at_low = a.*test, at_high = b.*test;
    Step best = b;
    int side = 0;
    for (int round = 0; round < rounds && std::abs(high - low) > close * std::abs(ds); ++round) {
      const double middle = low + (high - low) * at_low / (at_low - at_high);
      int iterations = 0;
      auto made = step_from(a, middle, false, iterations);
      if (!made) break;
      const double here = (*made).*test;
      const bool nearer =
          std::abs(here) <= std::abs(best.*test) || round == 0;  // that for a torus may have a sign alone
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
    return give(best, kind);
  }

  /// Where differences have come to grow too fast, with the tangent as far as it is known.
  bool more_nodes(Step& step) {
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

  const FamilyAsked& asked_;
  Setting setting_;
  Effort& effort_;
  const std::function<bool(Member&&)>& take_;
  Shooting shooting_;
  int given_ = 0;
};

}  // namespace

std::string follow_family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, const Trial& first,
                          Effort& effort, const std::function<bool(Member&&)>& take) {
  return Family(question, std::move(setting), std::move(motion), effort, take).go(first);
}

}  // namespace least::periodic

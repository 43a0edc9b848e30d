// Families of closed orbits by pseudo-arclength continuation: a step along the tangent, then Newton's method orthogonal
// to it, so that the family continues through folds. Step lengths adapt to the number of iterations. A bifurcation
// between two members is detected by the change of sign of a test function, and located by the secant method. Sources:
// Keller, in Applications of Bifurcation Theory, 1977, 359; Doedel, Keller, Kernévez, Int. J. Bifurcation and Chaos 1,
// 493 (1991); Kuznetsov, Elements of Applied Bifurcation Theory, 2004, 10.3.
#include <algorithm>
#include <cmath>

#include "core/periodic/bifurcations.hpp"
#include "core/periodic/orbits.hpp"
#include "core/run/messages.hpp"

namespace least::periodic {
namespace {

using By = FamilyAsked::By;

/// Step is a member together with what continuing from it needs.
struct Step {
  Trial trial;
  Look look;
  Orbit orbit;
  std::vector<double> tangent;  ///< of length 1
  double value = 0, pace = 0;   ///< pace: dvalue/ds, in units of the value
  Crossings crossings;
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
    const auto moves = [&] { return finish(here, wish) && std::abs(here.pace) > 1e-9 * steepness; };
    const bool by_fixed = fixed();
    if (!moves() && !(let_more_move(here) && moves()))
      return "the orbit is alone: no family of closed orbits goes through it along which " + asked_.name + " moves; " +
             (by_fixed                     ? "fewer variables in `fixed`"
              : asked_.by == By::parameter ? "another number"
                                           : "a parameter") +
             " may do so";
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

  bool fixed() const {
    return std::ranges::any_of(setting_.fixed, [](bool one) { return one; });
  }
  /// let_more_move releases a constraint that was set only to make members unique for each value, where it leaves no
  /// family at all: in a family by parameter, the period (an oscillator may have the same period for all amplitudes);
  /// in a family by start, the symmetries that move the start (such as rotations of the whole orbit). False: there was
  /// no such constraint.
  bool let_more_move(const Step& first) {
    if (asked_.by == By::start && !fixed()) {
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
  void hold_start(const Step& first) {
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

  /// finish computes the tangent closest to a wish, the test functions and the orbit. False: there is no tangent.
  bool finish(Step& step, const std::vector<double>& wish) {
    step.tangent = shooting_.along_family(step.trial, step.look, wish);
    const double size = length(step.tangent);
    if (!(size > 0) || !std::isfinite(size)) return false;
    for (double& part : step.tangent) part /= size;
    step.value = value_of(step.trial);
    step.pace = dot(gradient(step.trial), step.tangent);
    step.orbit = orbit_of(shooting_, setting_, step.trial, step.look, effort_);
    step.crossings = crossings_of(step.orbit.stability);
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

  /// step_from returns the member at the distance ds along the tangent of `here`; with `land`, the member whose number
  /// is `to`.
  std::optional<Step> step_from(const Step& here, double ds, bool land, int& iterations) {
    constexpr int most_corrections = 12;
    const Trial aim = moved(here.trial, setting_, here.tangent, ds);
    if (!(aim.period > 0)) return std::nullopt;
    const auto further = [&](const Trial& trial) {
      if (land) return FurtherRow{gradient(trial), (value_of(trial) - asked_.to) / setting_.value_unit};
      return FurtherRow{here.tangent, dot(here.tangent, change(here.trial, trial)) - ds};
    };
    auto made = shooting_.correct(aim, further, most_corrections);
    iterations = made.iterations;
    if (!made.closed) return std::nullopt;
    Step next;
    next.trial = std::move(made.trial);
    next.look = std::move(made.look);
    if (!finish(next, way_on(here, next.trial)) || !connected(here, next, ds)) return std::nullopt;
    return next;
  }

  /// way_on returns the direction to which the next tangent should be close: the previous tangent, or, where symmetries
  /// leave several, the direction in which the family's number changes most.
  std::vector<double> way_on(const Step& from, const Trial& at) {
    if (!setting_.led) return from.tangent;
    std::vector<double> wish = gradient(at);
    if (from.pace < 0)
      for (double& part : wish) part = -part;
    return wish;
  }

  /// change returns the differences of all unknowns, in their units.
  std::vector<double> change(const Trial& from, const Trial& to) const {
    const std::size_t n = from.nodes[0].size();
    std::vector<double> made;
    made.reserve(Shooting::unknowns(from));
    for (std::size_t i = 0; i < from.nodes.size(); ++i)
      for (std::size_t a = 0; a < n; ++a) made.push_back((to.nodes[i][a] - from.nodes[i][a]) / setting_.extents[a]);
    made.push_back(setting_.law == PeriodLaw::free ? (to.period - from.period) / setting_.guess_period : 0);
    made.push_back((to.value - from.value) / setting_.value_unit);
    return made;
  }

  /// connected tells whether a step stayed on its curve, or Newton's method jumped to a neighbouring family: the chord
  /// of a short arc makes small and similar angles with the tangents at both ends.
  bool connected(const Step& a, const Step& b, double ds) const {
    constexpr double too_far = 3, least_cosine = 0.8, least_between = 0.5, about = 0.25;
    const std::vector<double> chord = change(a.trial, b.trial);
    const double size = length(chord);
    const auto cosine = [&](const Step& step) { return dot(chord, step.tangent) / std::copysign(size, ds); };
    const auto sine = [](double of) { return std::sqrt(std::max(0.0, 1 - of * of)); };
    const double at_a = cosine(a), at_b = cosine(b);
    return size < too_far * std::abs(ds) && std::min(at_a, at_b) > least_cosine &&
           std::abs(sine(at_a) - sine(at_b)) < about && dot(a.tangent, b.tangent) > least_between;
  }

  std::string walk(Step here) {
    constexpr double least = 1e-7, least_told = 1e-4, far = 0.6;
    const double per_member = 1.25 / std::max(asked_.count - 1, 1),
                 longest = far * std::sqrt(double(here.trial.nodes.size()));
    double ds = std::min(per_member / std::abs(here.pace), longest);
    const double first_ds = ds;
    while (given_ < asked_.count) {
      if (effort_.over()) return over();
      ds = std::min({ds, longest, per_member / std::max(std::abs(here.pace), 1e-3)});
      const double ahead = (asked_.to - here.value) / setting_.value_unit, gain = here.pace * ds;
      const bool land = gain * ahead > 0 && std::abs(gain) >= std::abs(ahead);
      const double step = land ? ahead / here.pace : ds;
      const auto shorten = [&] { ds /= land ? std::max(2.0, ds / std::abs(step)) * 1.5 : 2; };
      int iterations = 0;
      auto next = step_from(here, step, land, iterations);
      if (!next) {
        shorten();
        if (effort_.over()) return over();
        if (ds < least * first_ds)
          return "no closed orbit was found beyond " + asked_.name + " = " + messages::number(here.value);
        continue;
      }
      if (std::string why = vanishes(*next); !why.empty()) return why;
      const Between between = look_between(here, *next, step);
      if (between.unclear && ds > least_told * first_ds) {
        shorten();
        continue;
      }
      if (between.found && !give(*between.found, between.kind)) return "cancelled";
      if (!give(*next, Bifurcation::none)) return "cancelled";
      if (land) return "";
      ds *= iterations <= 3 ? 1.6 : iterations <= 5 ? 1 : 0.5;
      here = std::move(*next);
      if (!more_nodes(here)) return "the orbit cannot be followed any more";
    }
    return "it has as many members as were asked for, and goes on";
  }
  std::string over() const { return effort_.why(); }

  /// vanishes says whether the family ends in an equilibrium, or with a period that grows without bound; empty
  /// otherwise.
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

  /// Between is what look_between finds between two members.
  struct Between {
    std::optional<Step> found;  ///< the member at the bifurcation
    Bifurcation kind = Bifurcation::none;
    /// A test function changes sign without a bifurcation: the two members may belong to different curves
    bool unclear = false;
  };
  Between look_between(const Step& a, const Step& b, double ds) {
    constexpr double always = 1e-6;  // distances below which rounding alone decides the sign at both ends
    const bool same_count = a.orbit.stability.trivial() == b.orbit.stability.trivial();
    Between made;
    for (const Bifurcation kind : {Bifurcation::fold, Bifurcation::period_doubling,
                                   Bifurcation::pitchfork_or_transcritical, Bifurcation::torus}) {
      const double at_a = sign_of(kind, a), at_b = sign_of(kind, b);
      if ((at_a < 0) == (at_b < 0) || at_a == 0 || (kind != Bifurcation::fold && !same_count)) continue;
      if (kind == Bifurcation::torus ? at_b == 0 : std::max(away_from(kind, a), away_from(kind, b)) < always) continue;
      Step nearest = zero_between(a, b, ds, kind);
      // A multiplier that has reached 1 may have been counted among the trivial ones.
      const bool explained = kind == Bifurcation::pitchfork_or_transcritical &&
                             nearest.orbit.stability.trivial() > a.orbit.stability.trivial();
      constexpr double at_it = 1e-3;
      if (explained || away_from(kind, nearest) < at_it) return {std::move(nearest), kind, false};
      made.unclear = true;
      if (effort_.over()) break;
    }
    return made;
  }
  /// sign_of returns the test function of a bifurcation, away_from how far the member is from it.
  static double sign_of(Bifurcation kind, const Step& step) {
    return kind == Bifurcation::fold ? step.pace : step.crossings.of(kind);
  }
  static double away_from(Bifurcation kind, const Step& step) {
    return kind == Bifurcation::fold ? std::abs(step.pace) : multipliers_away_from(kind, step.orbit.stability);
  }

  /// zero_between returns the member between two others at which the test function vanishes, by regula falsi with the
  /// Illinois modification.
  Step zero_between(const Step& a, const Step& b, double ds, Bifurcation kind) {
    constexpr int rounds = 24;
    constexpr double close = 1e-9;
    double low = 0, high = ds, at_low = sign_of(kind, a), at_high = sign_of(kind, b);
    Step best = b;
    int side = 0;
    for (int round = 0; round < rounds && std::abs(high - low) > close * std::abs(ds); ++round) {
      const double middle = low + (high - low) * at_low / (at_low - at_high);
      int iterations = 0;
      auto made = step_from(a, middle, false, iterations);
      if (!made) break;
      const double here = sign_of(kind, *made);
      const bool nearer =
          // The test for a torus may be a mere sign, so that sizes do not compare
          std::abs(here) <= std::abs(sign_of(kind, best)) || round == 0;
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

// Families of closed orbits: members along their curve, with step lengths that adapt to the number of iterations. A
// bifurcation between two members is detected by the change of sign of a test function, and located by the secant
// method. Source: Kuznetsov, Elements of Applied Bifurcation Theory, 2004, 10.3.
#include <algorithm>
#include <cmath>

#include "core/periodic/curve.hpp"
#include "core/run/messages.hpp"

namespace least::periodic {
namespace {

class Family {
 public:
  Family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, Effort& effort,
         const std::function<bool(Member&&)>& take)
      : asked_(*question.family),
        effort_(effort),
        take_(take),
        curve_(asked_, std::move(setting), std::move(motion), effort) {}

  std::string go(const Trial& first) {
    std::string reason;
    auto here = curve_.begin(first, reason);
    if (!here) return reason;
    if (!give(*here, Bifurcation::none)) return "cancelled";
    if (here->value == asked_.to) return "";
    return walk(std::move(*here));
  }

 private:
  bool give(const Step& step, Bifurcation bifurcation) {
    Member member;
    member.value = step.value;
    member.bifurcation = bifurcation;
    member.orbit = step.orbit;
    if (bifurcation != Bifurcation::none) member.orbit.stability.stable = stable_at(bifurcation, step.orbit.stability);
    member.period_slope = curve_.period_slope(step);
    ++given_;
    return take_(std::move(member));
  }

  std::string walk(Step here) {
    constexpr double least = 1e-7, least_told = 1e-4, far = 0.6;
    const double per_member = 1.25 / std::max(asked_.count - 1, 1),
                 longest = far * std::sqrt(double(here.trial.nodes.size()));
    double ds = std::min(per_member / std::abs(here.pace), longest);
    const double first_ds = ds;
    std::optional<double> to_land;  // the distance at which `to` is expected, where it is within a step
    while (given_ < asked_.count) {
      if (effort_.over()) return effort_.why();
      ds = std::min({ds, longest, per_member / std::max(std::abs(here.pace), 1e-3)});
      if (!to_land) to_land = expected(here, ds);
      const bool land = to_land.has_value();
      const double step = to_land.value_or(ds);
      auto [next, iterations] = land ? curve_.landed(here, step) : curve_.along(here, step);
      to_land.reset();
      if (effort_.over()) return effort_.why();
      if (next && !land && passes(here, *next)) {
        to_land = expected_between(here, *next);
        continue;
      }
      if (next)
        if (std::string why = ends(here, *next, land); !why.empty()) return why;
      if (!next || turned(here, *next)) {
        ds = step / 2;
        if (ds < least * first_ds) return "no closed orbit was found beyond " + number(here.value);
        continue;
      }
      const Between between = look_between(here, *next, step);
      if (effort_.over()) return effort_.why();
      if (between.unclear && ds > least_told * first_ds) {
        ds = step / 2;
        continue;
      }
      if (between.found && passes(here, *between.found)) {
        ds = step / 2;
        if (!land) to_land = expected_between(here, *between.found);
        continue;
      }
      if (between.found && !give(*between.found, between.kind)) return "cancelled";
      if (given_ == asked_.count) break;
      if (!give(*next, Bifurcation::none)) return "cancelled";
      if (land || next->value == asked_.to) return "";
      ds *= iterations <= 3 ? 1.6 : iterations <= 5 ? 1 : 0.5;
      here = std::move(*next);
      if (!curve_.more_nodes(here)) return effort_.over() ? effort_.why() : "the orbit cannot be followed any more";
    }
    return "it has as many members as were asked for, and goes on";
  }

  /// expected returns the distance at which the tangent reaches `to`, if it is within ds.
  std::optional<double> expected(const Step& here, double ds) const {
    const double ahead = (asked_.to - here.value) / curve_.setting().value_unit, gain = here.pace * ds;
    if (gain * ahead > 0 && std::abs(gain) >= std::abs(ahead)) return ahead / here.pace;
    return std::nullopt;
  }
  /// expected_between returns the distance at which the chord from a to b reaches `to`.
  double expected_between(const Step& a, const Step& b) const {
    return curve_.distance(a, b) * (asked_.to - a.value) / (b.value - a.value);
  }
  /// passes tells whether `to` lies between two members.
  bool passes(const Step& a, const Step& b) const { return (a.value < asked_.to) != (b.value < asked_.to); }

  /// ends says whether the family ends between two members or at the second one, in an equilibrium or with a period
  /// that grows without bound; empty otherwise.
  std::string ends(const Step& a, const Step& b, bool landed) {
    constexpr double hardly = 1e-5, slow = 0.1, endless = 1e3;
    if (!b.velocity.empty()) {
      const bool slower = landed && length(b.velocity) < slow * length(a.velocity);
      const auto rest = turned(a, b) || slower ? curve_.value_at_rest(a, b) : std::nullopt;
      // A member that has landed beside an equilibrium, as near as rounding allows, still moves.
      const bool at_end = rest && std::abs(*rest - asked_.to) <= Shooting::close_enough * curve_.setting().value_unit;
      if (rest && (turned(a, b) || at_end)) return in_equilibrium(*rest);
      if (curve_.extent(b) < hardly) return in_equilibrium(b.value);
    }
    if (b.trial.period > endless * curve_.setting().guess_period)
      return "the period grows beyond all bounds at " + number(b.value);
    return {};
  }
  /// turned tells whether the velocity at the first node has turned around, as it does within a short step only through
  /// an equilibrium.
  static bool turned(const Step& a, const Step& b) { return !b.velocity.empty() && dot(a.velocity, b.velocity) <= 0; }
  std::string in_equilibrium(double value) const { return "the family ends in an equilibrium at " + number(value); }
  std::string number(double value) const { return asked_.name + " = " + messages::number(value); }

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
      Step nearest = curve_.zero_between(a, b, ds, [kind](const Step& at) { return sign_of(kind, at); });
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

  const FamilyAsked& asked_;
  Effort& effort_;
  const std::function<bool(Member&&)>& take_;
  Curve curve_;
  int given_ = 0;
};

}  // namespace

std::string follow_family(const Question& question, Setting setting, std::shared_ptr<Motion> motion, const Trial& first,
                          Effort& effort, const std::function<bool(Member&&)>& take) {
  return Family(question, std::move(setting), std::move(motion), effort, take).go(first);
}

}  // namespace least::periodic

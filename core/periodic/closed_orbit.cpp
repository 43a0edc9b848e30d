#include "core/periodic/closed_orbit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "core/catalogue/backward.hpp"
#include "core/catalogue/catalogue.hpp"
#include "core/periodic/orbits.hpp"
#include "core/run/messages.hpp"
#include "core/text/scene.hpp"
#include "core/variations/start.hpp"

namespace least::periodic {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int most_iterations = 60;
Objection too_long() { return {"/problem", "the equations of its derivatives are too long", {}}; }

Rates rates_of(const Motion::Equations& equations) {
  return
      [equations, formula = variations::formula_of(*equations, equations->rates)](std::span<const double> x, double t) {
        std::vector<double> all(x.begin(), x.end()), rates(formula.outputs());
        all.insert(all.end(), equations->parameters.begin(), equations->parameters.end());
        formula.evaluate(all.data(), t, rates.data());
        return rates;
      };
}

double size_of(const std::vector<double>& x) {
  double size = 0;
  for (const double part : x) size = std::max(size, std::abs(part));
  return size;
}
bool at_rest(const std::vector<double>& extents, const std::vector<double>& x) {
  constexpr double hardly = 1e-9;
  return size_of(extents) <= hardly * size_of(x);
}

/// Extents become units, which must not be 0: components that do not move get the largest unit.
void make_units(std::vector<double>& extents) {
  const double most = *std::ranges::max_element(extents);
  for (double& extent : extents)
    if (!(extent > 0)) extent = most > 0 ? most : 1;
}

/// turns_of finds components that act as angles: the equations do not change by 2π, and the orbit closes up to whole
/// turns.
std::vector<double> turns_of(const Rates& rates, const Trial& trial, const std::vector<double>& end, double start) {
  constexpr double turn = 2 * std::numbers::pi;
  const std::vector<double>& x = trial.nodes[0];
  std::vector<double> turns(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double count = std::round((end[i] - x[i]) / turn);
    if (count == 0) continue;
    const auto shifted = [&](double by) -> Rates {
      return [&rates, i, by](std::span<const double> at, double t) {
        std::vector<double> place(at.begin(), at.end());
        place[i] += by;
        return rates(place, t);
      };
    };
    if (repeats(rates, shifted(turn), x, start, trial.period, 0) &&
        !repeats(rates, shifted(1), x, start, trial.period, 0))
      turns[i] = turn * count;
  }
  return turns;
}

/// period_law finds how the period of the drive depends on the parameter; nothing where it is none of the known laws.
std::optional<PeriodLaw> period_law(const Question& question) {
  const Scene& scene = *question.scene;
  const std::size_t parameter = question.family->index;
  const double value = scene.parameters[parameter];
  Scene other = scene;
  constexpr double a_part = 1e-2;
  other.parameters[parameter] = value + a_part * (question.family->to - value);
  const auto equations = equations_of(other, parameter);
  const auto* known = std::get_if<Motion::Equations>(&equations);
  if (!known) return std::nullopt;
  const Rates rates = rates_of(*known);
  const std::vector<double> x = components_of(**known, scene);
  const auto fits = [&](double period) { return repeats(rates, rates, x, scene.start, period, period); };
  const double ratio = other.parameters[parameter] / value;
  if (fits(question.period)) return PeriodLaw::kept;
  if (value == 0) return std::nullopt;
  if (fits(question.period / ratio)) return PeriodLaw::inverse;
  if (fits(question.period * ratio)) return PeriodLaw::proportional;
  return std::nullopt;
}

class Closing {
 public:
  Closing(const Question& question, std::shared_ptr<Motion> motion, Effort& effort, Answer& answer)
      : question_(question), motion_(std::move(motion)), effort_(effort), answer_(answer) {}

  /// go() returns the closed orbit; nothing where none was found, and the answer has the reason.
  std::optional<Trial> go() {
    const Scene& scene = *question_.scene;
    setting_.scene = question_.scene;
    setting_.tolerance = question_.settings[0];
    setting_.guess_period = question_.period;
    Motion& motion = *motion_;
    const Trial guess{{components_of(motion.equations(), scene)}, {0}, question_.period, 0};
    setting_.law = motion.autonomous() ? PeriodLaw::free : PeriodLaw::kept;
    setting_.extents = extents_of(motion, guess, scene.start, effort_, answer_.reason);
    fill(motion, guess);
    if (setting_.extents.empty()) return std::nullopt;
    if (at_rest(setting_.extents, guess.nodes[0])) {
      if (motion.autonomous()) {
        answer_.reason =
            "nothing moves from the guess within the period: the guess is at an equilibrium, or the period is "
            "far too short";
        return std::nullopt;
      }
      // An equilibrium of a driven scene is itself an orbit of the drive's period, without an extent to be a unit.
      std::ranges::fill(setting_.extents, size_of(guess.nodes[0]));
    }
    make_units(setting_.extents);
    shooting_.emplace(setting_, motion_, effort_);
    return improve(motion, guess);
  }

  Setting& setting() { return setting_; }
  Shooting& shooting() { return *shooting_; }

 private:
  /// fill sets what is known even where no orbit is found.
  void fill(const Motion& motion, const Trial& trial) {
    const variations::ParametricScene& equations = motion.equations();
    setting_.fixed.assign(motion.size(), false);
    for (const std::size_t variable : question_.fixed)
      for (std::size_t i = 0; i < motion.size(); ++i)
        if (equations.variables[i] == variable) setting_.fixed[i] = true;
    setting_.turns.assign(motion.size(), 0);
    Orbit& orbit = answer_.orbit;
    orbit.scene = question_.scene;
    orbit.period = trial.period;
    orbit.closure = std::numeric_limits<double>::quiet_NaN();
    if (motion.keeps_energy()) orbit.energy = motion.energy(trial.nodes[0], setting_.start());
    for (const std::size_t place : equations.variables)
      orbit.rows.push_back(question_.scene->card().variables[place].name);
  }

  std::optional<Trial> improve(Motion& motion, Trial trial) {
    const Rates rates = [&](std::span<const double> x, double t) { return motion.rates(x, t); };
    const double end = setting_.start() + trial.period;
    const auto last = motion.path(trial.nodes[0], setting_.start(), std::span(&end, 1), effort_, answer_.reason);
    if (last.empty()) return std::nullopt;
    setting_.turns = turns_of(rates, trial, last[0], setting_.start());
    answer_.orbit.closure = 0;  // of the guess, until something nearer is known
    for (std::size_t i = 0; i < last[0].size(); ++i) {
      const double missing = last[0][i] - trial.nodes[0][i] - setting_.turns[i];
      answer_.orbit.closure = std::max(answer_.orbit.closure, std::abs(missing) / setting_.extents[i]);
    }
    if (setting_.law == PeriodLaw::free) trial.period = nearest_return(motion, setting_, trial, effort_);
    if (question_.symmetric) {
      const auto minus = reversed_components(rates, trial.nodes[0], setting_.start(), motion.coordinates());
      const bool half = close_half(motion, setting_, *minus, trial, effort_, answer_.iterations, answer_.reason);
      for (std::size_t i = 0; i < minus->size(); ++i) setting_.fixed[i] = setting_.fixed[i] || (*minus)[i];
      if (!half) {
        show(trial);
        return std::nullopt;
      }
    }
    std::optional<Trial> closed = try_from(motion, trial);
    // A guess that is off an attracting orbit comes closer to it in a few periods.
    const bool free = question_.fixed.empty() && !question_.symmetric && !motion.symplectic();
    constexpr int later = 3;
    for (int k = 0; k < later && free && !closed && !effort_.over(); ++k) {
      const double at = setting_.start() + trial.period;
      std::string reason;
      const auto states = motion.path(trial.nodes[0], setting_.start(), std::span(&at, 1), effort_, reason);
      if (states.empty()) break;
      trial.nodes[0] = states[0];
      for (std::size_t i = 0; i < trial.nodes[0].size(); ++i) trial.nodes[0][i] -= setting_.turns[i];
      if (setting_.law == PeriodLaw::free) trial.period = nearest_return(motion, setting_, trial, effort_);
      closed = try_from(motion, trial);
    }
    if (closed) answer_.reason.clear();
    return closed;
  }

  std::optional<Trial> try_from(Motion& motion, Trial trial) {
    std::string reason;
    if (!shooting_->refine(trial, reason)) return fails(reason);
    return judge(motion, shooting_->correct(trial, {}, most_iterations));
  }
  std::nullopt_t fails(const std::string& reason) {
    if (answer_.reason.empty()) answer_.reason = reason;
    return std::nullopt;
  }

  /// show puts a trial into the answer, however far from closed it is.
  void show(const Trial& trial) {
    std::string reason;
    if (const auto look = shooting_->look(trial, reason))
      answer_.orbit = orbit_of(*shooting_, setting_, trial, *look, effort_);
  }

  std::optional<Trial> judge(Motion& motion, const Shooting::Corrected& made) {
    constexpr double vanished = 1e-6;
    answer_.iterations += made.iterations;
    if (made.look.segments.empty()) return fails(made.reason);
    std::string reason = made.reason;
    std::vector<double> extents = extents_of(motion, made.trial, setting_.start(), effort_, reason);
    // Where a limit hides by how much it moves, the extents of the guess tell how near it came.
    const bool known = !extents.empty();
    if (!known) extents = setting_.extents;
    double shrunk = 0;
    for (std::size_t i = 0; i < extents.size(); ++i) shrunk = std::max(shrunk, extents[i] / setting_.extents[i]);
    bool rests = shrunk < vanished || at_rest(extents, made.trial.nodes[0]);
    if (rests && !motion.autonomous()) {  // the equilibrium of a driven scene is an orbit
      rests = false;
      extents = setting_.extents;
    }
    make_units(extents);
    double closure = 0;
    for (std::size_t row = 0; row < made.look.defects.size(); ++row) {
      const std::size_t i = row % extents.size();
      closure = std::max(closure, std::abs(made.look.defects[row]) * setting_.extents[i] / extents[i]);
    }
    answer_.closed = known && made.closed && !rests && closure <= Shooting::close_enough;
    const bool nearest = answer_.orbit.monodromy.rows == 0 || closure < answer_.orbit.closure;
    if (answer_.closed || nearest) {  // the nearest to closed of all that were tried
      answer_.orbit = orbit_of(*shooting_, setting_, made.trial, made.look, effort_);
      answer_.orbit.closure = closure;
    }
    if (!answer_.closed) answer_.orbit.stability = {};
    if (rests) {
      double pace = 0;
      const std::vector<double> rates = motion.rates(made.trial.nodes[0], setting_.start());
      for (std::size_t i = 0; i < rates.size(); ++i)
        pace = std::max(pace, std::abs(rates[i]) * setting_.guess_period / setting_.extents[i]);
      answer_.reason = pace < vanished ? "Newton's method has led to an equilibrium"
                                       : "Newton's method comes nearer only in a time that goes to 0";
      return std::nullopt;
    }
    if (answer_.closed) return made.trial;
    answer_.reason = !reason.empty() ? reason
                                     : "Newton's method comes no nearer than " + messages::number(closure) +
                                           " of the orbit's extent";
    return std::nullopt;
  }

  const Question& question_;
  std::shared_ptr<Motion> motion_;
  Effort& effort_;
  Answer& answer_;
  Setting setting_;
  std::optional<Shooting> shooting_;
};

}  // namespace

std::variant<Motions, Objection> motions_of(const Question& question) {
  const auto began = Clock::now();
  const Scene& scene = *question.scene;
  Motions made;
  const auto motion = [&](std::optional<std::size_t> varied) {
    const auto equations = std::get<Motion::Equations>(equations_of(scene, varied));
    return std::make_shared<Motion>(equations, varied, question.settings[0]);
  };
  try {
    made.by_start = motion({});
    if (question.family && question.family->by == FamilyAsked::By::parameter)
      made.by_parameter = motion(question.family->index);
  } catch (const tape::TooManyOperations&) {
    return too_long();
  }
  made.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return made;
}

std::optional<Objection> objection(const Question& question) {
  const Scene& scene = *question.scene;
  const FamilyAsked* const family = question.family ? &*question.family : nullptr;
  const bool by_parameter = family && family->by == FamilyAsked::By::parameter;
  const auto too_many = [](std::size_t components) {
    return Objection{"/problem",
                     "the motion has " + std::to_string(components) + " variables: too many for an orbit to be closed",
                     "at most " + std::to_string(most_components)};
  };
  // Checked before the equations are derived, which may be expensive
  if (const text::TextScene* text = scene.mechanics->text()) {
    const std::size_t count = text->form->coordinates * (text->form->kind == text::FormKind::flow ? 1 : 2);
    if (count > most_components) return too_many(count);
  }
  Motion::Equations equations;
  try {
    const std::optional<std::size_t> varied = by_parameter ? std::optional(family->index) : std::nullopt;
    auto made = equations_of(scene, varied);
    if (auto* why = std::get_if<std::string>(&made)) return Objection{"/problem", std::move(*why), {}};
    equations = std::get<Motion::Equations>(std::move(made));
    if (equations->components > most_components) return too_many(equations->components);
  } catch (const tape::TooManyOperations&) {
    return too_long();
  }
  const auto moves = [&](std::size_t variable) {
    return std::ranges::find(equations->variables, variable) != equations->variables.end();
  };
  for (std::size_t i = 0; i < question.fixed.size(); ++i)
    if (!moves(question.fixed[i]))
      return Objection{"/fixed/" + std::to_string(i), "the motion does not depend on it", {}};
  const Rates rates = rates_of(equations);
  const std::vector<double> x = components_of(*equations, scene);
  const bool driven = !repeats(rates, rates, x, scene.start, question.period, 0.123456 * question.period) ||
                      !repeats(rates, rates, x, scene.start, question.period, 0.5 * question.period);
  if (driven && !repeats(rates, rates, x, scene.start, question.period, question.period))
    return Objection{"/period",
                     "the equations of motion do not repeat after it: an orbit can close only after the "
                     "period of what drives it, or several of them",
                     "a multiple of the period of the drive"};
  if (question.symmetric) {
    if (driven) return Objection{"/symmetric", "the scene is driven: its orbits are not reversed in time", "false"};
    if (!reversed_components(rates, x, scene.start, equations->coordinates))
      return Objection{"/symmetric",
                       "the start is no crossing at right angles: no reversal of time keeps the equations that changes "
                       "the signs of variables that are 0 there",
                       "false, or a start in which half of the variables are exactly 0, as y and px"};
  }
  if (!family) return std::nullopt;
  const bool no_energy = equations->energy.is_constant() && std::isnan(equations->energy.constant());
  using By = FamilyAsked::By;
  if (family->by == By::energy && no_energy) return Objection{"/family/by", "this scene has no energy", {}};
  if (family->by == By::start && !moves(family->index))
    return Objection{"/family/by", "the motion does not depend on it", {}};
  if (family->by == By::start && std::ranges::find(question.fixed, family->index) != question.fixed.end())
    return Objection{"/family/by", "is fixed", {}};
  if (family->by == By::period && driven)
    return Objection{"/family/by", "the period is that of the drive", "a parameter of the drive"};
  if (by_parameter && driven && !period_law(question))
    return Objection{"/family/by", "the period of the drive depends on it in a way that is not known", {}};
  return std::nullopt;
}

Answer close_orbit(const Question& question, const Motions& motions, const std::atomic<bool>& cancelled,
                   const std::function<bool(const Member&)>& take) {
  const auto began = Clock::now();
  const std::chrono::duration<double> limit(question.limits.seconds - motions.seconds);
  Effort effort([&] { return !cancelled && Clock::now() - began < limit; }, question.limits.steps);
  Answer answer;
  Closing closing(question, motions.by_start, effort, answer);
  if (const auto closed = closing.go()) {
    if (question.family) {
      Setting setting = closing.setting();
      const bool driven = setting.law != PeriodLaw::free;
      setting.guess_period = closed->period;
      if (question.family->by == FamilyAsked::By::parameter) {
        setting.varied = question.family->index;
        setting.guess_value = question.scene->parameters[question.family->index];
        if (driven) setting.law = *period_law(question);
        // Where energy is conserved there is an orbit for each energy: the next member is the one of the same period.
        const bool of_one_energy = closing.shooting().conserved().keeps_energy();
        setting.period_held = of_one_energy && question.fixed.empty();
        if (setting.period_held) setting.law = PeriodLaw::kept;
      }
      const auto& motion = motions.by_parameter ? motions.by_parameter : motions.by_start;
      answer.family_end = follow_family(question, std::move(setting), motion, *closed, effort, [&](Member&& member) {
        if (take) return take(member);
        const std::size_t n = member.orbit.rows.size();
        answer.held.add(sizeof(Member) + (n * n + 8 * n) * sizeof(double) + member.orbit.scene->initial.size() * 8);
        answer.family.push_back(std::move(member));
        return true;
      });
    }
    if (question.manifolds && !effort.over()) {
      answer.held.add(bytes_of_manifolds(question, closed->nodes[0].size()));
      answer.manifolds = manifolds_of(question, closing.setting(), *motions.by_start, *closed, effort);
    }
  }
  if (effort.over())
    answer.end = effort.out_of_steps() ? ReturnCode::step_limit
                 : cancelled           ? ReturnCode::cancelled
                                       : ReturnCode::deadline;
  answer.steps = effort.steps();
  answer.seconds = motions.seconds + std::chrono::duration<double>(Clock::now() - began).count();
  return answer;
}

}  // namespace least::periodic

// Studies: what accuracy costs with each scheme on a scene, which scheme to take, how long a step may be. All answers
// come from runs measured against a reference solution. *Error* is meant as the API defines it, in the norm that the
// scene's request names (core/state_error.hpp).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/run/request.hpp"
#include "core/run/stability.hpp"
#include "core/status.hpp"

namespace least {

/// SchemeConfig is a scheme with all its settings, in the order of its card.
struct SchemeConfig {
  std::size_t scheme = 0;
  std::vector<double> settings;
};

/// name returns a choice in words, such as "leapfrog, kahan_li_6", without the setting that a study varies.
std::string name(const SchemeCard& card, const SchemeConfig& choice);

/// StudyPoint is one run of a study.
struct StudyPoint {
  double value = 0;  ///< of the varied setting
  double step = 0;   ///< of the run; NaN where the scheme has no such setting
  double error = 0;  ///< NaN where the run did not complete
  std::int64_t force_evaluations = 0;
  double seconds = 0;  ///< the smallest of several runs, on this machine
  ReturnCode status = ReturnCode::completed;
};

/// StudyCurve holds the runs of one scheme.
struct StudyCurve {
  SchemeConfig scheme;       ///< as it was asked for
  std::string_view setting;  ///< step | sigma | theta | tolerance
  std::vector<StudyPoint> points;
  double observed_order = std::numeric_limits<double>::quiet_NaN();  ///< NaN where not measured; `why` says why
  int expected_order = 0;  ///< 0 where none is declared, as the scheme is adaptive
  std::string why;
};

/// ParetoPoint is a completed run that no other beats both in error and in force evaluations, or both in error and in
/// seconds.
struct ParetoPoint {
  std::size_t curve = 0, point = 0;
  bool fewest_forces = false, fastest = false;
};

/// Study is the result of work_precision.
struct Study {
  std::string_view how;                                           ///< closed form | quad (or double) precision run
  double uncertainty = std::numeric_limits<double>::quiet_NaN();  ///< of the reference
  double floor = std::numeric_limits<double>::quiet_NaN();        ///< errors below are meaningless
  double growth = 1;     ///< of small differences over the span; it limits how well states can be known
  bool chaotic = false;  ///< the growth is exponential throughout the span
  double end = 0;        ///< errors are measured up to this time; before the requested end where the motion ends before
  std::vector<StudyCurve> curves;           ///< in the order of the plan's schemes
  std::vector<ParetoPoint> pareto;          ///< from few force evaluations to many
  std::vector<Message> left_out;            ///< what was left out, and why
  ReturnCode stop = ReturnCode::completed;  ///< why the reference was not finished
};

/// StudyPlan is the request for work_precision.
struct StudyPlan {
  Request scene;                      ///< problem, parameters, start and end time; the rest is not read
  std::vector<SchemeConfig> schemes;  ///< the search for the first point begins at their value of the varied setting
  bool at_end = true;                 ///< the error of the final state; else the largest along the span
  double budget_seconds = 10;
  std::int64_t most_forces = 20'000'000;      ///< limit for one run
  std::function<void(const Study&)> begun{};  ///< called once when how, floor, growth and end are known; may be empty
};

/// work_precision runs each scheme from its longest useful step down to round-off, always the cheapest next run first.
/// Points and counts do not depend on the machine unless the budget runs out; then left_out says what is missing.
/// seen(index, curve) is called for each new point, which is the last of that curve; false ends the study.
Study work_precision(const StudyPlan& plan, const std::function<bool(std::size_t, const StudyCurve&)>& seen,
                     const std::atomic<bool>& cancelled);

/// Keep is what a chosen scheme has to conserve.
struct Keep {
  bool energy = false;     ///< symplectic or contact, or symmetric where the motion conserves its energy
  bool structure = false;  ///< the symplectic or the contact form
  bool momenta = false;    ///< the momenta that belong to symmetries
};

/// Wish is what a chosen scheme has to achieve.
struct Wish {
  double accuracy = 0;  ///< the largest error along the span; NaN: the best within `seconds`
  double seconds = 0;   ///< of the run itself; read where accuracy is NaN
  Keep keep;
};

/// Alternative is another measured run that grants the wish.
struct Alternative {
  SchemeConfig scheme;
  std::int64_t force_evaluations = 0;
  double estimated_error = 0, seconds = 0;
};

/// Advice is the result of advise.
struct Advice {
  std::optional<SchemeConfig> choice;  ///< empty where no scheme fits the wish's `keep`, or none completes
  Message reason;                      ///< why this choice; or what is best, and why there is nothing better
  /// Against the reference, or against half the step; NaN where errors at the end are meaningless and others were
  /// measured.
  double estimated_error = std::numeric_limits<double>::quiet_NaN();
  bool met = false;
  std::vector<Alternative> alternatives;  ///< cheapest first, without the choice
  /// Whether `met` is certain: not where runs were only compared with half the step, or errors are known for a part of
  /// the span only.
  bool known = true;
  bool referenced = true;  ///< errors were measured against a reference solution
  /// Act is an event that acts: the motion was studied up to it only, while the run goes beyond.
  struct Act {
    std::string event;
    double t = 0;
  };
  std::optional<Act> before_act{};
};

/// advise returns the measured run with the fewest force evaluations that grants the wish. If the motion is chaotic for
/// so long that errors at its end are meaningless, it is studied up to the time until which they are not, and only a
/// wish for seconds can be met. Errors use the relative norm and are measured up to the scene's first stopping event.
/// It takes at most half of scene.limits.seconds, and returns a choice even if that runs out: an unmeasured one if no
/// run was measured. The same wish gets the same answer unless the time runs out or the wish is for seconds. The scene
/// must have an end time.
Advice advise(const Request& scene, const Wish& wish, const std::atomic<bool>& cancelled);

/// The largest stable step of a scheme on a scene.
struct StabilityLimit {
  SchemeConfig scheme;
  double step = std::numeric_limits<double>::quiet_NaN();  ///< NaN where there is none, see `why`
  /// of steps just beyond: energy_growth | sign_flip | solver_failed | pole | not_finite; or empty
  std::string_view failure;
  /// Of linear theory; NaN where it has none; 0: unstable at every step
  double theory = std::numeric_limits<double>::quiet_NaN();
  std::vector<Interval> islands{};                            ///< of stable steps beyond `theory`
  double failing = std::numeric_limits<double>::quiet_NaN();  ///< the shortest step found to fail, just beyond
  std::string why{};                                          ///< why there is no limit; or empty
};

/// longest_stable_step_of finds the limit to one part in a thousand. All shorter steps that were tried run without
/// failure and without growth over 2,000 steps and at least the span: the energy's range over the second half is at
/// most twice that over the first half (or the state's size relative to that of the true motion, where no energy is
/// conserved), or both are below 1e-3. Where the true motion grows by more than a factor two, a run may grow at one and
/// a half times its rate.
StabilityLimit longest_stable_step_of(const Request& scene, const SchemeConfig& scheme,
                                      const std::atomic<bool>& cancelled);

/// truth returns the true states of a scene at ascending times. Results are cached for scenes of equal content: at most
/// 64, of 16 MiB together. Thread-safe. `keep_going` is called now and then; false gives up.
std::shared_ptr<const Truth> truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going);
/// conditioning returns the growth of small differences up to the time `end`; cached in the same way.
std::shared_ptr<const Conditioning> conditioning(const Scene& scene, double end, const KeepGoing& keep_going);

}  // namespace least

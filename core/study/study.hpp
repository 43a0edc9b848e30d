// Studies: what accuracy costs on a scene with each scheme, which scheme to take, how long a step may be. Everything is
// found by measured runs against a reference solution. *Error* is the contract's, in the norm that the scene's request
// names (core/state_error.hpp).
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

/// A scheme with all its settings, in the order of its card.
struct SchemeConfig {
  std::size_t scheme = 0;
  std::vector<double> settings;
};

/// The choice of this scheme in words, as "leapfrog, kahan_li_6", without the setting that a study varies.
std::string name(const SchemeCard& card, const SchemeConfig& choice);

/// One run of a study.
struct StudyPoint {
  double value = 0;  ///< of the setting that was varied
  double step = 0;   ///< of the run; NaN where the scheme has no such setting
  double error = 0;  ///< NaN where the run did not complete
  std::int64_t force_evaluations = 0;
  double seconds = 0;  ///< the smallest of some runs, on this machine
  ReturnCode status = ReturnCode::completed;
};

struct StudyCurve {
  SchemeConfig scheme;       ///< as it was asked for
  std::string_view setting;  ///< step | sigma | theta | tolerance
  std::vector<StudyPoint> points;
  double observed_order = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured, `why` says why not
  int expected_order = 0;                                            ///< 0: adaptive, none declared
  std::string why;
};

/// A completed point that no other beats in error and in force evaluations, or in error and in seconds.
struct ParetoPoint {
  std::size_t curve = 0, point = 0;
  bool fewest_forces = false, fastest = false;
};

struct Study {
  std::string_view how;                                           ///< closed form | quad (or double) precision run
  double uncertainty = std::numeric_limits<double>::quiet_NaN();  ///< of the reference
  double floor = std::numeric_limits<double>::quiet_NaN();        ///< errors below mean nothing
  double growth = 1;     ///< of small differences over the span: how well states can be known
  bool chaotic = false;  ///< it is exponential all along the span
  double end = 0;        ///< time up to which errors are measured: earlier than asked for where the motion ends before
  std::vector<StudyCurve> curves;           ///< in the order of the plan's schemes
  std::vector<ParetoPoint> pareto;          ///< from few force evaluations to many
  std::vector<Message> left_out;            ///< what, and why
  ReturnCode stop = ReturnCode::completed;  ///< else why the reference was not finished
};

struct StudyPlan {
  Request scene;                      ///< problem, parameters, start, end in time; nothing else of it is read
  std::vector<SchemeConfig> schemes;  ///< the varied setting is where the search for the first point begins
  bool at_end = true;                 ///< error of the final state, else the largest along the span
  double budget_seconds = 10;
  std::int64_t most_forces = 20'000'000;      ///< of one run
  std::function<void(const Study&)> begun{};  ///< told once how, floor, growth and end are known; may be empty
};

/// Runs each scheme from its longest useful step down to round-off, all side by side, the cheapest next run first.
/// Points and counts do not depend on the machine unless the budget runs out; then left_out says what is missing.
/// `seen(curve index, curve so far with its newest point last)` is called as points come; false ends the study.
Study work_precision(const StudyPlan& plan, const std::function<bool(std::size_t, const StudyCurve&)>& seen,
                     const std::atomic<bool>& cancelled);

/// What is to be kept by a scheme that is chosen.
struct Keep {
  bool energy = false;     ///< symplectic or contact, or symmetric where the motion keeps its energy
  bool structure = false;  ///< the symplectic or the contact form
  bool momenta = false;    ///< the momenta of symmetries
};

struct Wish {
  double accuracy = 0;  ///< the largest error along the span; NaN: the best within `seconds`
  double seconds = 0;   ///< of the run itself; read where accuracy is NaN
  Keep keep;
};

/// A measured run that grants the wish.
struct Alternative {
  SchemeConfig scheme;
  std::int64_t force_evaluations = 0;
  double estimated_error = 0, seconds = 0;
};

struct Advice {
  std::optional<SchemeConfig> choice;  ///< empty where no scheme fits the wish's `keep`, or none completes
  Message reason;                      ///< in words: why this one; or what the best is, and why there is nothing better
  /// Against the reference, or at half the step; NaN where errors at the end mean nothing, and others were measured.
  double estimated_error = std::numeric_limits<double>::quiet_NaN();
  bool met = false;
  std::vector<Alternative> alternatives;  ///< cheapest first, without the choice
  /// Whether `met` can be told: not where only runs of half the step were compared, or where errors are known over a
  /// part of the span only.
  bool known = true;
  bool referenced = true;  ///< errors were measured against a reference solution
  /// An event that acts: the motion was looked at up to there, and the run goes beyond.
  struct Act {
    std::string event;
    double t = 0;
  };
  std::optional<Act> before_act{};
};

/// The cheapest measured run that grants the wish, by force evaluations. Of a motion that is chaotic for so long that
/// errors at its end mean nothing: up to the time where they do, and so nothing is met but a wish for seconds. Errors
/// are those of the relative norm, and are measured up to the first stopping event of the scene's. Takes half of
/// scene.limits.seconds at most, and has a choice even then: a run that was not measured, where none was. The same wish
/// gets the same answer unless that time runs out or seconds are what is wished for. The scene ends at a time.
Advice advise(const Request& scene, const Wish& wish, const std::atomic<bool>& cancelled);

/// The largest stable step of a scheme on a scene.
struct StabilityLimit {
  SchemeConfig scheme;
  double step = std::numeric_limits<double>::quiet_NaN();  ///< NaN: there is none, see `why`
  std::string_view failure;  ///< just beyond: energy_growth | sign_flip | solver_failed | pole | not_finite; or empty
  double theory = std::numeric_limits<double>::quiet_NaN();   ///< NaN: none; 0: it grows at every step
  std::vector<Interval> islands{};                            ///< of stable steps beyond `theory`
  double failing = std::numeric_limits<double>::quiet_NaN();  ///< the shortest step found to fail, just beyond
  std::string why{};                                          ///< there is no limit, in words; or empty
};

/// To one part in a thousand: every shorter step that was looked at is accepted by a run and does not grow over 2,000
/// steps and at least the span: the energy's range over the second half is at most twice that over the first, or the
/// state's size where no energy is kept, relative to that of the true motion; or both are below 1e-3. Where the true
/// motion grows by more than twice, a run may grow at one and a half times its rate.
StabilityLimit longest_stable_step_of(const Request& scene, const SchemeConfig& scheme,
                                      const std::atomic<bool>& cancelled);

/// The true states of a scene at increasing times. Kept for the next question about a scene of the same content; at
/// most 64 of them, of 16 MiB together. Thread-safe. `keep_going` is asked now and then; false gives up.
std::shared_ptr<const Truth> truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going);
/// Up to the time `end`; kept in the same way.
std::shared_ptr<const Conditioning> conditioning(const Scene& scene, double end, const KeepGoing& keep_going);

}  // namespace least

// A scene under study: what is known of its motion, and runs measured against it.
#pragma once

#include <algorithm>
#include <optional>

#include "core/clock.hpp"
#include "core/study/study.hpp"

namespace least {

/// ResolutionParameter is the setting that controls how fine a scheme is (the "dial"), from coarse (large) to fine.
struct ResolutionParameter {
  std::string_view name;                 ///< step | sigma | theta | tolerance
  std::size_t index = 0;                 ///< among the scheme's parameters
  std::optional<std::size_t> companion;  ///< a setting that is scaled along with it: the time step of a scheme with θ
  Range range{0, 0};

  explicit ResolutionParameter(const SchemeCard& card);
  bool adaptive() const { return name == "tolerance"; }
  double value(const SchemeConfig& choice) const { return choice.settings[index]; }
  /// at(choice, value) returns the choice with the dial at `value`, clamped to its range.
  SchemeConfig at(const SchemeConfig& choice, double value) const;
};

/// declared_order returns the order that the card declares for these settings; 0 where the dial is a tolerance.
int declared_order(const SchemeCard& card, const SchemeConfig& choice);

/// suggested_candidates returns every applicable scheme with the settings suggested for the scene: without and with
/// some compositions, with each splitting that has an order of its own, and with some fixed orders where the tolerance
/// would choose the order.
std::vector<SchemeConfig> suggested_candidates(const Scene& scene, const Keep& keep);
/// catalogue_candidates does the same with the settings that the catalogue suggests for the problem.
std::vector<SchemeConfig> catalogue_candidates(const Mechanics& mechanics, const Keep& keep);

/// nothing_moves_in tells whether a scene given as text starts at 0 in all variables and rests there, of which runs
/// warn (core/run/warnings.hpp): there is nothing to be studied.
bool nothing_moves_in(const Scene& scene, const Conditioning& motion);

/// Deadline is a limit of time that starts when it is made.
class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  double passed() const { return read_clock() - start_; }
  double left() const { return seconds_ - passed(); }

 private:
  double start_ = read_clock(), seconds_;
};

/// Trial is the result of one run.
struct Trial {
  ReturnCode status = ReturnCode::completed;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< NaN where the run did not complete
  std::int64_t forces = 0;
  double seconds = 0;
  /// The error grew beyond meaning; `error` is extrapolated from the times when it was still small
  bool foreseen = false;
};

/// ErrorStudy measures the errors of runs of one scene.
class ErrorStudy {
 public:
  /// The constructor finds the reference solution and the growth of small differences; that may take `seconds`, and
  /// ends once `cancelled` is set. `known` is the growth if it was found before; may be null.
  ErrorStudy(const Request& scene, bool at_end, double seconds, const std::atomic<bool>& cancelled,
             std::shared_ptr<const Conditioning> known = nullptr);

  /// known() tells whether there is a reference solution. Where there is none, runs are compared with runs of half the
  /// step (a hundredth of the tolerance), or with a stand-in.
  bool known() const { return truth_->complete; }
  /// let_stand_in uses a run of this choice instead of the reference, if it reaches the end within so many seconds.
  void let_stand_in(const SchemeConfig& choice, double seconds);
  bool has_stand_in() const { return !stand_in_.empty(); }
  const SchemeCard& card(const SchemeConfig& choice) const { return scene_.scene->mechanics->schemes()[choice.scheme]; }
  ResolutionParameter dial(const SchemeConfig& choice) const { return ResolutionParameter(card(choice)); }
  const Truth& truth() const { return *truth_; }
  const Conditioning& conditioning() const { return *conditioning_; }
  /// partial() tells whether the motion ends before the scene does, so that errors are measured over a part of the span
  /// only. A motion that leaves its domain does not count: there is no other part of it.
  bool partial() const { return conditioning_->ends && !conditioning_->leaves; }
  /// floor() returns the error below which errors are meaningless, from conditioning and from the reference's
  /// uncertainty.
  double floor() const;
  /// round_off(): errors below it that do not fall any more are round-off; errors above may fall again, in particular
  /// those of a chaotic motion, which stay as large as the motion until a run follows it to the end.
  double round_off() const {
    const double most = conditioning_->chaotic(scene_.norm) ? 0.03 : std::numeric_limits<double>::infinity();
    return std::max(1e-3, std::min(100 * floor(), most));
  }
  /// plateau() is the same for a search, which foresees the errors of a chaotic motion.
  double plateau() const { return conditioning_->chaotic(scene_.norm) ? 1 : round_off(); }
  double start() const { return scene_.scene->start; }
  double end() const { return scene_.end; }
  bool ends_early() const { return conditioning_->ends; }

  /// end_with sets a deadline for searches; it must outlive the ErrorStudy.
  void end_with(const Deadline& deadline) { deadline_ = &deadline; }
  /// longest returns the value of the dial at which a run takes about one step.
  double longest(const SchemeConfig& choice, const ResolutionParameter& dial) const;
  /// run makes a run of at most so many seconds and steps, and measures its error.
  Trial run(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;
  /// look does the same for a search. A run that misses the accuracy is only a probe, and its error is taken at some of
  /// the times only, at few of them above the plateau: interpolated states are most of the cost of a run with few long
  /// steps.
  Trial look(const SchemeConfig& choice, double seconds, std::int64_t step_limit, double accuracy) const;
  /// time returns the smallest time of runs that record nothing: of three, or of as many as take two milliseconds.
  double time(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;

 private:
  using States = std::vector<std::vector<double>>;

  double foreseen_error(const std::vector<double>& times, const States& states, const States& truth) const;

  Request request(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;
  Trial run(Request measured, const std::vector<double>& times, States& states) const;
  double error(const States& states, const States& truth, std::span<const double> sizes) const;
  std::span<const double> known_sizes() const { return truth_->sizes_in(scene_.norm); }
  /// The component sizes along a motion that is known from a run only.
  std::vector<double> sizes_along(const States& states) const;

  Request scene_;  ///< ends where the motion ends
  bool at_end_;
  const std::atomic<bool>& cancelled_;
  const Deadline* deadline_ = nullptr;
  std::shared_ptr<const Conditioning> conditioning_;
  std::vector<double> times_;
  std::shared_ptr<const Truth> truth_;
  States stand_in_;  ///< states at times_
};

}  // namespace least

// A scene under study: what is known of its motion, and runs measured against that.
#pragma once

#include <algorithm>
#include <optional>

#include "core/clock.hpp"
#include "core/study/study.hpp"

namespace least {

/// The setting that decides how fine a scheme is, from coarse to fine.
struct ResolutionParameter {
  std::string_view name;                 ///< step | sigma | theta | tolerance
  std::size_t index = 0;                 ///< among the scheme's parameters
  std::optional<std::size_t> companion;  ///< scaled with it: the step in time of a scheme with θ
  Range range{0, 0};

  explicit ResolutionParameter(const SchemeCard& card);
  bool adaptive() const { return name == "tolerance"; }
  double value(const SchemeConfig& choice) const { return choice.settings[index]; }
  /// The choice at another value, brought into its range.
  SchemeConfig at(const SchemeConfig& choice, double value) const;
};

/// The order that the card declares for these settings; 0 where the dial is a tolerance.
int declared_order(const SchemeCard& card, const SchemeConfig& choice);

/// Every scheme that applies, as it is suggested for the scene: with none and some compositions, with the
/// splittings that have an order of their own, and where it chooses its order by the tolerance with some others.
std::vector<SchemeConfig> suggested_candidates(const Scene& scene, const Keep& keep);
/// The same as the catalogue suggests it for the problem.
std::vector<SchemeConfig> catalogue_candidates(const Mechanics& mechanics, const Keep& keep);

/// A time that is not to be exceeded.
class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  double passed() const { return read_clock() - start_; }
  double left() const { return seconds_ - passed(); }

 private:
  double start_ = read_clock(), seconds_;
};

/// What one run said.
struct Trial {
  ReturnCode status = ReturnCode::completed;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< NaN where the run did not complete
  std::int64_t forces = 0;
  double seconds = 0;
  bool foreseen = false;  ///< the error has grown until it means nothing: what it would be, were it still small
};

class ErrorStudy {
 public:
  /// Finds out about the motion: that may take `seconds`, and ends where `cancelled` says so. `known`: what was already
  /// found out about how differences grow along it; may be null.
  ErrorStudy(const Request& scene, bool at_end, double seconds, const std::atomic<bool>& cancelled,
             std::shared_ptr<const Conditioning> known = nullptr);

  /// Whether there is a truth to measure against. Where there is none, runs are held against their like of half the
  /// step, or against what stands in for it.
  bool known() const { return truth_->complete; }
  /// Where there is no truth: a run of this choice stands in for it, if it comes to the end in so many seconds.
  void let_stand_in(const SchemeConfig& choice, double seconds);
  bool has_stand_in() const { return !stand_in_.empty(); }
  const SchemeCard& card(const SchemeConfig& choice) const { return scene_.scene->mechanics->schemes()[choice.scheme]; }
  ResolutionParameter dial(const SchemeConfig& choice) const { return ResolutionParameter(card(choice)); }
  const Truth& truth() const { return *truth_; }
  const Conditioning& conditioning() const { return *conditioning_; }
  /// Whether the motion is known to end before the scene does, so that errors are measured over a part of it only. One
  /// that leaves its domain has no other part.
  bool partial() const { return conditioning_->ends && !conditioning_->leaves; }
  /// Errors below mean nothing.
  double floor() const;
  /// Errors below that no longer fall are round-off: above, they may fall again.
  double plateau() const { return conditioning_->chaotic(scene_.norm) ? 1 : std::max(1e-3, 100 * floor()); }
  double start() const { return scene_.scene->start; }
  double end() const { return scene_.end; }
  bool ends_early() const { return conditioning_->ends; }

  /// What is looked for ends with this, which outlives it.
  void end_with(const Deadline& deadline) { deadline_ = &deadline; }
  /// The dial's value at which a run takes about one step.
  double longest(const SchemeConfig& choice, const ResolutionParameter& dial) const;
  /// A run, at most so many seconds and steps long.
  Trial run(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;
  /// The same of a search: of what is not accurate enough, which is only a probe, the error is that at some of the
  /// times, above the plateau at few of them: states between steps are most of what a run of few long steps costs.
  Trial look(const SchemeConfig& choice, double seconds, std::int64_t step_limit, double accuracy) const;
  /// The smallest time of runs that keep nothing: of three, or as many as take two milliseconds.
  double time(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;

 private:
  using States = std::vector<std::vector<double>>;

  double foreseen_error(const std::vector<double>& times, const States& states, const States& truth) const;

  Request request(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const;
  Trial run(Request measured, const std::vector<double>& times, States& states) const;
  double error(const States& states, const States& truth, std::span<const double> sizes) const;
  std::span<const double> known_sizes() const { return truth_->sizes_in(scene_.norm); }
  /// Of a motion that only a run is known of.
  std::vector<double> sizes_along(const States& states) const;

  Request scene_;  ///< up to where the motion goes
  bool at_end_;
  const std::atomic<bool>& cancelled_;
  const Deadline* deadline_ = nullptr;
  std::shared_ptr<const Conditioning> conditioning_;
  std::vector<double> times_;
  std::shared_ptr<const Truth> truth_;
  States stand_in_;  ///< at the same times
};

}  // namespace least

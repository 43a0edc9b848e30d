#include <algorithm>
#include <cmath>

#include "core/composition.hpp"
#include "core/problem_traits.hpp"
#include "core/run/stability.hpp"
#include "core/study/error_study.hpp"

namespace least {
namespace {

/// Looks at every sample as it comes: how far the state gets from zero.
class Size final : public RowSink {
 public:
  bool append(std::span<const double> rows) override {
    for (const double x : rows) most = std::isnan(x) || std::abs(x) > most ? std::abs(x) : most;
    return true;
  }
  double most = 0;
};

/// Long runs at constant steps.
class LongRun {
 public:
  LongRun(const Request& scene, const SchemeConfig& scheme, const std::atomic<bool>& cancelled)
      : request_(scene),
        cancelled_(cancelled),
        motion_(conditioning(*scene.scene, scene.end, [&] { return !cancelled.load(std::memory_order_relaxed); })) {
    if (motion_->ends) request_.end = motion_->reached;
    request_.scheme = scheme.scheme;
    request_.settings = scheme.settings;
    request_.columns.clear();
    for (std::size_t i = 0; i < motion_->variables; ++i) request_.columns.push_back(i + 1);
    request_.diagnostics.clear();
  }

  const Conditioning& motion() const { return *motion_; }
  double span() const { return request_.end - request_.scene->start; }

  /// How a run of steps h fails; empty: it does not.
  std::string_view failure(std::size_t setting, double h) const {
    constexpr std::int64_t least_steps = 2000, samples = 200;
    Request request = request_;
    request.settings[setting] = h;
    // Where the motion ends, no further than there.
    request.until_steps = true;
    request.steps = static_cast<std::int64_t>(std::min(std::ceil(span() / h), 1e5));
    if (!motion_->ends) request.steps = std::max(request.steps, least_steps);
    if (motion_->ends) request.until_steps = false;
    request.record = {Record::Mode::every, std::max<std::int64_t>(request.steps / samples, 1), {}};
    Size size;
    const Solution outcome = request.scene->mechanics->run(request, size, cancelled_);
    for (std::size_t i = 0; i < motion_->variables; ++i) size.append({&outcome.final[i], 1});
    const auto flips = [](const Warning& warning) { return warning.code == "damping_sign"; };
    const double spans = motion_->travels() ? std::max((outcome.t - request.scene->start) / span(), 1.0) : 1;
    if (!(size.most < far * spans * std::max(motion_->size, 1e-300))) return "energy_growth";
    switch (outcome.stop.reason) {
      case ReturnCode::completed:
      case ReturnCode::deadline:
      case ReturnCode::cancelled:
      case ReturnCode::step_limit:
      case ReturnCode::left_domain:  // the motion itself ends
        return std::ranges::any_of(outcome.warnings, flips) ? "sign_flip" : "";
      case ReturnCode::unstable_step:
        return "energy_growth";
      case ReturnCode::singular:
        return "pole";
      case ReturnCode::solver_failed:
      case ReturnCode::parameter_step_underflow:
        return "solver_failed";
      default:
        return "not_finite";
    }
  }

 private:
  static constexpr double far = 100;  ///< how many times the size of the true motion a bounded one may have

  Request request_;
  const std::atomic<bool>& cancelled_;
  std::shared_ptr<const Conditioning> motion_;
};

/// What linear theory says of the step at which it fails in this way, where the motion has one frequency: that of its
/// small oscillations.
double theory(const Conditioning& motion, const SchemeCard& card, const SchemeConfig& scheme, std::string_view failure,
              double most) {
  double bound = unknown;
  if (failure == "sign_flip") return 2 / motion.damping;
  if (failure == "pole" && motion.damping > 0) {
    if (const auto i = card.find("composition"))
      bound = 2 / (motion.damping * largest_negative_weight(static_cast<Composition>(scheme.settings[*i])));
    return std::isfinite(bound) ? bound : unknown;
  }
  if (!(motion.fastest - motion.slowest <= 1e-12 * motion.fastest) || !(motion.fastest > 0)) return unknown;
  const double alpha = motion.damping > 0 ? motion.damping : 0;
  if (alpha > 0) {
    bound = longest_stable_step(scheme.scheme, scheme.settings, motion.fastest, alpha, most);
    return bound < 0.999 * most ? bound : unknown;
  }
  bound = stability_bound(scheme.scheme, scheme.settings, 0) / motion.fastest;
  return std::isfinite(bound) ? bound : unknown;
}

}  // namespace

StabilityLimit longest_stable_step_of(const Request& scene, const SchemeConfig& scheme,
                                      const std::atomic<bool>& cancelled) {
  StabilityLimit limit;
  limit.scheme = scheme;
  const SchemeCard& card = scene.scene->mechanics->schemes()[scheme.scheme];
  const ResolutionParameter dial(card);
  if (card.own_clock || dial.name != "step") return limit;
  const LongRun run(scene, scheme, cancelled);
  const double most = std::min(run.span(), dial.range.high);
  // From below, so that what is found is the first limit and no island beyond it.
  constexpr int halvings = 10;
  double stable = 0, failing = most;
  for (int k = -2 * halvings; k <= 0 && limit.failure.empty(); ++k) {
    const double h = most * std::exp2(0.5 * k);
    limit.failure = run.failure(dial.index, h);
    (limit.failure.empty() ? stable : failing) = h;
    if (cancelled.load(std::memory_order_relaxed)) return limit;
  }
  limit.theory = theory(run.motion(), card, scheme, limit.failure, most);
  if (limit.failure.empty()) return limit;
  while (failing - stable > 5e-4 * failing && failing > 1e-6 * most && !cancelled.load(std::memory_order_relaxed)) {
    const double middle = (stable + failing) / 2;
    const std::string_view failure = run.failure(dial.index, middle);
    if (!failure.empty()) limit.failure = failure;
    (failure.empty() ? stable : failing) = middle;
  }
  limit.step = stable;
  limit.theory = theory(run.motion(), card, scheme, limit.failure, most);
  return limit;
}

}  // namespace least

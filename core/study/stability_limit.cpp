#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/stability.hpp"
#include "core/study/error_study.hpp"

namespace least {
namespace {

/// What a run comes to, by halves of its span: looks at every state as it comes, a row being t, the variables and,
/// where one is kept, the energy.
class Excursions final : public RowSink {
 public:
  Excursions(std::size_t variables, bool energy, double middle)
      : variables_(variables), energy_(energy), middle_(middle) {}

  bool append(std::span<const double> rows) override {
    for (const std::size_t width = 1 + variables_ + (energy_ ? 1 : 0); !rows.empty(); rows = rows.subspan(width)) {
      Half& half = halves[rows[0] > middle_ ? 1 : 0];
      for (std::size_t i = 1; i <= variables_; ++i) half.size = larger(half.size, std::abs(rows[i]));
      if (!energy_) continue;
      half.highest = larger(half.highest, rows[width - 1]);
      half.lowest = -larger(-half.lowest, -rows[width - 1]);
    }
    return true;
  }

  struct Half {
    double size = 0;
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;  ///< energy
    double range() const { return highest < lowest ? 0 : highest - lowest; }
  };
  Half halves[2];

 private:
  static double larger(double most, double x) { return std::isnan(x) || x > most ? x : most; }

  std::size_t variables_;
  bool energy_;
  double middle_;
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
    for (std::size_t i = 0; i <= motion_->variables; ++i) request_.columns.push_back(i);
    const auto& columns = scene.scene->card().columns;
    const auto energy = std::ranges::find(columns, "energy", &ColumnCard::name);
    if (keeps_energy()) request_.columns.push_back(static_cast<std::size_t>(energy - columns.begin()));
    request_.diagnostics.clear();
  }

  const Conditioning& motion() const { return *motion_; }
  double span() const { return request_.end - request_.scene->start; }

  /// How a run of steps h fails; empty: it does not.
  std::string_view failure(std::size_t setting, double h) const {
    constexpr std::int64_t least_steps = 2000, most_rows = 20'000;
    Request request = request_;
    request.settings[setting] = h;
    request.steps = static_cast<std::int64_t>(std::min(std::ceil(span() / h), 1e5));
    // Where the motion ends, or runs away, no further than what is known of it.
    request.until_steps = !motion_->ends && !runs_away();
    if (request.until_steps) request.steps = std::max(request.steps, least_steps);
    request.record = {Record::Mode::every, std::max<std::int64_t>(request.steps / most_rows, 1), {}};
    const double start = request.scene->start;
    const double end = request.until_steps ? start + static_cast<double>(request.steps) * h : request.end;
    Excursions seen(motion_->variables, keeps_energy(), (start + end) / 2);
    const Solution outcome = request.scene->mechanics->run(request, seen, cancelled_);
    for (std::size_t i = 0; i < motion_->variables; ++i) {
      double& size = seen.halves[outcome.t > (start + end) / 2 ? 1 : 0].size;
      if (!(std::abs(outcome.final[i]) <= size)) size = std::abs(outcome.final[i]);
    }
    if (grows(seen, (outcome.t - start) / span())) return "energy_growth";
    switch (outcome.stop.reason) {
      case ReturnCode::completed:
      case ReturnCode::deadline:
      case ReturnCode::cancelled:
      case ReturnCode::step_limit:
      case ReturnCode::left_domain:  // the motion itself ends
        for (const Warning& warning : outcome.warnings) {
          if (warning.code == "damping_sign") return "sign_flip";
          if (warning.code == "grows_at_every_step") return "energy_growth";
        }
        return "";
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
  bool keeps_energy() const { return motion_->energy > 0; }
  /// The motion grows, and not in proportion to the time as an angle that turns.
  bool runs_away() const { return motion_->size > 2.5 * motion_->size_halfway; }

  /// How far the motion has come in so many spans.
  double size_after(double spans) const {
    const double size = std::max(motion_->size, 1e-300);
    return motion_->travels() ? std::max(motion_->size_halfway, spans * size) : size;
  }
  /// Whether the second half of a run of so many spans goes far beyond its first, or the whole far beyond the motion.
  bool grows(const Excursions& seen, double spans) const {
    constexpr double far = 1000;      // times the size of the motion
    constexpr double small = 1e-3;    // excursions below are none
    constexpr double steadily = 2.0;  // how many times the first half's the second half's may be
    const auto& [first, second] = seen.halves;
    const double before = first.size / size_after(spans / 2), after = second.size / size_after(spans);
    if (!(before < far && after < far)) return true;
    const auto apart = [](double x, double y) { return !(y <= steadily * x) && !(x < small && y < small); };
    return keeps_energy() ? apart(first.range() / motion_->energy, second.range() / motion_->energy)
                          : apart(before, after);
  }

  Request request_;
  const std::atomic<bool>& cancelled_;
  std::shared_ptr<const Conditioning> motion_;
};

/// The search for the first step that fails, from below.
class FirstFailure {
 public:
  FirstFailure(const LongRun& run, std::size_t setting, double most, const std::atomic<bool>& cancelled)
      : run_(run), setting_(setting), most_(most), cancelled_(cancelled) {}

  /// `also`: a step to be looked at beside those of a grid; NaN: none.
  void search(double also) {
    constexpr int halvings = 10;
    std::vector<double> grid;
    for (int k = -2 * halvings; k <= 0; ++k) grid.push_back(most_ * std::exp2(0.5 * k));
    if (also < most_) grid.insert(std::ranges::upper_bound(grid, also), also);
    for (const double h : grid)
      if (!holds(h)) break;
    if (failure.empty()) return;
    // Where the motion is not linear steps that fail are scattered: below the first that was found there may be others.
    constexpr int rounds = 40;
    for (int round = 0; round < rounds && !cancelled_.load(std::memory_order_relaxed); ++round) {
      bisect();
      const double edge = stable();
      bool sure = true;
      for (double part = 0.99; part > 0.2 && sure; part -= part > 0.75 ? 0.01 : 0.05) sure = holds(part * edge);
      if (sure) break;
    }
  }
  double stable() const { return stable_.empty() ? 0 : stable_.back(); }
  double failing() const { return failing_; }

  std::string_view failure;  ///< empty: none was found

 private:
  bool holds(double h) {
    if (cancelled_.load(std::memory_order_relaxed)) return true;
    const std::string_view here = run_.failure(setting_, h);
    if (here.empty()) {
      stable_.insert(std::ranges::upper_bound(stable_, h), h);
    } else {
      failure = here;
      failing_ = h;
      while (!stable_.empty() && stable_.back() > h) stable_.pop_back();
    }
    return here.empty();
  }
  void bisect() {
    while (failing_ - stable() > 5e-4 * failing_ && failing_ > 1e-6 * most_ &&
           !cancelled_.load(std::memory_order_relaxed))
      holds((stable() + failing_) / 2);
  }

  const LongRun& run_;
  std::size_t setting_;
  double most_, failing_ = 0;
  std::vector<double> stable_;  ///< found stable, increasing, all below what fails
  const std::atomic<bool>& cancelled_;
};

}  // namespace

StabilityLimit longest_stable_step_of(const Request& scene, const SchemeConfig& scheme,
                                      const std::atomic<bool>& cancelled) {
  StabilityLimit limit;
  limit.scheme = scheme;
  const SchemeCard& card = scene.scene->mechanics->schemes()[scheme.scheme];
  const ResolutionParameter dial(card);
  if (card.own_clock || dial.name != "step") {
    limit.why = "it chooses its steps in time itself";
    return limit;
  }
  const LongRun run(scene, scheme, cancelled);
  const Conditioning& motion = run.motion();
  if (motion.damping == 0 && stability_bound(scheme.scheme, scheme.settings, 0, 0) == 0) {
    limit.step = limit.theory = 0;
    limit.failure = "energy_growth";
    return limit;
  }
  const double most = std::min(run.span(), dial.range.high);
  // Linear theory, where the motion has one frequency, that of its small oscillations, and one damping.
  double gap = unknown;
  if (motion.damping >= 0 && motion.fastest > 0 && motion.fastest - motion.slowest <= 1e-12 * motion.fastest) {
    const StableSteps steps = stable_steps(scheme.scheme, scheme.settings, motion.fastest, motion.damping, most);
    if (motion.fastest * steps.limit < far_turn) limit.theory = steps.limit;
    limit.islands = steps.islands;
    gap = (steps.limit + (steps.islands.empty() ? 1.01 * steps.limit : steps.islands.front().low)) / 2;
  }
  FirstFailure first(run, dial.index, most, cancelled);
  first.search(gap);
  limit.failure = first.failure;
  if (limit.failure.empty()) {
    limit.why = fmt::format("every step that was tried is stable, up to {:.4g}", most);
    return limit;
  }
  limit.step = first.stable();
  limit.failing = first.failing();
  if (limit.failure == "sign_flip") limit.theory = flips_from(scheme.scheme, scheme.settings) / motion.damping;
  return limit;
}

}  // namespace least

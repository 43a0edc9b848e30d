#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/stability.hpp"
#include "core/run/warnings.hpp"
#include "core/study/error_study.hpp"
#include "core/study/true_growth.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

/// RangesByHalf records what a run reaches in each half of its span. Rows are t, the variables and, where one is
/// conserved, the energy.
class RangesByHalf final : public RowSink {
 public:
  RangesByHalf(std::size_t variables, bool energy, double middle)
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

/// LongRun makes long runs at constant steps.
class LongRun {
 public:
  LongRun(const Request& scene, const SchemeConfig& scheme, const std::atomic<bool>& cancelled)
      : request_(scene), cancelled_(cancelled), motion_(motion_until(scene.end)) {
    if (motion_->ends) request_.end = motion_->reached;
    request_.scheme = scheme.scheme;
    request_.settings = scheme.settings;
    request_.columns.clear();
    for (std::size_t i = 0; i <= motion_->variables; ++i) request_.columns.push_back(i);
    const auto& columns = scene.scene->card().columns;
    const auto energy = std::ranges::find(columns, "energy", &ColumnCard::name);
    if (keeps_energy()) request_.columns.push_back(static_cast<std::size_t>(energy - columns.begin()));
    request_.diagnostics.clear();
    if (keeps_energy() && runs_away()) halfway_ = motion_until((start() + request_.end) / 2);
    if (!keeps_energy() && !motion_->ends) growth_.emplace(scene, motion_->variables, cancelled);
  }

  const Conditioning& motion() const { return *motion_; }
  double span() const { return request_.end - start(); }

  /// failure returns how a run with steps h fails; empty where it does not. Runs are `longer` times as long as they
  /// otherwise are.
  std::string_view failure(std::size_t setting, double h, double longer = 1) {
    constexpr double least_steps = 2000, most_steps = 1e5;
    Request request = request_;
    request.settings[setting] = h;
    // If the motion ends, or runs away, the run goes no further than the motion is known.
    request.until_steps = !motion_->ends && !(runs_away() && keeps_energy());
    const double steps = std::max(std::ceil(span() / h), request.until_steps ? least_steps : 1);
    request.steps = static_cast<std::int64_t>(std::min(longer * steps, most_steps));
    const Tried tried = run(request, h);
    const std::string_view found = failure_of(tried, [&](const Tried& run) { return grows(run); });
    if (found.empty() || found == "sign_flip" || !growth_) return found;
    return failure_beyond_the_motion(request, h, tried);
  }

 private:
  struct Tried {
    RangesByHalf seen;
    Solution outcome;
    double middle;
  };

  std::shared_ptr<const Conditioning> motion_until(double end) const {
    return conditioning(*request_.scene, end, [&] { return !cancelled_.load(std::memory_order_relaxed); });
  }
  double start() const { return request_.scene->start; }
  bool keeps_energy() const { return motion_->energy > 0; }
  /// runs_away(): the motion grows, and faster than in proportion to time as a rotating angle does.
  bool runs_away() const { return motion_->size > 2.5 * motion_->size_halfway; }

  Tried run(Request& request, double h) const {
    constexpr std::int64_t most_rows = 20'000;
    request.record = {Record::Mode::every, std::max<std::int64_t>(request.steps / most_rows, 1), {}};
    const double end = request.until_steps ? start() + static_cast<double>(request.steps) * h : request.end;
    Tried tried{{motion_->variables, keeps_energy(), (start() + end) / 2}, {}, (start() + end) / 2};
    tried.outcome = request.scene->mechanics->run(request, tried.seen, cancelled_);
    for (std::size_t i = 0; i < motion_->variables; ++i) {
      double& size = tried.seen.halves[tried.outcome.t > tried.middle ? 1 : 0].size;
      if (!(std::abs(tried.outcome.final[i]) <= size)) size = std::abs(tried.outcome.final[i]);
    }
    return tried;
  }

  template <class Grows>
  std::string_view failure_of(const Tried& tried, Grows&& grows) const {
    if (grows(tried)) return "energy_growth";
    switch (tried.outcome.stop.reason) {
      case ReturnCode::completed:
      case ReturnCode::deadline:
      case ReturnCode::cancelled:
      case ReturnCode::step_limit:
      case ReturnCode::left_domain:  // the motion itself ends
        for (const Warning& warning : tried.outcome.warnings) {
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

  /// failure_beyond_the_motion judges a failing run where the true motion may grow as well: parametric resonance,
  /// negative damping, a limit cycle far from the start. The run is shortened so that numbers do not become too large.
  std::string_view failure_beyond_the_motion(Request& request, double h, const Tried& tried) {
    constexpr double most_growth = 1e30;
    const double end = tried.middle + (tried.middle - start());
    const double last = growth_->time_of_growth(most_growth, first_part(), end);
    const auto grows = [this](const Tried& run) { return outgrows_the_motion(run); };
    if (!(last < end)) return failure_of(tried, grows);
    request.steps = static_cast<std::int64_t>((last - start()) / h);
    if (request.steps < 2) return failure_of(tried, grows);
    request.until_steps = true;
    return failure_of(run(request, h), grows);
  }
  double first_part() const { return start() + span() / 2; }

  static constexpr double far = 1000;      // in units of the motion's size
  static constexpr double small = 1e-3;    // smaller excursions do not count
  static constexpr double steadily = 2.0;  // allowed ratio of the second half to the first

  static bool apart(double first, double second, double times = steadily) {
    return !(second <= times * first) && !(first < small && second < small);
  }

  /// size_after returns how far the motion goes in so many spans.
  double size_after(double spans) const {
    const double size = std::max(motion_->size, 1e-300);
    return motion_->travels() ? std::max(motion_->size_halfway, spans * size) : size;
  }
  /// grows tells whether the second half of a run goes far beyond the first, or the whole far beyond the motion.
  bool grows(const Tried& run) const {
    const auto& [first, second] = run.seen.halves;
    const double spans = (run.outcome.t - start()) / span();
    const double before = first.size / size_after(spans / 2), after = second.size / size_after(spans);
    if (!(before < far && after < far)) return true;
    if (!keeps_energy()) return apart(before, after);
    // Where a motion accelerates throughout, energies of the first half are smaller: each half is compared with its own
    // scale.
    return apart(first.range() / (halfway_ ? halfway_->energy : motion_->energy), second.range() / motion_->energy);
  }
  /// outgrows_the_motion is the same test where the true motion grows. A step changes a growth rate slightly, as it
  /// changes a frequency, and over time this can add up to any factor. The growth is attributed to the step where its
  /// rate exceeds one and a half times that of the motion.
  bool outgrows_the_motion(const Tried& run) {
    const auto allowed = [](double growth) { return growth * std::max(1.0, std::sqrt(growth / 2)); };
    const auto& [first, second] = run.seen.halves;
    const double size = std::max(growth_->size(first_part()), 1e-300),
                 before = std::max(growth_->size(run.middle), size),
                 after = std::max(growth_->size(run.middle + (run.middle - start())), before);
    if (!(first.size < far * size * allowed(before / size) && second.size < far * size * allowed(after / size)))
      return true;
    constexpr double moderately = 30;  // a motion that grows by less does not excuse a run that flies away
    const double spans = (run.outcome.t - start()) / span();
    if (after < moderately * motion_->size && !(std::max(first.size, second.size) < far * size_after(spans)))
      return true;
    return apart(first.size / before, second.size / before, steadily * allowed(after / before));
  }

  Request request_;
  const std::atomic<bool>& cancelled_;
  std::shared_ptr<const Conditioning> motion_, halfway_;
  std::optional<TrueGrowth> growth_;  ///< only where no energy is conserved and the motion does not end
};

/// FirstFailure searches for the first step that fails, from below.
class FirstFailure {
 public:
  FirstFailure(LongRun& run, std::size_t setting, double most, const std::atomic<bool>& cancelled)
      : run_(run), setting_(setting), most_(most), cancelled_(cancelled) {}

  /// `also` is a step to be tried besides those of a grid; NaN for none.
  void search(double also) {
    constexpr int halvings = 10;
    std::vector<double> grid;
    for (int k = -2 * halvings; k <= 0; ++k) grid.push_back(most_ * std::exp2(0.5 * k));
    if (also < most_) grid.insert(std::ranges::upper_bound(grid, also), also);
    for (const double h : grid)
      if (!holds(h)) break;
    if (failure.empty()) return;
    // In nonlinear motions failing steps are scattered: there may be others below the first one found.
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

  std::string_view failure;  ///< empty where none was found

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

  LongRun& run_;
  std::size_t setting_;
  double most_, failing_ = 0;
  std::vector<double> stable_;  ///< stable steps, ascending, all below the failing one
  const std::atomic<bool>& cancelled_;
};

/// grows_at_any_step tells whether the growth that ends the stable steps at `limit` is only slower at shorter ones. An
/// undamped oscillation that grows by 1 + c zⁿ in a step of the phase z grows by the rate c ωⁿ hⁿ⁻¹: at half the step,
/// as much in 2ⁿ⁻¹ times the time. Runs are twice as long as that.
bool grows_at_any_step(LongRun& run, std::size_t setting, double limit, const SchemeConfig& scheme) {
  constexpr double z = 0.1;
  const auto growth = [&](double phase) { return growth_per_step(scheme.scheme, scheme.settings, phase, 0) - 1; };
  const double times = growth(2 * z) / growth(z);  // 2ⁿ
  return run.failure(setting, limit / 2, 2 * times) == "energy_growth";
}

/// any_fails tells whether a step up to `most` fails, beginning with the longest.
bool any_fails(LongRun& run, std::size_t setting, double most, const std::atomic<bool>& cancelled) {
  constexpr int halvings = 10;
  for (int k = 0; k <= halvings && !cancelled.load(std::memory_order_relaxed); ++k)
    if (!run.failure(setting, most * std::exp2(-k)).empty()) return true;
  return false;
}

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
  LongRun run(scene, scheme, cancelled);
  const Conditioning& motion = run.motion();
  if (nothing_moves_in(*scene.scene, motion)) {
    limit.why = nothing_moves;
    return limit;
  }
  const double most = std::min(run.span(), dial.range.high);
  // Equations whose divergence vanishes only in the mean of a turn, as those of Lotka and Volterra, have no single
  // damping, but may be undamped all the same.
  const text::TextScene* const text = scene.scene->mechanics->text();
  const bool is_flow = text && text->form->kind == text::FormKind::flow,
             may_be_undamped = motion.damping == 0 || (is_flow && std::isnan(motion.damping)),
             grows_undamped = may_be_undamped && stability_bound(scheme.scheme, scheme.settings, 0, 0) == 0;
  if (grows_undamped && motion.damping == 0 && motion.energy > 0) {
    // By linear theory every step grows, but not if the motion has nothing to grow, as a free motion or rest.
    if (any_fails(run, dial.index, most, cancelled)) {
      limit.step = limit.theory = 0;
      limit.failure = "energy_growth";
    } else {
      limit.why = fmt::format("every step that was tried is stable, up to {:.4g}", most);
    }
    return limit;
  }
  // Linear theory applies where the motion has a single frequency, that of its small oscillations, and a single
  // damping.
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
  if (grows_undamped && grows_at_any_step(run, dial.index, limit.step, scheme)) {
    limit.step = 0;
    limit.failing = unknown;
    return limit;
  }
  limit.failing = first.failing();
  if (limit.failure == "sign_flip") limit.theory = flips_from(scheme.scheme, scheme.settings) / motion.damping;
  return limit;
}

}  // namespace least

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/run/warnings.hpp"
#include "core/study/error_study.hpp"

namespace least {
namespace {

/// slope returns the observed order between two runs.
double slope(const StudyPoint& coarse, const StudyPoint& fine) {
  return std::log(coarse.error / fine.error) / std::log(coarse.value / fine.value);
}

/// Ladder makes the runs of one scheme, from coarse to fine.
class Ladder {
 public:
  Ladder(const ErrorStudy& subject, const StudyPlan& plan, StudyCurve& curve)
      : subject_(subject), plan_(plan), curve_(curve), dial_(subject.card(curve.scheme)) {
    curve.setting = dial_.name;
    longest_ = value_ = subject.longest(curve.scheme, dial_) / (dial_.adaptive() ? 1 : 4);
  }

  bool over() const { return over_; }
  double next() const { return value_; }
  /// cost() estimates the cost of the next run.
  double cost() const { return cost_; }

  /// climb makes one run. True where the curve has got a new point.
  bool climb(double seconds) {
    const Trial trial = subject_.run(dial_.at(curve_.scheme, value_), seconds, plan_.most_forces);
    // The run is to be repeated
    if (trial.status == ReturnCode::deadline || trial.status == ReturnCode::cancelled) return false;
    const SchemeConfig choice = dial_.at(curve_.scheme, value_);
    const auto step = subject_.card(choice).find("step");  // which the dial's companion may be
    StudyPoint point{value_,        step ? choice.settings[*step] : std::numeric_limits<double>::quiet_NaN(),
                     trial.error,   trial.forces,
                     trial.seconds, trial.status};
    const bool meant = trial.error < 1;
    const bool first = meant && !begun_;
    if (first && before_) curve_.points.push_back(*before_);
    if (meant || begun_) {
      if (meant)
        point.seconds =
            std::min(point.seconds, subject_.time(dial_.at(curve_.scheme, value_), seconds, plan_.most_forces));
      curve_.points.push_back(point);
    } else {
      before_ = point;
    }
    begun_ = begun_ || meant;
    move_on(trial);
    return begun_;
  }

  /// close() is called when no more runs will come.
  void close() {
    if (!begun_ && before_) curve_.points.push_back(*before_);
    fit();
  }

 private:
  void move_on(const Trial& trial) {
    const double finer = dial_.adaptive() ? std::sqrt(10.0) : 1.5;
    // A run that ended early says little about the cost of a complete one.
    const bool whole = trial.status == ReturnCode::completed;
    const double growth = !whole ? 1 : dial_.adaptive() ? 1.3 : finer;
    cost_ = std::max(cost_, static_cast<double>(trial.forces) * growth);
    flat_ = whole && trial.error > 0.9 * last_ ? flat_ + 1 : 0;
    last_ = whole ? trial.error : std::numeric_limits<double>::infinity();
    value_ /= finer;
    if (dial_.name == "step") cost_ = std::max(cost_, (subject_.end() - subject_.start()) / value_);
    const bool at_floor = trial.error < 3 * subject_.floor() || (flat_ >= 2 && trial.error < subject_.round_off());
    const bool dear = cost_ > static_cast<double>(plan_.most_forces) || trial.status == ReturnCode::step_limit;
    over_ = at_floor || dear || value_ < std::max(dial_.range.low, 1e-12 * longest_);
  }

  /// fit() finds the observed order on the finest range where the error follows a power law: two decades, or all there
  /// is between round-off and 1e-2, with at least three points and nearly constant order from run to run.
  void fit() {
    if (dial_.adaptive()) {
      curve_.why = "adaptive: no order is declared";
      return;
    }
    std::vector<StudyPoint> points;  // from fine to coarse
    for (std::size_t i = curve_.points.size(); i-- > 0;)
      if (curve_.points[i].error > 30 * subject_.floor() && curve_.points[i].error < 1e-2)
        points.push_back(curve_.points[i]);
    if (points.size() < 3) {
      curve_.why = fmt::format("{} of its errors lie between {:.1e} and 1e-2, where an order shows; three are needed",
                               points.size(), 30 * subject_.floor());
      return;
    }
    const double fall = std::min(100.0, points.back().error / points.front().error);
    for (std::size_t first = 0; first + 2 < points.size(); ++first) {
      double low = slope(points[first + 1], points[first]), high = low;
      std::size_t last = first + 1;
      while (last + 1 < points.size()) {
        const double next = slope(points[last + 1], points[last]);
        const double least = std::min(low, next), most = std::max(high, next);
        if (!(most - least <= std::max(0.2, 0.1 * least))) break;
        low = least, high = most;
        ++last;
      }
      if (last < first + 2 || !(points[last].error >= fall * points[first].error)) continue;
      curve_.observed_order = slope(points[last], points[first]);
      return;
    }
    curve_.why = fmt::format("between {:.1e} and 1e-2 its errors do not follow a power of the setting",
                             std::max(points.front().error, 30 * subject_.floor()));
  }

  const ErrorStudy& subject_;
  const StudyPlan& plan_;
  StudyCurve& curve_;
  ResolutionParameter dial_;
  double value_, longest_, cost_ = 0, last_ = std::numeric_limits<double>::infinity();
  std::optional<StudyPoint> before_;  ///< the last run before the curve begins
  int flat_ = 0;
  bool begun_ = false, over_ = false;
};

std::vector<ParetoPoint> pareto_front(const std::vector<StudyCurve>& curves) {
  std::vector<ParetoPoint> all;
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (std::size_t k = 0; k < curves[c].points.size(); ++k)
      if (std::isfinite(curves[c].points[k].error)) all.push_back({c, k});
  const auto point = [&](const ParetoPoint& p) -> const StudyPoint& { return curves[p.curve].points[p.point]; };
  /// mark flags the points whose error is below that of all cheaper ones.
  const auto mark = [&](auto cost, bool ParetoPoint::*flag) {
    std::ranges::stable_sort(all, {}, [&](const ParetoPoint& p) { return std::pair(cost(point(p)), point(p).error); });
    double least_error = std::numeric_limits<double>::infinity();
    for (ParetoPoint& p : all) {
      p.*flag = point(p).error < least_error;
      least_error = std::min(least_error, point(p).error);
    }
  };
  mark([](const StudyPoint& p) { return p.seconds; }, &ParetoPoint::fastest);
  mark([](const StudyPoint& p) { return static_cast<double>(p.force_evaluations); }, &ParetoPoint::fewest_forces);
  std::erase_if(all, [](const ParetoPoint& p) { return !p.fastest && !p.fewest_forces; });
  return all;
}

}  // namespace

Study work_precision(const StudyPlan& plan, const std::function<bool(std::size_t, const StudyCurve&)>& seen,
                     const std::atomic<bool>& cancelled) {
  const Deadline deadline(plan.budget_seconds);
  Study study;
  for (const SchemeConfig& scheme : plan.schemes) {
    StudyCurve& curve = study.curves.emplace_back();
    curve.scheme = scheme;
    const SchemeCard& card = plan.scene.scene->mechanics->schemes()[scheme.scheme];
    curve.expected_order = declared_order(card, scheme);
    curve.setting = ResolutionParameter(card).name;
  }
  ErrorStudy subject(plan.scene, plan.at_end, plan.budget_seconds, cancelled);
  subject.end_with(deadline);
  study.end = subject.end();
  study.growth = subject.conditioning().growth_in(plan.scene.norm, plan.at_end);
  study.chaotic = subject.conditioning().chaotic(plan.scene.norm);
  if (nothing_moves_in(*plan.scene.scene, subject.conditioning())) {
    study.left_out.emplace_back(fmt::format("everything: {}", nothing_moves));
    for (StudyCurve& curve : study.curves) curve.why = nothing_moves;
    return study;
  }
  if (!subject.known()) {
    const std::string_view missing = subject.truth().missing;
    study.left_out.emplace_back(
        !missing.empty()
            ? fmt::format("everything: {}", missing)
            : fmt::format("everything: the reference solution was not finished within {} s, or is not finite",
                          plan.budget_seconds));
    for (StudyCurve& curve : study.curves) curve.why = "there is no reference solution";
    // Where no reference can be made, nothing was interrupted: the reasons have been given already.
    if (missing.empty()) study.stop = deadline.left() > 0 ? ReturnCode::not_finite : ReturnCode::deadline;
    return study;
  }
  study.how = subject.truth().how;
  study.uncertainty = subject.truth().uncertainty_in(plan.scene.norm);
  study.floor = subject.floor();
  if (subject.ends_early())
    study.left_out.push_back("times after " + Message::time(subject.end(), 6) + ", where the motion nears its end");
  if (plan.begun) plan.begun(study);

  std::vector<Ladder> ladders;
  for (StudyCurve& curve : study.curves) ladders.emplace_back(subject, plan, curve);
  bool wanted = true;
  while (wanted && deadline.left() > 0 && !cancelled.load(std::memory_order_relaxed)) {
    Ladder* cheapest = nullptr;
    for (Ladder& ladder : ladders)
      if (!ladder.over() && (!cheapest || ladder.cost() < cheapest->cost())) cheapest = &ladder;
    if (!cheapest) break;
    const auto index = static_cast<std::size_t>(cheapest - ladders.data());
    if (cheapest->climb(deadline.left())) wanted = seen(index, study.curves[index]);
  }
  for (std::size_t i = 0; i < ladders.size(); ++i) {
    StudyCurve& curve = study.curves[i];
    ladders[i].close();
    if (!ladders[i].over())
      study.left_out.emplace_back(
          fmt::format("{}: {} from {:.3g} on, because {}", name(subject.card(curve.scheme), curve.scheme),
                      curve.setting, ladders[i].next(),
                      deadline.left() > 0 ? "the study was cancelled"
                                          : fmt::format("the budget of {} s ran out", plan.budget_seconds)));
  }
  study.pareto = pareto_front(study.curves);
  return study;
}

}  // namespace least

// entropy, moments: diagnostics of flows that are not mechanical.

#include <cmath>
#include <limits>
#include <utility>

#include "core/run/diagnostics/drift.hpp"
#include "core/run/diagnostics/rows.hpp"
#include "core/run/hermite.hpp"

namespace least {
namespace {

class Entropy final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView x) override { entropy_.start(problem.entropy(x)); }
  void see(const ProblemTable& problem, StateView x) override {
    const double now = problem.entropy(x);
    constexpr double grain = 4 * std::numeric_limits<double>::epsilon();
    monotone_ = monotone_ && now >= entropy_.final - grain * (1 + std::abs(now));
    entropy_.see(now);
  }
  Report report(const RunEnd&) override {
    Report said{"monotone", std::monostate{}};
    if (std::isfinite(entropy_.most)) said.value = monotone_;
    Report report = numbers("entropy", {{"initial", entropy_.initial}, {"final", entropy_.final}});
    insert(report, 2, std::move(said));
    return report;
  }

 private:
  DriftExtremes entropy_;
  bool monotone_ = true;
};

/// TimeAverage is an average over time of several quantities, weighted by numbers that are given by their logarithm.
class TimeAverage {
 public:
  void add(double time, double log_weight, const std::vector<double>& values) {
    sums_.resize(values.size());
    // Weights relative to the largest one so far, so that they do not all underflow.
    const double largest = std::max(log_weight, log_weight_);
    const double past = std::exp(log_weight_ - largest), w = time * std::exp(log_weight - largest);
    log_weight_ = largest;
    weight_ = past * weight_ + w;
    for (std::size_t i = 0; i < values.size(); ++i) sums_[i] = past * sums_[i] + w * values[i];
  }
  /// Unknown before there is any time.
  double operator[](std::size_t i) const { return i < sums_.size() ? sums_[i] / weight_ : unknown; }

 private:
  std::vector<double> sums_;
  double weight_ = 0, log_weight_ = -std::numeric_limits<double>::infinity();
};

/// MomentAverages are averages over time, whatever the steps: by the Gauss rule of three points over each step, with
/// states from Hermite interpolation (order 6). The weights of the rule are positive, so no average leaves the range of
/// its values.
class MomentAverages final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView x) override {
    values_.resize(problem.traits.moments);
    keep(problem, x);
  }
  void see(const ProblemTable& problem, StateView x) override {
    const HermitePath path(problem, before_, x);
    const double h = x.t - before_.t, off = std::sqrt(0.15) * h;
    const double middle = before_.t + h / 2;
    for (const auto& [t, part] : {std::pair{middle - off, 5.0}, {middle, 8.0}, {middle + off, 5.0}}) {
      const RunState y = path(t);
      problem.moments(y, values_.data());
      target_.add(h * part / 18, problem.log_weight(y), values_);
      physical_.add(h * part / 18, problem.log_rate(y), values_);
    }
    keep(problem, x);
  }
  /// The averages of the target density, and those over physical time.
  Report report(const RunEnd& end) override {
    std::vector<Report> all = named(end.problem, target_);
    all.push_back({"physical_time", named(end.problem, physical_)});
    return {"moments", all};
  }

 private:
  void keep(const ProblemTable& problem, StateView x) {
    before_.t = x.t;
    before_.numbers.assign(x.numbers, x.numbers + problem.traits.numbers);
  }
  static std::vector<Report> named(const ProblemTable& problem, const TimeAverage& average) {
    std::vector<Report> all;
    std::size_t i = 0;
    for (const std::string_view name : problem.moment_names()) all.push_back({std::string(name), average[i++]});
    return all;
  }

  TimeAverage target_, physical_;
  RunState before_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<Diagnostic> entropy_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Entropy>();
}
std::unique_ptr<Diagnostic> moments_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<MomentAverages>();
}

}  // namespace least

#include "core/run/diagnostics/error.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/run/diagnostics/largest_error.hpp"
#include "core/run/diagnostics/rows.hpp"
#include "core/run/landmarks.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/messages.hpp"

namespace least {

void warn_of_missing_reference(std::vector<Warning>& warnings, double uncertainty, std::string_view missing) {
  constexpr std::string_view code = "reference_not_finished";
  if (std::ranges::find(warnings, code, &Warning::code) != warnings.end()) return;
  warnings.push_back({code, !missing.empty() ? std::string(missing)
                            : std::isnan(uncertainty)
                                ? "the reference solution met its time limit, or the motion ends or is not finite"
                                : messages::uncertain(uncertainty)});
}

namespace {

/// Errors against the true motion: at the final state, and the largest along the run, which is searched where the
/// motion is fast and then around the largest found. Null, with a warning, if the true motion cannot be computed, or is
/// as uncertain as the errors. It may take half of the time that is left.
class Error final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView x) override { landmarks_.start(moving(problem, x)); }
  void see(const ProblemTable&, StateView x) override { landmarks_.see(x); }

  Report report(const RunEnd& end) override {
    std::vector<SeenState> seen;
    const auto add = [&](const RunState& x, double speed) {
      auto& state = seen.emplace_back();
      state.t = x.t;
      state.speed = speed;
      state.x.assign(x.numbers.begin(), x.numbers.begin() + static_cast<std::ptrdiff_t>(end.problem.traits.moving));
    };
    const auto marks = landmarks_.list();
    for (const auto& [x, speed] : marks)
      if (x.t < end.x.t) add(x, speed);
    LargestError found;
    const bool known = !marks.empty();  // whether the run got as far as its start
    bool told = false;
    if (known) {
      add(end.x, marks.back().speed);
      const double seconds = 0.5 * end.left.seconds();
      const TimeLeft half{[&] { return end.left.seconds() > seconds && end.left.keep_going(); },
                          [&] { return end.left.seconds() - seconds; }, end.left.cancelled};
      found = largest_error(end.request, std::move(seen), landmarks_.longest_move() > 0.2,
                            landmarks_.steps() <= few_steps, half);
      told = found.complete && can_tell(found.uncertainty, found.most);
      if (!told) warn_of_missing_reference(end.warnings, found.complete ? found.uncertainty : unknown, found.missing);
    }
    const bool begun = found.missing != missing::too_long && found.missing != missing::no_series;
    std::string how(begun ? found.how : "none");
    if (known && !told && begun) how += found.complete ? ", too uncertain" : ", not finished";
    const auto if_told = [told](double number) { return told ? number : unknown; };
    Report report = numbers("error", {{"final", if_told(found.last)},
                                      {"max", if_told(found.most)},
                                      {"max_at", if_told(found.at)},
                                      {"uncertainty", found.uncertainty},
                                      {"times", if_told(static_cast<double>(found.times))}});
    insert(report, 3, words("reference", how));
    return report;
  }

 private:
  static constexpr std::int64_t few_steps = 20'000;  ///< runs with fewer steps are quickly repeated

  /// The components of a state that the motion needs.
  static RunState moving(const ProblemTable& problem, StateView x) {
    return {x.t, StateNumbers(x.numbers, x.numbers + problem.traits.moving)};
  }

  Landmarks landmarks_;
};

}  // namespace

std::unique_ptr<Diagnostic> error_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Error>();
}

}  // namespace least

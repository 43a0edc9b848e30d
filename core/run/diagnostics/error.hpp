// error: how far a run is from the true motion.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/run/diagnostics/diagnostic.hpp"
#include "core/run/diagnostics/largest_error.hpp"
#include "core/run/messages.hpp"

namespace least {

/// A run says once that its truth is missing.
inline void warn_of_missing_reference(std::vector<Warning>& warnings) {
  constexpr std::string_view code = "reference_not_finished";
  if (std::ranges::find(warnings, code, &Warning::code) == warnings.end())
    warnings.push_back({code, "the reference solution met the time limit, or is not finite"});
}

/// Errors against the true motion: at the final state, and the largest along the run, looked for where the motion is
/// fast and then around the largest found. Null, with a warning, where the truth could not be had.
struct ErrorRow {
  static constexpr DiagnosticCard info{"error", "against the closed form or a quad-precision run"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = VectorField<P>;

  template <class P, class X>
  struct Seen {
    static constexpr std::int64_t few_steps = 20'000;  ///< which are soon made again
    Landmarks<StateOf<P>> landmarks;

    void start(const P&, const X& x) { landmarks.start(needed(x)); }
    void see(const P&, const X& x) { landmarks.see(needed(x)); }

    Report report(const RunEnd<P, X>& end) const {
      std::vector<SeenState> seen;
      const auto add = [&seen](const StateOf<P>& x, double speed) {
        auto& state = seen.emplace_back();
        state.t = x.t;
        state.speed = speed;
        for (std::size_t i = 0; i < StateOf<P>::size; ++i) state.x.push_back(x[i]);
      };
      const auto marks = landmarks.list();
      for (const auto& [x, speed] : marks)
        if (x.t < end.x.t) add(x, speed);
      LargestError found;
      const bool known = !marks.empty();  // the run got as far as its start
      if (known) {
        add(needed(end.x), marks.back().speed);
        found = largest_error(end.request, std::move(seen), landmarks.longest_move() > 0.2,
                              landmarks.steps() <= few_steps, end.left);
        if (!found.complete) warn_of_missing_reference(end.warnings);
        constexpr double large = 0.1;
        if (found.complete && !(found.most <= large) &&
            std::ranges::find(end.warnings, "large_error", &Warning::code) == end.warnings.end())
          end.warnings.push_back({"large_error", messages::error(found.most, found.at)});
      }
      std::string how(found.how);
      if (known && !found.complete) how += ", not finished";
      Report report = numbers("error", {{"final", found.last},
                                        {"max", found.most},
                                        {"max_at", found.at},
                                        {"uncertainty", found.uncertainty},
                                        {"times", found.complete ? static_cast<double>(found.times) : unknown}});
      insert(report, 3, words("reference", how));
      return report;
    }

   private:
    /// What the motion reads of a state.
    static StateOf<P> needed(const X& x) {
      StateOf<P> y;
      assign(y, plain(x));
      return y;
    }
  };
};

}  // namespace least

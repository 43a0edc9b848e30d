#include "core/run/diagnostics/largest_error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/state_error.hpp"

namespace least {
namespace {

/// Window is an interval of time around a large error, with states of the run in it.
struct Window {
  double low, high;
  SeenState before;  ///< a true state no later than `low`
  std::vector<SeenState> states{};
};

class PeakSearch {
 public:
  PeakSearch(const Request& request, std::vector<SeenState> seen, const TimeLeft& left)
      : request_(request), seen_(std::move(seen)), left_(left) {}

  LargestError look(bool sparse, bool few) {
    look_between(sparse, few);
    std::vector<double> times;
    for (const SeenState& state : seen_) times.push_back(state.t);
    const Truth truth = mechanics().truth(*request_.scene, times, left_.keep_going);
    found_.how = truth.how;
    found_.missing = truth.missing;
    found_.complete = truth.complete;
    if (!truth.complete) return found_;
    found_.uncertainty = truth.uncertainty_in(request_.norm);
    const auto sizes = truth.sizes_in(request_.norm);
    sizes_.assign(sizes.begin(), sizes.end());
    found_.most = 0;
    std::vector<double> errors;
    for (std::size_t i = 0; i < seen_.size(); ++i) errors.push_back(hold(seen_[i], truth.states[i]));
    found_.last = errors.back();
    if (!(found_.most > 0) || !std::isfinite(found_.most)) return found_;
    std::vector<Window> windows = around_the_largest(errors, truth);
    fill(windows);
    for (const Window& window : windows) refine(window);
    return found_;
  }

 private:
  const Mechanics& mechanics() const { return *request_.scene->mechanics; }

  double hold(const SeenState& state, const std::vector<double>& truth) {
    const double error = state_error(state.x, truth, truth.size(), sizes_);
    ++found_.times;
    if (!(error <= found_.most)) {
      found_.most = error;
      found_.at = state.t;
    }
    return error;
  }

  /// The windows around the largest error, around similarly large ones elsewhere, and around the state where the run
  /// was fastest: as wide as the state needs to move by a few times its own size, but not beyond the neighbouring
  /// states that were compared.
  std::vector<Window> around_the_largest(const std::vector<double>& errors, const Truth& truth) const {
    constexpr std::size_t most = 3;
    constexpr double reach = 4, rival = 0.7;
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return errors[a] > errors[b]; });
    const auto fastest =
        static_cast<std::size_t>(std::ranges::max_element(seen_, {}, &SeenState::speed) - seen_.begin());
    if (fastest != order[0]) {
      std::erase(order, fastest);
      order.insert(order.begin() + 1, fastest);
    }
    std::vector<Window> windows;
    for (const std::size_t i : order) {
      if (windows.size() == most) break;
      if (errors[i] < rival * errors[order[0]] && i != fastest) continue;
      const std::size_t left = i > 0 ? i - 1 : 0, right = std::min(i + 1, seen_.size() - 1);
      const double t = seen_[i].t, far = reach / seen_[i].speed;  // infinite for speed 0
      Window window{
          std::max(seen_[left].t, t - far), std::min(seen_[right].t, t + far), {seen_[left].t, truth.states[left]}};
      const bool known = std::ranges::any_of(
          windows, [&](const Window& other) { return window.low < other.high && other.low < window.high; });
      if (!known && window.low < window.high) windows.push_back(std::move(window));
    }
    return windows;
  }

  /// Adds states where the true motion is fast between steps, and between the states that were seen: if these are few,
  /// oscillating errors are often missed. For schemes with their own clock it also adds states within every step, if
  /// steps are not too many, since dense output may be less accurate than the ends of steps.
  void look_between(bool sparse, bool few) {
    const double end = seen_.back().t;
    std::vector<PaceMark> marks;
    if (sparse) marks = mechanics().pace(*request_.scene, end, left_.keep_going);
    const std::size_t gaps = std::max<std::size_t>(seen_.size() - 1, 1),
                      parts = std::clamp<std::size_t>(256 / gaps, 2, 8);
    for (std::size_t i = 1; few && i < seen_.size(); ++i)
      for (std::size_t k = 1; k < parts; ++k)
        marks.push_back({std::lerp(seen_[i - 1].t, seen_[i].t, double(k) / double(parts)),
                         std::min(seen_[i - 1].speed, seen_[i].speed)});
    if (few)
      for (const double t : times_within_steps()) marks.push_back({t, 0});
    std::ranges::stable_sort(marks, {}, &PaceMark::t);
    const auto same = [](const PaceMark& a, const PaceMark& b) { return a.t == b.t; };
    marks.erase(std::unique(marks.begin(), marks.end(), same), marks.end());
    std::erase_if(marks, [&](const PaceMark& mark) {
      return !(mark.t < end) || std::ranges::find(seen_, mark.t, &SeenState::t) != seen_.end();
    });
    std::vector<double> times;
    times.reserve(marks.size());
    for (const PaceMark& mark : marks) times.push_back(mark.t);
    std::vector<SeenState> more = run_again(std::move(times));
    for (std::size_t i = 0; i < more.size(); ++i) more[i].speed = marks[i].speed;
    seen_.insert(seen_.end(), more.begin(), more.end());
    std::ranges::stable_sort(seen_, {}, &SeenState::t);
  }

  std::vector<double> times_within_steps() const {
    constexpr std::size_t most_steps = 700;
    std::vector<double> times;
    if (!mechanics().schemes()[request_.scheme].own_clock) return times;
    std::vector<SeenState> ends = run_again({Record::Mode::every, 1, {}}, seen_.back().t, most_steps);
    if (ends.empty() || ends.size() > most_steps) return times;
    if (ends.back().t < seen_.back().t) ends.push_back(seen_.back());
    // Within the longest steps the largest error may be narrow, since dense output has different orders of accuracy at
    // different points.
    const std::size_t count = ends.size(), parts = count > 360 ? 2 : count > 150 ? 3 : count > 16 ? 450 / count : 128;
    for (std::size_t i = 1; i < ends.size(); ++i)
      for (std::size_t k = 1; k < parts; ++k)
        times.push_back(std::lerp(ends[i - 1].t, ends[i].t, double(k) / double(parts)));
    return times;
  }

  /// run_again returns the states of the run at these times, by its dense output: recording never changes a run. Fewer
  /// if time runs out.
  std::vector<SeenState> run_again(std::vector<double> times) const {
    if (times.empty()) return {};
    const double end = times.back();
    return run_again({Record::Mode::times, 1, std::move(times)}, end, request_.limits.steps);
  }
  std::vector<SeenState> run_again(Record record, double end, std::int64_t most_steps) const {
    std::vector<SeenState> states;
    if (!(left_.seconds() > 0)) return states;
    const std::size_t width = seen_.front().x.size() + 1;
    Request again = request_;
    again.until_steps = false;
    again.end = end;
    again.limits.seconds = left_.seconds();
    again.limits.steps = most_steps;
    again.record = std::move(record);
    again.measures = again.watched = {};
    again.events.clear();
    again.section.reset();
    again.columns.resize(width);
    std::iota(again.columns.begin(), again.columns.end(), 0);  // t and the variables
    again.diagnostics.clear();
    again.control = false;
    Samples samples;
    mechanics().run(again, samples, left_.cancelled);
    for (std::size_t at = 0; at + width <= samples.values.size(); at += width) {
      const auto row = std::span(samples.values).subspan(at, width);
      states.push_back({row[0], {row.begin() + 1, row.end()}, 0});
    }
    return states;
  }
  void fill(std::vector<Window>& windows) const {
    constexpr int parts = 48;
    std::ranges::sort(windows, {}, &Window::low);
    std::vector<double> times;
    for (const Window& window : windows)
      for (int k = 0; k <= parts; ++k) {
        const double t = k < parts ? window.low + (window.high - window.low) * k / parts : window.high;
        if (times.empty() || t > times.back()) times.push_back(t);
      }
    for (const SeenState& state : run_again(std::move(times)))
      for (Window& window : windows)
        if (window.low <= state.t && state.t <= window.high) window.states.push_back(state);
  }

  /// Compares every fourth state of a window, then all around the worst of these.
  void refine(const Window& window) {
    constexpr std::size_t stride = 4;
    const std::size_t count = window.states.size();
    std::vector<std::size_t> some, more;
    for (std::size_t i = 0; i < count; i += stride) some.push_back(i);
    const auto coarse = compare(window.states, some, window.before);
    if (coarse.empty()) return;
    const auto worst =
        static_cast<std::size_t>(std::ranges::max_element(coarse, {}, &Compared::error) - coarse.begin());
    const std::size_t left = worst > 0 ? worst - 1 : 0;
    for (std::size_t i = some[left]; i < std::min(some[worst] + stride, count); ++i)
      if (i % stride != 0) more.push_back(i);
    compare(window.states, more, {window.states[some[left]].t, coarse[left].truth});
  }
  struct Compared {
    double error;
    std::vector<double> truth;
  };
  /// compare returns the errors of the states with these indices; the truth is computed from a true state before them.
  std::vector<Compared> compare(const std::vector<SeenState>& states, const std::vector<std::size_t>& which,
                                const SeenState& before) {
    if (which.empty()) return {};
    Scene local = *request_.scene;
    local.start = before.t;
    std::ranges::copy(before.x, local.initial.begin());
    std::vector<double> times;
    times.reserve(which.size());
    for (const std::size_t i : which) times.push_back(states[i].t);
    Truth truth = mechanics().truth(local, times, left_.keep_going);
    std::vector<Compared> all;
    if (!truth.complete) return all;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const double error = hold(states[which[i]], truth.states[i]);
      all.push_back({error, std::move(truth.states[i])});
    }
    return all;
  }

  const Request& request_;
  std::vector<SeenState> seen_;
  std::vector<double> sizes_;  ///< divisors of the relative norm
  const TimeLeft& left_;
  LargestError found_;
};

}  // namespace

LargestError largest_error(const Request& request, std::vector<SeenState> seen, bool sparse, bool few,
                           const TimeLeft& left) {
  return PeakSearch(request, std::move(seen), left).look(sparse, few);
}

}  // namespace least

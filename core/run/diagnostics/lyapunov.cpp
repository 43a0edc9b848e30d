#include "core/run/diagnostics/lyapunov.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/run/backend.hpp"
#include "core/run/diagnostics/rows.hpp"
#include "core/run/messages.hpp"
#include "core/run/tangent_length.hpp"
#include "core/run/tangent_path.hpp"

namespace least {

std::string_view verdict_of(double growth, double megno) {
  constexpr double little = 0.5, linear = 1.5, exponential = 3, far = 4;  // far: more growth than any transient
  if (megno < -little) return "contracts: neighbours come together, as on the way to an attracting cycle or to rest";
  if (megno <= little) return "steady: neighbours stay together, as on an attracting cycle or in a linear oscillation";
  if (megno >= linear && megno <= exponential) return "regular: neighbours part in proportion to time";
  if (megno > exponential && growth > far) return "unstable: neighbours part exponentially, as in chaos";
  return "undecided: a longer run tells";
}

namespace {

/// Lyapunov carries a small difference u along the run: by the derivative of the scheme's own step if there is one, so
/// that a regular map is reported as regular however coarse it is, otherwise along the true motion from the start.
/// Differences are those at equal time, also for schemes in a fictitious time and for hybrids, and their length is that
/// of TangentLength. `exponent`: the mean of (ln |u|)' over time, which tends to the largest Lyapunov exponent λ, in
/// 1/time. `megno`: the mean over time of Y(t) = 2/t ∫ (ln |u|)' t' dt', with t from the start of the run, which tends
/// to 2 on regular motion and grows as λt/2 on chaotic motion; `verdict` says what the two mean. `derivative`: that of
/// the "scheme" or of the "motion", or "both" if the first failed for some steps; a last step that was cut short is
/// always the motion's. Exponent and MEGNO are null if the derivative cannot be followed. Sources: Benettin, Galgani,
/// Giorgilli, Strelcyn, Meccanica 15, 9 (1980); Cincotta, Giordano, Simó, Physica D 182, 151 (2003), equations 8 and
/// 10.
class Lyapunov final : public Diagnostic {
 public:
  Lyapunov(const RunBackend& backend, const Request& request, KeepGoing keep_going)
      : backend_(backend),
        keep_going_(std::move(keep_going)),
        size_(backend.motion().traits.components),
        kinds_(kinds_of(request.scene->card())),
        tangents_(backend.tangents(request)) {}

  void start(const ProblemTable&, StateView x) override {
    before_ = moving_part(backend_, x);
    begin();
  }
  void see(const ProblemTable&, StateView x) override {
    const RunState from = std::exchange(before_, moving_part(backend_, x));
    if (!followed_ || !(before_.t > from.t)) return;
    if (!length_) return begin();  // along the regular solution from a singular start no difference is carried
    of_motion_ = of_motion_ || last_of_motion_;
    last_of_motion_ = !carry_by_scheme(from);
    of_scheme_ = of_scheme_ || !last_of_motion_;
    if (last_of_motion_) carry_by_motion(from);
  }
  Report report(const RunEnd&) override {
    if (on_path_) settle(before_.t);
    const double time = followed_ ? before_.t - begun_ : unknown, megno = averaged_ / time;
    Report report = numbers("lyapunov", {{"exponent", grown_ / time}, {"megno", megno}});
    const bool motion = of_motion_ || (last_of_motion_ && !of_scheme_);
    insert(report, 2, words("verdict", std::isfinite(megno) ? verdict_of(grown_, megno) : ""));
    insert(report, 3,
           words("derivative", of_scheme_ && motion ? "both"
                               : of_scheme_         ? "scheme"
                               : motion             ? "motion"
                                                    : ""));
    if (!followed_)
      insert(report, 4,
             words("reason", too_large_ ? messages::no_tangent() : "the motion cannot be followed for so long"));
    return report;
  }

 private:
  static constexpr double tolerance = 1e-13;  ///< for the true motion and for the difference
  static constexpr int patience = 2000;       ///< largest number of steps of the true motion within one step of the run

  void begin() {
    if (backend_.motion().starts_series(before_)) return;
    length_.emplace(backend_, before_, tangents_.end, kinds_, keep_going_);
    u_ = length_->first();
    for (std::size_t i = 0; i < size_ && i < tangents_.level.size(); ++i) level_ += tangents_.level[i] * u_[i];
    begun_ = sampled_ = before_.t;
  }
  /// carry_by_scheme returns false if the scheme has no tangents, or if the run took the step in another way, as its
  /// last one.
  bool carry_by_scheme(const RunState& from) {
    if (!tangents_.along || !tangents_.along(from, course_, u_, late_, level_, step_)) return false;
    constexpr double grain = 1e-9;
    bool same = std::abs(step_.to.t - before_.t) <= grain * (before_.t - from.t) + 1e-15 * std::abs(before_.t);
    for (std::size_t i = 0; i < size_; ++i)
      same = same && std::abs(step_.to[i] - before_[i]) <= grain * std::max(1.0, std::abs(before_[i]));
    if (!same) return false;
    if (on_path_ || !(step_.course == course_)) {  // the difference has to be converted
      if (on_path_) leave_path(from.t);
      if (!(step_.course == course_)) compare_at_equal_time(from);
      if (!tangents_.along(from, course_, u_, late_, level_, step_)) return false;
    }
    course_ = step_.course;
    std::copy_n(step_.change.begin(), size_, u_.begin());
    late_ += step_.longer;
    const double size = length_of(before_, u_, late_);
    sample(before_.t, grown_ + std::log(size));
    rescale(1 / size);
    return true;
  }
  void carry_by_motion(const RunState& from) {
    if (!on_path_) {
      double size = 0;
      for (std::size_t i = 0; i < size_; ++i) size = std::max(size, std::abs(from[i]));
      compare_at_equal_time(from);
      if (!path_ && !make_path(size)) return;
      path_->start(from, u_.data());
      base_ = grown_;
      on_path_ = true;
    }
    for (int step = 0; followed_ && path_->time() < before_.t && path_->reach() <= before_.t; ++step)
      followed_ = step < patience && keep_going_() && advance(before_.t);
  }
  /// make_path returns false if the derivatives of the motion take too many operations.
  bool make_path(double size) try {
    path_.emplace(backend_, tolerance, size);
    return true;
  } catch (const tape::TooManyOperations&) {
    too_large_ = true;
    return followed_ = false;
  }
  bool advance(double end) {
    return path_->advance(end, [&] {
      const RunState x = path_->state();
      const double size = (*length_)(x, path_->tangent().data());
      sample(x.t, base_ + std::log(size) + path_->exponent() * std::numbers::ln2);
    });
  }
  /// settle carries the difference along the motion to the time t, within its next step.
  void settle(double t) {
    while (followed_ && path_->time() < t) followed_ = keep_going_() && advance(t);
  }
  void leave_path(double t) {
    settle(t);
    u_ = path_->tangent();
    const double factor = std::exp(base_ - grown_);
    const double own = std::exp(base_ - grown_ + path_->exponent() * std::numbers::ln2);
    for (double& component : u_) component *= own;
    level_ *= factor;
    on_path_ = false;
  }
  /// From x on, neighbours after equal numbers of steps are taken as if they were there at equal time. When a run
  /// changes its method, a late neighbour does so some steps earlier or later; counted as one that changes in the same
  /// step, its delay would grow each time, and the separation would become a difference of large numbers.
  void compare_at_equal_time(const RunState& x) {
    if (late_ == 0) return;
    StateNumbers rate(size_);
    backend_.motion().rates(x, rate.data());
    for (std::size_t i = 0; i < size_; ++i) u_[i] -= rate[i] * late_;
    late_ = 0;
  }
  void rescale(double by) {
    for (double& component : u_) component *= by;
    late_ *= by;
    level_ *= by;
  }
  double length_of(const RunState& x, StateNumbers separate, double time) const {
    if (time != 0) {
      StateNumbers rate(size_);
      backend_.motion().rates(x, rate.data());
      for (std::size_t i = 0; i < size_; ++i) separate[i] -= rate[i] * time;
    }
    return (*length_)(x, separate.data());
  }
  /// sample is given the logarithm of the total growth of the difference at the time t, later than all before.
  void sample(double t, double now_grown) {
    const double growth = now_grown - grown_, now = t - begun_, then = sampled_ - begun_;
    if (!(now > then)) return;
    const double y = then > 0 ? 2 * weighed_ / then : 0;
    weighed_ += growth * (now + then) / 2;
    averaged_ += (now - then) * (y + 2 * weighed_ / now) / 2;
    grown_ = now_grown;
    sampled_ = t;
  }

  const RunBackend& backend_;
  KeepGoing keep_going_;
  std::size_t size_;  ///< number of components that the motion needs
  std::vector<std::size_t> kinds_;
  StepTangents tangents_;
  ChangeOfStep step_;  ///< the last step
  RunState before_;
  /// Neighbours after equal numbers of steps, as a scheme compares them: their separation u, by how much time the other
  /// is late, and by how much its energy level is higher. At equal time they are u − ẋ `late` apart.
  StateNumbers u_;
  double late_ = 0, level_ = 0;
  ActiveMethod course_{};  ///< how a hybrid took its last step
  std::optional<TangentLength> length_;
  /// The true motion while it carries the difference, which it holds without the factor e^`base`.
  std::optional<TangentPath> path_;
  double base_ = 0;
  bool on_path_ = false;

  double begun_ = unknown, sampled_ = 0, grown_ = 0, weighed_ = 0, averaged_ = 0;
  bool too_large_ = false;  ///< the derivatives of the motion take too many operations
  bool followed_ = true, of_scheme_ = false, of_motion_ = false;
  bool last_of_motion_ = false;  ///< whether the last step was the motion's; it counts once there is another step
};

}  // namespace

std::unique_ptr<Diagnostic> lyapunov_diagnostic(const RunBackend& backend, const Request& request,
                                                const KeepGoing& keep_going) {
  return std::make_unique<Lyapunov>(backend, request, keep_going);
}

}  // namespace least

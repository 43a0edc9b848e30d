// lyapunov: how fast neighbours of the run part.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "core/run/diagnostics/diagnostic.hpp"
#include "core/run/tangent_length.hpp"
#include "core/run/tangent_path.hpp"

namespace least {

/// In words what the growth of differences means: `growth` is the logarithm of all of it.
std::string_view verdict_of(double growth, double megno);

/// A small difference u from the run is carried along it: by the derivative of the scheme's own step where that can be
/// had, so that a regular map is called regular however coarse it is, else along the true motion from the start.
/// Differences are those at equal time, also of schemes in a fictitious time and of those that change their course, and their length is that of
/// TangentLength. `exponent`: the mean of (ln |u|)' over time, which tends to the largest Lyapunov exponent λ, in
/// 1/time. `megno`: the mean over time of Y(t) = 2/t ∫ (ln |u|)' t' dt', with t from the start of the run, which tends
/// to 2 on regular motion and grows as λt/2 on chaotic motion; `verdict` says what the two of them mean. `derivative`:
/// of what, "scheme" or "motion", or "both" where some steps had to do without the first; a last step that was cut
/// short is the motion's in either case. Exponent and MEGNO are null where the derivative cannot be followed.
/// Sources: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15, 9 (1980); Cincotta, Giordano, Simó, Physica D 182,
/// 151 (2003), equations 8 and 10.
struct LyapunovRow {
  static constexpr DiagnosticCard info{"lyapunov", "largest Lyapunov exponent of the run and its MEGNO"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = true;

  template <class P, class X>
  struct Seen {
    using Motion = StateOf<P>;
    using Direction = Vec<Motion::size>;
    static constexpr double tolerance = 1e-13;  ///< of the true motion and of the difference alike
    static constexpr int patience = 2000;       ///< in steps of the true motion within one of the run

    Motion before{};
    /// Neighbours as a scheme compares them, after as many steps: what separates them, by how much time the other is
    /// late, and by how much its energy level is higher. At equal time they are u − ẋ `late` apart.
    Direction u{};
    double late = 0, level = 0;
    ActiveMethod course{};  ///< of a hybrid: how its last step was taken
    const StepTangents<P>* tangents = nullptr;
    std::optional<TangentLength<P>> length;
    /// The true motion where it carries the difference, which is in it but for the factor e^`base`.
    std::optional<TangentPath<P>> path;
    double base = 0;
    bool on_path = false;

    double begun = unknown, sampled = 0, grown = 0, weighed = 0, averaged = 0;
    bool followed = true, of_scheme = false, of_motion = false;
    bool last_of_motion = false;  ///< the last step, which is not told of before there is one more

    void start(const P& problem, const X& x, const StepTangents<P>& of_steps) {
      tangents = &of_steps;
      assign(before, plain(x));
      begin(problem);
    }
    void see(const P& problem, const X& x) {
      const Motion from = before;
      assign(before, plain(x));
      if (!followed || !(before.t > from.t)) return;
      if (!length) return begin(problem);  // along the regular solution from a singular start nothing is carried
      of_motion = of_motion || last_of_motion;
      last_of_motion = !carry_by_scheme(problem, from);
      of_scheme = of_scheme || !last_of_motion;
      if (last_of_motion) carry_by_motion(problem, from);
    }
    Report report(const RunEnd<P, X>& end) const {
      Seen last = *this;
      if (last.on_path) last.settle(end.problem, before.t);
      const double time = last.followed ? before.t - begun : unknown, megno = last.averaged / time;
      Report report = numbers("lyapunov", {{"exponent", last.grown / time}, {"megno", megno}});
      const bool motion = of_motion || (last_of_motion && !of_scheme);
      insert(report, 2, words("verdict", std::isfinite(megno) ? verdict_of(last.grown, megno) : ""));
      insert(report, 3,
             words("derivative", of_scheme && motion ? "both"
                                 : of_scheme         ? "scheme"
                                 : motion            ? "motion"
                                                     : ""));
      if (!last.followed) insert(report, 4, words("reason", "the motion cannot be followed for so long"));
      return report;
    }

   private:
    void begin(const P& problem) {
      if (singular(problem, before)) return;
      length.emplace(problem, before, tangents->end);
      u = length->first();
      for (std::size_t i = 0; i < Motion::size; ++i) level += tangents->level[i] * u[i];
      begun = sampled = before.t;
    }
    /// False where the scheme has none, and where the run took its step in another way, as the last one.
    bool carry_by_scheme(const P& problem, const Motion& from) {
      FullStateOf<P> x{};
      assign(x, from);
      const auto tangent = tangents->plain(x, course);
      if (!tangent) return false;
      constexpr double grain = 1e-9;
      bool same = std::abs(tangent->image.t - before.t) <= grain * (before.t - from.t) + 1e-15 * std::abs(before.t);
      for (std::size_t i = 0; i < Motion::size; ++i)
        same = same && std::abs(tangent->image[i] - before[i]) <= grain * std::max(1.0, std::abs(before[i]));
      if (!same) return false;
      if (on_path) leave_path(problem, from.t);
      if (!(tangent->course == course)) meet(problem, from);
      course = tangent->course;
      const Direction old = u;
      double longer = tangent->duration_by_time * late + tangent->duration_by_level * level;
      for (std::size_t i = 0; i < Motion::size; ++i) {
        u[i] = tangent->by_time[i] * late + tangent->by_level[i] * level;
        for (std::size_t j = 0; j < Motion::size; ++j) u[i] += tangent->m[i][j] * old[j];
        longer += tangent->duration[i] * old[i];
      }
      late += longer;
      const double size = length_of(problem, before, u, late);
      sample(before.t, grown + std::log(size));
      rescale(1 / size);
      return true;
    }
    void carry_by_motion(const P& problem, const Motion& from) {
      if (!on_path) {
        double size = 0;
        for (std::size_t i = 0; i < Motion::size; ++i) size = std::max(size, std::abs(from[i]));
        meet(problem, from);
        if (!path) path.emplace(problem, tolerance, size);
        path->start(problem, from, u);
        base = grown;
        on_path = true;
      }
      for (int step = 0; followed && path->time() < before.t && path->reach() <= before.t; ++step)
        followed = step < patience && advance(problem, before.t);
    }
    bool advance(const P& problem, double end) {
      return path->advance(end, [&] {
        const Motion x = path->state();
        const double size = (*length)(problem, x, path->tangent());
        sample(x.t, base + std::log(size) + path->exponent() * std::numbers::ln2);
      });
    }
    /// The motion up to the time t, within its next step.
    void settle(const P& problem, double t) {
      while (followed && path->time() < t) followed = advance(problem, t);
    }
    void leave_path(const P& problem, double t) {
      settle(problem, t);
      u = path->tangent();
      const double factor = std::exp(base - grown), own = std::exp(base - grown + path->exponent() * std::numbers::ln2);
      for (double& component : u) component *= own;
      level *= factor;
      on_path = false;
    }
    /// From x on, neighbours are compared after as many steps as if they were there at equal time. Where a run changes
    /// its course, a neighbour that is late does so some steps earlier or later; counted as one that changes with it,
    /// it would be late by more each time, and what separates them a difference of large numbers.
    void meet(const P& problem, const Motion& x) {
      if (late == 0) return;
      const Motion rate = derivative(problem, x);
      for (std::size_t i = 0; i < Motion::size; ++i) u[i] -= rate[i] * late;
      late = 0;
    }
    void rescale(double by) {
      for (double& component : u) component *= by;
      late *= by;
      level *= by;
    }
    double length_of(const P& problem, const Motion& x, Direction separate, double time) const {
      if (time != 0) {
        const Motion rate = derivative(problem, x);
        for (std::size_t i = 0; i < Motion::size; ++i) separate[i] -= rate[i] * time;
      }
      return (*length)(problem, x, separate);
    }
    /// The logarithm of what the difference has grown by, at the time t, after all that were told of.
    void sample(double t, double now_grown) {
      const double growth = now_grown - grown, now = t - begun, then = sampled - begun;
      if (!(now > then)) return;
      const double y = then > 0 ? 2 * weighed / then : 0;
      weighed += growth * (now + then) / 2;
      averaged += (now - then) * (y + 2 * weighed / now) / 2;
      grown = now_grown;
      sampled = t;
    }
    static bool singular([[maybe_unused]] const P& problem, [[maybe_unused]] const Motion& x) {
      if constexpr (HasSeries<P>) return starts_series(problem, x);
      return false;
    }
  };
};

}  // namespace least

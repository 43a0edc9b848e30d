// lyapunov: how fast neighbours of the run part.
#pragma once

#include <cmath>

#include "core/run/diagnostics/diagnostic.hpp"
#include "core/run/differences.hpp"

namespace least {

/// A small difference is carried along the run and shortened to length 1 after each step: by the derivative of the
/// scheme's own step where that can be had, so that a regular map is called regular however coarse it is, else by the
/// derivative of the exact motion over the step, from the state where it began. `exponent`: the mean of ln |u|' over
/// time, which tends to the largest Lyapunov exponent λ, in 1/time. `megno`: the mean over time of
/// Y(t) = 2/t ∫ (ln |u|)' t' dt', with t from the start of the run, which tends to 2 on regular motion and grows as
/// λt/2 on chaotic motion. `derivative`: of what, "scheme" or "motion", or "both" where some steps had to do without
/// the first; a last step that was cut short is the motion's in either case. Exponent and MEGNO are null where the
/// derivative cannot be followed. The states of a coarse run lie on no one orbit, and the motion's derivatives along
/// them can grow where neither the motion nor the scheme is chaotic: of schemes without a tangent of their own, only
/// accurate runs mean something.
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
    static constexpr double tolerance = 1e-7;
    static constexpr int patience = 100;  ///< in parts of a step, whatever its length

    Motion before{};
    Vec<Motion::size> u{};
    const StepTangents<P>* tangents = nullptr;
    double begun = unknown, grown = 0, weighed = 0, averaged = 0;
    bool followed = true, of_scheme = false, of_motion = false;
    bool last_of_motion = false;  ///< the last step, which is not told of before there is one more

    void start(const P& problem, const X& x, const StepTangents<P>& of_steps) {
      tangents = &of_steps;
      assign(before, plain(x));
      double size = 0;  // no component that the scene has is left out, and none is as large as another
      for (std::size_t i = 0, count = 0; i < Motion::size; ++i) {
        if (!has_component(problem, i)) continue;
        size += 1 / double(++count);
        u[i] = 1 / std::sqrt(double(count));
      }
      for (double& component : u) component /= std::sqrt(size);
      if (!singular(problem, before)) begun = before.t;
    }
    void see(const P& problem, const X& x) {
      const Motion from = before;
      assign(before, plain(x));
      if (!followed || !(before.t > from.t)) return;
      if (std::isnan(begun)) {  // along the regular solution from a singular start nothing is carried
        if (!singular(problem, before)) begun = before.t;
        return;
      }
      of_motion = of_motion || last_of_motion;
      last_of_motion = !carry_by_scheme(from);
      of_scheme = of_scheme || !last_of_motion;
      if (last_of_motion && !carry_by_motion(problem, from)) {
        followed = false;
        return;
      }
      double size = 0;
      for (const double component : u) size = std::hypot(size, component);
      for (double& component : u) component /= size;
      const double growth = std::log(size), now = before.t - begun, then = from.t - begun;
      grown += growth;
      const double y = then > 0 ? 2 * weighed / then : 0;
      weighed += growth * (now + then) / 2;
      averaged += (now - then) * (y + 2 * weighed / now) / 2;
    }
    Report report(const RunEnd<P, X>&) const {
      const double time = followed ? before.t - begun : unknown;
      Report report = numbers("lyapunov", {{"exponent", grown / time}, {"megno", averaged / time}});
      const bool motion = of_motion || (last_of_motion && !of_scheme);
      insert(report, 2,
             words("derivative", of_scheme && motion ? "both"
                                 : of_scheme         ? "scheme"
                                 : motion            ? "motion"
                                                     : ""));
      if (!followed) insert(report, 3, words("reason", "a step is too long for the derivative to be followed"));
      return report;
    }

   private:
    /// False where the scheme has none, and where the run took its step in another way, as the last one.
    bool carry_by_scheme(const Motion& from) {
      FullStateOf<P> x{};
      assign(x, from);
      const auto tangent = tangents->plain(x);
      if (!tangent) return false;
      constexpr double grain = 1e-9;
      bool same = std::abs(tangent->image.t - before.t) <= grain * (before.t - from.t) + 1e-15 * std::abs(before.t);
      for (std::size_t i = 0; i < Motion::size; ++i)
        same = same && std::abs(tangent->image[i] - before[i]) <= grain * std::max(1.0, std::abs(before[i]));
      if (!same) return false;
      const auto old = u;
      for (std::size_t i = 0; i < Motion::size; ++i) {
        u[i] = 0;
        for (std::size_t j = 0; j < Motion::size; ++j) u[i] += tangent->m[i][j] * old[j];
      }
      return true;
    }
    bool carry_by_motion(const P& problem, const Motion& from) {
      Differences<P> motion(problem, from, u, before.t, tolerance, before.t - from.t);
      for (int part = 0; motion.time() < before.t; ++part)
        if (part == patience || !motion.advance()) return false;
      u = motion.derivative();
      return true;
    }
    static bool singular([[maybe_unused]] const P& problem, [[maybe_unused]] const Motion& x) {
      if constexpr (HasSeries<P>) return starts_series(problem, x);
      return false;
    }
  };
};

}  // namespace least

// lyapunov: how fast neighbours of the run part.
#pragma once

#include <cmath>

#include "core/run/diagnostics/diagnostic.hpp"
#include "core/run/differences.hpp"

namespace least {

/// A small difference is carried along the run by the derivative of the exact motion over each of its steps, from the
/// state where the step began, and shortened to length 1 after each. `exponent`: the mean of ln |u|' over time, which
/// tends to the largest Lyapunov exponent λ, in 1/time. `megno`: the mean over time of Y(t) = 2/t ∫ (ln |u|)' t' dt',
/// with t from the start of the run, which tends to 2 on regular motion and grows as λt/2 on chaotic motion. Null where
/// the derivative cannot be followed. Known fault: the states of a coarse run lie on no one orbit, and derivatives of
/// the flow along them can grow where neither the motion nor the scheme is chaotic (kepler, leapfrog, h = 0.01).
/// Sources: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15, 9 (1980); Cincotta, Giordano, Simó, Physica D 182,
/// 151 (2003), equations 8 and 10.
struct LyapunovRow {
  static constexpr DiagnosticCard info{"lyapunov",
                                       "largest Lyapunov exponent of the run and its MEGNO; of accurate runs only"};
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
    double begun = unknown, grown = 0, weighed = 0, averaged = 0;
    bool followed = true;

    void start(const P& problem, const X& x) {
      assign(before, plain(x));
      double size = 0;  // no component is left out, and none is as large as another
      for (std::size_t i = 0; i < Motion::size; ++i) size += 1 / double(i + 1);
      for (std::size_t i = 0; i < Motion::size; ++i) u[i] = 1 / std::sqrt(size * double(i + 1));
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
      Differences<P> motion(problem, from, u, before.t, tolerance, before.t - from.t);
      for (int part = 0; motion.time() < before.t; ++part)
        if (part == patience || !motion.advance()) {
          followed = false;
          return;
        }
      u = motion.derivative();
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
      if (!followed) insert(report, 2, words("reason", "a step is too long for the derivative to be followed"));
      return report;
    }

   private:
    static bool singular([[maybe_unused]] const P& problem, [[maybe_unused]] const Motion& x) {
      if constexpr (HasSeries<P>) return starts_series(problem, x);
      return false;
    }
  };
};

}  // namespace least

// zeros, cycle, poles: what is made of the places where a scene's sections change their sign.
#pragma once

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

struct ZerosRow {
  static constexpr DiagnosticCard info{"zeros", "times at which the section vanishes"};
  static constexpr Sees sees = Sees::sections;
  template <class P>
  static constexpr bool applies = HasSection<P>;
  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const { return {"zeros", end.events.zeros()}; }
  };
};

struct CycleRow {
  static constexpr DiagnosticCard info{"cycle", "period and amplitude of the last whole cycle"};
  static constexpr Sees sees = Sees::sections;
  template <class P>
  static constexpr bool applies = Oscillates<P>;
  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const { return end.events.cycle(); }
  };
};

struct PolesRow {
  static constexpr DiagnosticCard info{"poles", "times at which the slope has a pole", false, true};
  static constexpr Sees sees = Sees::sections;
  template <class P>
  static constexpr bool applies = CarriesSlope<P>;
  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const { return {"poles", end.events.poles()}; }
  };
};

}  // namespace least

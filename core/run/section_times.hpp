// The times of a section that is given by a period.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "core/run/request.hpp"

namespace least {

/// SectionTimes lists the times t = phase + k·period later than the start; none for a section by a plane, or without a
/// section.
class SectionTimes {
 public:
  SectionTimes(const std::optional<Section>& section, double start) {
    if (!section || section->plane) return;
    section_ = *section;
    k_ = std::floor((start - section_.phase) / section_.period);
    for (int n = 0; n < 2 && !(time() > start); ++n) ++k_;
  }
  /// The next time; infinite if there is none.
  double time() const { return section_.phase + k_ * section_.period; }
  void next() { ++k_; }

 private:
  Section section_{.period = 1};
  double k_ = std::numeric_limits<double>::infinity();
};

}  // namespace least

// The times at which a section by its period looks.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "core/run/request.hpp"

namespace least {

/// The times phase + k·period after the start, one after the other; of any other section, or of none, no time.
class SectionTimes {
 public:
  SectionTimes(const std::optional<Section>& section, double start) {
    if (!section || section->plane) return;
    section_ = *section;
    k_ = std::floor((start - section_.phase) / section_.period);
    for (int n = 0; n < 2 && !(time() > start); ++n) ++k_;
  }
  /// The next one; infinite where there is none.
  double time() const { return section_.phase + k_ * section_.period; }
  void next() { ++k_; }

 private:
  Section section_{.period = 1};
  double k_ = std::numeric_limits<double>::infinity();
};

}  // namespace least

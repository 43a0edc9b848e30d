#include "core/variations/doubt.hpp"

#include <cmath>
#include <vector>

#include "core/variations/rows.hpp"

namespace least::variations {

void add_reason(const std::string& reason, Sensitivities& found) {
  if (!found.reason.empty()) found.reason += "; ";
  found.reason += reason;
}

void add_doubt(const Doubt& doubt, Sensitivities& found) {
  if (!(doubt.size <= found.uncertainty) && !std::isnan(found.uncertainty)) found.uncertainty = doubt.size;
  if (std::isnan(doubt.size)) add_reason("the uncertainty is not known: " + doubt.reason, found);
}

Doubt compared(double size) {
  if (!std::isnan(size)) return {size};
  return {size, "derivatives, or those that they are compared with, are all 0 or not finite"};
}

Doubt doubt_by_runs(const Neighbours& neighbours, const ParametricScene& equations, std::span<const double> at_end,
                    const KeepGoing& keep_going) {
  const auto others = neighbours.differences(at_end, keep_going);
  if (!others) return {unknown, no_time};
  for (const double slope : *others)
    if (!std::isfinite(slope)) return {unknown, "a run next to this one does not reach the end"};
  const std::vector<double> known(at_end.begin(), at_end.end());
  return compared(disagreement({in_rows(equations, known)}, {in_rows(equations, *others)}));
}

}  // namespace least::variations

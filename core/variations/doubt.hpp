// The uncertainty of derivatives, from several comparisons, and the reasons why one of them is missing.
#pragma once

#include <span>
#include <string>

#include "core/run/request.hpp"
#include "core/variations/neighbours.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// Doubt is the result of one comparison: an estimate of the largest error divided by the largest entry, or NaN, and
/// then why it is not known.
struct Doubt {
  double size = unknown;
  std::string reason{};
};

/// add_reason appends to the reasons of what is missing.
void add_reason(const std::string& reason, Sensitivities& found);
/// add_doubt keeps the larger one of two uncertainties; once one of them is not known, so is the result, with a reason.
void add_doubt(const Doubt& doubt, Sensitivities& found);
/// compared returns the doubt of this size, and the reason where the comparison has given NaN.
Doubt compared(double size);
/// doubt_by_runs compares derivatives of the end, direction by direction, with differences of runs.
Doubt doubt_by_runs(const Neighbours& neighbours, const ParametricScene& equations, std::span<const double> at_end,
                    const KeepGoing& keep_going);

}  // namespace least::variations

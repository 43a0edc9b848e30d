// time_transformed on scenes whose kinetic metric depends on q: the map of TransformedMidpoint in
// core/schemes/time_transformed.hpp.
#pragma once

#include <memory>

#include "core/run/integrator.hpp"
#include "core/schemes/time_transformed.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// Returns the scheme bound to x; `end` is that of the run.
std::unique_ptr<Integrator> bind_metric_clock(const RunBackend& backend, const text::SizedScene& scene,
                                              const TimeTransformed& scheme, const RunState& x, double end);
StepTangents tangents_of_metric_clock(const text::SizedScene& scene, const TimeTransformed& scheme,
                                      const Request& request);

}  // namespace least

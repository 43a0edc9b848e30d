// Schemes that set their own clock on scenes with a constant metric whose size is known only at run time: the maps of
// core/schemes/adaptive_verlet.hpp, time_transformed.hpp and time_transformed_contact.hpp, on components in one
// contiguous list.
#pragma once

#include <memory>

#include "core/run/integrator.hpp"
#include "core/run/tangent_map.hpp"
#include "core/schemes/adaptive_verlet.hpp"
#include "core/schemes/time_transformed.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

struct Request;

/// bind_clock returns the scheme on a separable autonomous scene; `end` is that of the run.
std::unique_ptr<Integrator> bind_clock(const RunBackend& backend, const text::SizedScene& scene,
                                       const AdaptiveVerlet& scheme, const RunState& x, double end);
/// The same; the scene may also be damped.
std::unique_ptr<Integrator> bind_flat_clock(const RunBackend& backend, const text::SizedScene& scene,
                                            const TimeTransformed& scheme, const RunState& x, double end);
/// Tangents of the same; those of a damped scene are on the extended space.
StepTangents tangents_of_flat_clock(const text::SizedScene& scene, const TimeTransformed& scheme,
                                    const Request& request);

}  // namespace least

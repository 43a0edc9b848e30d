// Tangents of steps of the catalogue's problems by those of scenes as text.
#pragma once

#include "core/run/request.hpp"
#include "core/run/tangent_map.hpp"

namespace least {

/// recorded_tangents returns the tangents of the steps of a run of a problem of the catalogue, taken on the recorded
/// problem. Schemes have steps in dual numbers for all scenes as text; for the catalogue they are compiled for flows
/// alone.
StepTangents recorded_tangents(const Request& request);

}  // namespace least

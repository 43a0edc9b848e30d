// Tangents of the catalogue's steps by those of scenes as text.
#pragma once

#include "core/run/request.hpp"
#include "core/run/tangent_map.hpp"

namespace least {

/// Of the steps of a run of a problem of the catalogue, taken with the problem as it is recorded: schemes have steps in
/// dual numbers for scenes as text, and of the catalogue for equations alone.
StepTangents recorded_tangents(const Request& request);

}  // namespace least

// The member `sensitivities` of a request and of an answer.
#pragma once

#include "server/encode/run_answer.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// As a request spells it.
void write_sensitivities_asked(JsonWriter& json, const variations::SensitivitiesAsked& asked);
/// With all that was found; `with_samples`: and with what was found at samples.
void write_sensitivities(JsonWriter& json, const FoundSensitivities& found, bool with_samples = true);

}  // namespace least::server

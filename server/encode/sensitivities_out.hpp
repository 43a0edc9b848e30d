// The member `sensitivities` of a request and of an answer.
#pragma once

#include "server/encode/run_answer.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// As a request spells it.
void write_sensitivities_asked(JsonWriter& json, const variations::SensitivitiesAsked& asked);
/// With all that was found; `with_samples`: and with what was found at samples.
void write_sensitivities(JsonWriter& json, const FoundSensitivities& found, bool with_samples = true);

/// The same one after the other: what stands before the samples, with the bracket that opens them, some of them, and
/// what stands after them. Nothing of the samples but the numbers is kept for that.
void begin_sensitivities(JsonWriter& json, const FoundSensitivities& found);
void write_samples(JsonWriter& json, const FoundSensitivities& found, std::size_t from, std::size_t to);
void end_sensitivities(JsonWriter& json, const FoundSensitivities& found);

}  // namespace least::server

// The member `sensitivities` of a request and of an answer.
#pragma once

#include "server/encode/run_answer.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// write_sensitivities_asked writes them as a request spells them.
void write_sensitivities_asked(JsonWriter& json, const variations::SensitivitiesAsked& asked);
/// write_sensitivities writes all that was found, `with_samples` including the derivatives at samples.
void write_sensitivities(JsonWriter& json, const FoundSensitivities& found, bool with_samples = true);

/// The same in parts: the members before the samples with the opening bracket of their list, the samples [from, to),
/// and the members after them. No text of the samples has to be kept.
void begin_sensitivities(JsonWriter& json, const FoundSensitivities& found);
void write_samples(JsonWriter& json, const FoundSensitivities& found, std::size_t from, std::size_t to);
void end_sensitivities(JsonWriter& json, const FoundSensitivities& found);

}  // namespace least::server

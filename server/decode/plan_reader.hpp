// The second half of decoding: how long to run, what to keep, what to report, how much it may cost.
#pragma once

#include "core/ensemble/members.hpp"
#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Reads `limits`, of which none is beyond what a client may ask for.
void read_limits(const Json& root, const FieldPath& top, const Caps& caps, Limits& limits);

/// A fault where `until` is a number of steps, which there is no sense in, for the reason given.
void refuse_steps(const Json& root, const FieldPath& top, std::string_view reason);

/// Of a request so far without fault whose `until` lies before the start: the scene is turned around
/// (core/catalogue/backward.hpp), and times of the request are from here on those of its run.
void read_direction(const Json& root, const FieldPath& top, Scene& scene);

/// Reads an `until` that must be a time after the request's start, which is set where the problem is known.
void read_end(const Json& root, const FieldPath& top, const ProblemCard* problem, const PresetCard* preset,
              Request& request);

/// Reads the `norm` of errors.
void read_norm(const Json& root, const FieldPath& top, Request& request);

/// Reads `until`, `record`, `columns`, `diagnostics` and `limits` into the request, whose start and settings are set.
/// Cards are null where they are not known; what depends on them is then left alone. `members`: of an
/// ensemble.
void read_plan(const Json& root, const FieldPath& top, const ProblemCard* problem, const SchemeCard* scheme,
               const PresetCard* preset, const Caps& caps, const Members* members, Request& request);

}  // namespace least::server

// The second half of decoding: how long to run, what to keep, what to report, how much it may cost.
#pragma once

#include "core/ensemble/members.hpp"
#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// read_limits reads `limits`, none of which may exceed the caps.
void read_limits(const Json& root, const FieldPath& top, const Caps& caps, Limits& limits);

/// refuse_steps notes a fault where `until` is a number of steps, which the request cannot have for this reason.
void refuse_steps(const Json& root, const FieldPath& top, std::string_view reason);

/// read_direction handles an `until` before the start, in a request without faults so far: the scene is replaced by its
/// time reversal (core/catalogue/backward.hpp), and times of the request are from then on translated to those of its
/// run.
void read_direction(const Json& root, const FieldPath& top, Scene& scene);

/// read_end reads an `until` that must be a time after the start; the start must be set where the problem is known.
void read_end(const Json& root, const FieldPath& top, const ProblemCard* problem, const PresetCard* preset,
              Request& request);

/// read_norm reads the `norm` of errors.
void read_norm(const Json& root, const FieldPath& top, Request& request);

/// read_plan reads `until`, `record`, `columns`, `diagnostics` and `limits` into the request, whose start and settings
/// must be set. Cards may be null where they are not known; what depends on them is then skipped. `members` are those
/// of an ensemble, else null.
void read_plan(const Json& root, const FieldPath& top, const ProblemCard* problem, const SchemeCard* scheme,
               const PresetCard* preset, const Caps& caps, const Members* members, Request& request);

}  // namespace least::server

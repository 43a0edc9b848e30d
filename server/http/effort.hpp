// How long a task takes, so that short ones need not wait for long ones.
#pragma once

namespace least::server {

/// Effort: `brief` (answers that are ready, refusals) takes microseconds; `reading` a request tens of microseconds;
/// `work` (a run, a scene given as text, a piece of a large answer) milliseconds and more.
enum class Effort { brief, reading, work };

}  // namespace least::server

// How long it takes to see to something: who is brief need not wait for who is not.
#pragma once

namespace least::server {

/// What lies ready or is refused, microseconds; to read a request, tens of them; a run that has its turn, a scene as
/// text, a piece of a large answer, milliseconds and more.
enum class Effort { brief, reading, work };

}  // namespace least::server

// One run of one problem by one scheme, with equal steps or with the scheme's own clock.
#pragma once

#include <atomic>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/columns.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// run executes a checked request. `columns`: all of the scene, in the order of its card.
Solution run(const RunBackend& backend, const Request& request, const std::vector<Column>& columns, RowSink& sink,
             const std::atomic<bool>& cancelled);

}  // namespace least

// One run of one problem by one scheme, whatever sets its clock.
#pragma once

#include <atomic>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/columns.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// The run of a checked request. `columns`: all of the scene, in the order of its card.
Solution run(const RunBackend& backend, const Request& request, const std::vector<Column>& columns, RowSink& sink,
             const std::atomic<bool>& cancelled);

}  // namespace least

// The catalogue: every problem, every scheme, and the pairs that the compiler found to fit. Thread-safe; built once.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "core/run/request.hpp"
#include "least_version.hpp"

namespace least {

/// Every problem, sorted by id; the build generates it from the folder core/problems.
std::span<const std::shared_ptr<const Mechanics>> problem_list();
/// The cards of all schemes; the scheme of a request is an index into this list.
std::span<const SchemeCard> schemes();

/// find_problem returns the problem with this id, null if there is none; find_scheme the index of a scheme.
std::shared_ptr<const Mechanics> find_problem(std::string_view id);
std::optional<std::size_t> find_scheme(std::string_view id);

/// default_request returns a request for a problem and a scheme with all defaults of their cards: parameters, start,
/// span, settings; default columns and diagnostics, every step kept. Throws std::out_of_range for an unknown id.
Request default_request(std::string_view problem, std::string_view scheme);

}  // namespace least

// The catalogue: every problem, every scheme, and the pairs the compiler found to fit. Thread-safe; built once.
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
/// Cards, in the order of the list of schemes: a request's scheme is a position here.
std::span<const SchemeCard> schemes();

/// By id; null where there is none.
std::shared_ptr<const Mechanics> find_problem(std::string_view id);
std::optional<std::size_t> find_scheme(std::string_view id);

/// A problem by a scheme, everything else as their cards say: parameters, start, span, settings; columns and
/// diagnostics by default, every step kept. Throws std::out_of_range where an id names nothing.
Request default_request(std::string_view problem, std::string_view scheme);

}  // namespace least

// The catalogue: every problem, every scheme, and the pairs the compiler found to fit. Thread-safe; built once.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "core/study/conditioning.hpp"
#include "core/study/study.hpp"
#include "least_version.hpp"

namespace least {

/// Cards, sorted by id (problems) and in the order of the scheme list (schemes).
std::span<const ProblemCard> problems();
std::span<const SchemeCard> schemes();

/// Position of an id in problems() or schemes().
std::optional<std::size_t> find_problem(std::string_view id);
std::optional<std::size_t> find_scheme(std::string_view id);

/// Whether the scheme can run the problem.
bool fits(std::size_t problem, std::size_t scheme);

/// What the numbers of a column stand for, by value, where they are codes: `mode` and `parameter`. Empty for numbers.
std::vector<std::string_view> column_words(const ProblemCard& problem, std::size_t column);

/// Runs a checked request (every value within its card's range, the pair fits). Samples go to the sink as they come;
/// `cancelled` is looked at between blocks of steps. Never throws for numerical reasons: every end is a status.
Outcome run(const Request& request, Sink& sink, const std::atomic<bool>& cancelled);

/// The true states of a scene at increasing times after its start, and how well they can be known; both computed anew.
/// keep_going() is asked now and then; false gives up.
Truth compute_truth(const Request& scene, const std::vector<double>& times, const std::function<bool()>& keep_going);
Conditioning compute_conditioning(const Request& scene, const std::function<bool()>& keep_going);

}  // namespace least

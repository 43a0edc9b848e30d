// The catalogue as JSON, generated once from the cards.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/shared/cards.hpp"

namespace least::server {

/// CatalogueText holds complete JSON texts.
struct CatalogueText {
  std::string all;                                                    ///< {"version", "problems", "schemes"}
  std::map<std::string, std::string, std::less<>> problems, schemes;  ///< by id
};

CatalogueText describe(const Cards& cards);

/// A start from which a motion can begin at rest, by coordinate of a scene given as text; nothing where none was found.
using PossibleStart = std::optional<std::vector<double>>;

/// describe_problem returns the card of one problem; for a scene given as text with its form and equations, and with
/// `start` if that pointer is not null.
std::string describe_problem(const Mechanics& problem, const PossibleStart* start = nullptr);

}  // namespace least::server

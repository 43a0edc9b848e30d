// The catalogue as JSON, made once from the cards.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/shared/cards.hpp"

namespace least::server {

/// JSON texts, ready to be sent.
struct CatalogueText {
  std::string all;                                                    ///< {"version", "problems", "schemes"}
  std::map<std::string, std::string, std::less<>> problems, schemes;  ///< by id
};

CatalogueText describe(const Cards& cards);

/// Of the coordinates of a scene as text, where a motion can begin at rest.
using PossibleStart = std::optional<std::vector<double>>;

/// The card of one problem; of a scene as text with its form and its equations, and with `start`, where that is no null
/// pointer.
std::string describe_problem(const Mechanics& problem, const PossibleStart* start = nullptr);

}  // namespace least::server

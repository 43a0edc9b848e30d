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

/// describe_problem returns the card of the problem of a scene, with its form and equations for the choices and whole
/// numbers of the scene, and with `start` if that pointer is not null.
std::string describe_problem(const Scene& scene, const PossibleStart* start = nullptr);

}  // namespace least::server

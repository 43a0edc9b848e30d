// The catalogue as JSON, made once from the cards.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "server/shared/cards.hpp"

namespace least::server {

/// JSON texts, ready to be sent.
struct CatalogueText {
  std::string all;                                                    ///< {"version", "problems", "schemes"}
  std::map<std::string, std::string, std::less<>> problems, schemes;  ///< by id
};

CatalogueText describe(const Cards& cards);

/// The card of one problem; of a scene as text with its form and its equations.
std::string describe_problem(const Mechanics& problem);

}  // namespace least::server

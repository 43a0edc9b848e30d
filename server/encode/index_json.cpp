#include "server/encode/index_json.hpp"

#include "core/catalogue/catalogue.hpp"
#include "server/shared/operations.hpp"

namespace least::server {
namespace {

template <class Card>
void write_link(JsonWriter& json, std::string_view folder, const Card& card) {
  json.open('{').key("id").text(card.id).key("title").text(card.title);
  json.key("href").text(std::string(folder) + "/" + card.id).close('}');
}

}  // namespace

std::string write_index() {
  std::string text;
  JsonWriter json(text);
  json.open('{').key("name").text("leastaction").key("version").text(version).key("endpoints").open('[');
  for (const Operation& operation : operations()) {
    json.open('{').key("method").text(operation.method).key("href").text(operation.path);
    json.key("title").text(operation.title).close('}');
  }
  json.close(']').close('}');
  return text += '\n';
}

std::string list_problems(const Cards& cards) {
  std::string text;
  JsonWriter json(text);
  json.open('{').key("problems").open('[');
  for (const auto& problem : cards.problems) write_link(json, "/v1/problems", problem->card());
  json.close(']').close('}');
  return text += '\n';
}

std::string list_schemes(const Cards& cards) {
  std::string text;
  JsonWriter json(text);
  json.open('{').key("schemes").open('[');
  for (const SchemeCard& card : cards.schemes) write_link(json, "/v1/schemes", card);
  write_link(json, "/v1/schemes", auto_card());
  json.close(']').close('}');
  return text += '\n';
}

}  // namespace least::server

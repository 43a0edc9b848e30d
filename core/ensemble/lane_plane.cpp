#include "core/ensemble/lane_plane.hpp"

#include <algorithm>

#include "core/text/expression.hpp"

namespace least {

std::optional<Level> level_of(const Request& request) {
  using Type = text::Token::Kind;
  const auto expression = std::get<text::Expression>(text::Expression::parse(request.watched.list[0].text));
  const auto tokens = expression.tokens();  // in postfix order
  const auto& variables = request.scene->card().variables;
  const auto found = std::ranges::find(variables, tokens[0].word, &VariableCard::name);
  if (tokens[0].kind != Type::name || found == variables.end()) return std::nullopt;
  Level level{static_cast<int>(found - variables.begin())};
  if (tokens.size() == 1) return level;
  if (tokens.size() != 3 || tokens[1].kind != Type::number) return std::nullopt;
  if (tokens[2].kind != Type::subtract && tokens[2].kind != Type::add) return std::nullopt;
  level.value = tokens[2].kind == Type::subtract ? tokens[1].value : -tokens[1].value;
  return level;
}

bool is_of_lanes(const EnsemblePlan& plan) {
  const Measures& watched = plan.request.watched;
  const auto expression = std::get<text::Expression>(text::Expression::parse(watched.list[0].text));
  const auto& parameters = plan.request.scene->card().parameters;
  return !watched.reads_energy() && std::ranges::none_of(plan.members.vary, [&](const Variation& varied) {
    return varied.is_parameter() && std::ranges::any_of(expression.tokens(), [&](const text::Token& token) {
             return token.kind == text::Token::Kind::name && token.word == parameters[varied.index].name;
           });
  });
}

}  // namespace least

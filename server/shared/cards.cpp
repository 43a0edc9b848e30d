#include "server/shared/cards.hpp"

#include <cmath>
#include <limits>

namespace least::server {

const SchemeCard& auto_card() {
  static const SchemeCard card = [] {
    constexpr double absent = std::numeric_limits<double>::quiet_NaN();
    SchemeCard all;
    all.id = "auto";
    all.title = "Auto: the cheapest that will do";
    all.summary =
        "Measures the schemes on this very scene, picks the one that meets an accuracy with the fewest force "
        "evaluations, or is the most accurate within a time, and says why. Takes either accuracy or seconds; where "
        "neither is said, the default accuracy.";
    all.structure = "none";
    all.parameters = {
        {"accuracy", "ε", "1", "largest error along the span", Kind::number, 1e-6, {0, 1, true}, {}, {}, true},
        {"seconds",
         "",
         "s",
         "time that the run may take: the most accurate within it",
         Kind::number,
         absent,
         {0, std::numeric_limits<double>::infinity(), true},
         {},
         {},
         true}};
    all.own_clock = true;
    all.good_for = "the digits that are needed, at the least cost";
    all.fails_when = "the scene is chaotic over the span: no scheme reaches what the start does not determine";
    return all;
  }();
  return card;
}

void write_parameter(JsonWriter& json, const ParameterCard& card, double value) {
  if (std::isnan(value)) {
    card.word.empty() ? json.null() : json.text(card.word);
  } else if (card.kind == Kind::choice) {
    json.text(card.choices[static_cast<std::size_t>(value)]);
  } else if (card.kind == Kind::flag) {
    json.boolean(value != 0);
  } else if (card.kind == Kind::integer) {
    json.integer(static_cast<std::int64_t>(value));
  } else {
    json.number(value);
  }
}

void write_setting(JsonWriter& json, const SchemeCard& card, std::span<const double> settings, std::size_t i) {
  if (!has_weights(card.parameters[i], settings[i])) return write_parameter(json, card.parameters[i], settings[i]);
  json.open('{').key("weights").open('[');
  for (const double weight : weights_of(card, settings)) json.number(weight);
  json.close(']').key("order").integer(order_with_weights(card, settings));
  json.close('}');
}

}  // namespace least::server

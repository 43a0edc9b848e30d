#include "server/decode/auto_reader.hpp"

#include <cmath>
#include <limits>

namespace least::server {
namespace {

// What stands under a key, if it is asked for.
const Json* asked(const Json& json, std::string_view key) {
  const Json* value = find(json, key);
  return value && value->is_null() ? nullptr : value;
}

double read_asked(const Json& json, const Place& place, std::string_view key, const Range& range) {
  const Json* value = asked(json, key);
  const auto number = value ? read_number(*value, place.at(key), range) : std::nullopt;
  return number.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

const SchemeCard& auto_card() {
  static const SchemeCard card = [] {
    constexpr double absent = std::numeric_limits<double>::quiet_NaN();
    SchemeCard all;
    all.id = "auto";
    all.title = "Auto: the cheapest that will do";
    all.summary =
        "Measures the schemes on this very scene, picks the one that meets an accuracy with the fewest force "
        "evaluations, or is the most accurate within a time, and says why. Takes either accuracy or seconds.";
    all.structure = "none";
    all.parameters = {
        {"accuracy", "ε", "1", "largest error along the span", Kind::number, absent, {0, 1, true}, {}, {}, true},
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

Wish read_wish(const Json& json, const Place& place, const Caps& caps) {
  constexpr std::string_view shape = "{\"id\": \"auto\", \"accuracy\": …}, {\"id\": \"auto\", \"seconds\": …}";
  Wish wish;
  if (json.is_object()) read_object(json, place, {"id", "accuracy", "seconds", "keep"}, "auto");
  if ((asked(json, "accuracy") == nullptr) == (asked(json, "seconds") == nullptr)) {
    place.lacks("auto must hold either accuracy or seconds", std::string(shape));
  }
  wish.accuracy = read_asked(json, place, "accuracy", auto_card().parameters[0].range);
  wish.seconds = read_asked(json, place, "seconds", {0, caps.seconds, true});
  if (const Json* keep = find(json, "keep")) {
    for (const auto kept :
         read_names(*keep, place.at("keep"), Names(keep_names.begin(), keep_names.end()), "quantity")) {
      (kept == 0 ? wish.keep.energy : kept == 1 ? wish.keep.structure : wish.keep.momenta) = true;
    }
  }
  return wish;
}

}  // namespace least::server

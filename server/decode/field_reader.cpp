#include "server/decode/field_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/composition.hpp"
#include "core/text/expression.hpp"

namespace least::server {
namespace {

std::string beyond(double x, const Range& range) {
  if (range.low_open ? !(x > range.low) : !(x >= range.low)) {
    return fmt::format("must be {} {}", range.low_open ? "greater than" : "at least", shortest(range.low));
  }
  return fmt::format("must be {} {}", range.high_open ? "less than" : "at most", shortest(range.high));
}

// note_why notes why a text is no number, with the position of the character at fault.
void note_why(const Json& json, const FieldPath& path, std::string_view kind, std::string_view allowed) {
  const auto parsed = text::Expression::parse(json.get<std::string>(), text::most_characters);
  const auto* const expression = std::get_if<text::Expression>(&parsed);
  tape::Tape tape;
  const auto recorded = expression ? expression->record(tape, {}) : std::get<text::Fault>(parsed);
  const auto* const fault = std::get_if<text::Fault>(&recorded);
  if (!fault) return;
  path.faults->add({path.pointer,
                    fault->unknown.empty() ? fault->detail : fmt::format("must be {}: {}", kind, fault->detail),
                    shown(json), std::string(allowed), fault->position});
}

// number_of returns a number, or the value of a text of constants. Otherwise it notes what is wrong and returns
// nothing; `kind` says in words what is expected.
std::optional<double> number_of(const Json& json, const FieldPath& path, std::string_view kind,
                                std::string_view allowed) {
  if (json.is_number()) return json.get<double>();
  const auto value = json.is_string() ? text::constant_of(json.get_ref<const std::string&>()) : std::nullopt;
  if (value) return value;
  if (json.is_string()) note_why(json, path, kind, allowed);
  path.fault(fmt::format("must be {}", kind), json, std::string(allowed));  // unless a fault was noted there
  return std::nullopt;
}

constexpr std::string_view weights_shape = "{\"weights\": [w1, …, wn]}, symmetric, of sum 1";

// Reads {"weights": [w₁, …]}; an answer adds "order", which is accepted here.
bool read_weights(const Json& json, const FieldPath& path, std::vector<double>& weights) {
  if (!read_object(json, path, {"weights", "order"}, "a composition")) return false;
  const Json* list = find(json, "weights");
  const FieldPath place = path.at("weights");
  if (list == nullptr || !list->is_array()) {
    list ? place.fault("must be a list of numbers", *list, std::string(weights_shape))
         : place.lacks("is required", std::string(weights_shape));
    return false;
  }
  constexpr Range range{-compositions::largest_weight, compositions::largest_weight};
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (const auto weight = read_number((*list)[i], place.at(i), range)) weights.push_back(*weight);
  }
  if (weights.size() < list->size()) return false;
  if (std::string why = compositions::objection(weights); !why.empty()) {
    place.fault(std::move(why), *list, std::string(weights_shape));
    return false;
  }
  return true;
}

// example returns `, like {"t": 20}`: the object that a number or list was probably meant to be, with the possible
// names. A list is taken for a state, which does not include the time.
std::string example(const Json& json, const Names& known) {
  const std::size_t first = json.is_array() && known.size() > 1 && known.front() == "t" ? 1 : 0;
  const std::size_t count = json.is_array() ? std::max<std::size_t>(json.size(), 1) : 1;
  std::string entries;
  for (std::size_t i = 0; i < count && first + i < known.size(); ++i) {
    const Json value = !json.is_array() ? json : i < json.size() ? json[i] : Json();
    if (i > 0) entries += ", ";
    entries += fmt::format("\"{}\": {}", known[first + i], value.is_number() ? value.dump() : "…");
  }
  return entries.empty() ? entries : fmt::format(", like {{{}}}", entries);
}

}  // namespace

bool read_object(const Json& json, const FieldPath& path, const Names& known, std::string_view owner) {
  if (!json.is_object()) {
    path.fault("must be an object" + example(json, known), json);
    return false;
  }
  for (const auto& [key, value] : json.items()) {
    if (path.faults->full()) break;
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    path.at(key).fault(fmt::format("unknown key of {}{}", owner, path.meant(key, known)), value, listed(known));
  }
  return true;
}

std::optional<double> read_number(const Json& json, const FieldPath& path, const Range& range, std::string_view other) {
  const std::string allowed = interval(range).append(other);
  const auto x = number_of(json, path, fmt::format("a number{}", other), allowed);
  if (!x) return std::nullopt;
  if (std::isfinite(*x) && range.contains(*x)) return x;
  path.fault(beyond(*x, range).append(other), json, allowed);
  return std::nullopt;
}

std::optional<double> read_whole(const Json& json, const FieldPath& path, const Range& range, std::string_view other) {
  const std::string kind = fmt::format("a whole number{}", other), allowed = interval(range).append(other);
  const auto x = number_of(json, path, kind, allowed);
  if (!x) return std::nullopt;
  if (*x != std::floor(*x)) {
    path.fault("must be " + kind, json, allowed);
    return std::nullopt;
  }
  // What is no double is beyond every range of counts; rounded, it might not be.
  const bool exact = !json.is_number_unsigned() || json.get<std::uint64_t>() <= std::uint64_t{greatest_count};
  if (exact) return read_number(json, path, range, other);
  path.fault(beyond(*x * 2, range).append(other), json, allowed);
  return std::nullopt;
}

std::optional<std::int64_t> read_integer(const Json& json, const FieldPath& path, std::int64_t low, std::int64_t high) {
  const auto x = read_whole(json, path, {static_cast<double>(low), static_cast<double>(high)});
  if (!x) return std::nullopt;
  return static_cast<std::int64_t>(*x);
}

std::optional<std::size_t> read_name(const Json& json, const FieldPath& path, const Names& names, std::string_view what,
                                     std::string_view other) {
  const auto allowed = [&] { return listed(names).append(other); };
  if (!json.is_string()) {
    path.fault(fmt::format("must be a string, the name of a {}", what), json, allowed());
    return std::nullopt;
  }
  const auto& word = json.get_ref<const std::string&>();
  const auto it = std::find(names.begin(), names.end(), word);
  if (it == names.end() || word.empty()) {
    path.fault(fmt::format("unknown {}{}", what, path.meant(word, names)), json, allowed());
    return std::nullopt;
  }
  return static_cast<std::size_t>(it - names.begin());
}

std::vector<std::size_t> read_names(const Json& json, const FieldPath& path, const Names& known,
                                    std::string_view what) {
  std::vector<std::size_t> chosen;
  if (!json.is_array()) {
    const bool one =
        json.is_string() && std::find(known.begin(), known.end(), json.get_ref<const std::string&>()) != known.end();
    path.fault(fmt::format("must be a list of {}s{}", what, one ? ", like [" + json.dump() + "]" : ""), json,
               listed(known));
    return chosen;
  }
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    const auto index = read_name(json[i], path.at(i), known, what);
    if (!index) continue;
    if (std::find(chosen.begin(), chosen.end(), *index) != chosen.end()) {
      path.at(i).fault(fmt::format("the {} stands twice", what), json[i]);
    }
    chosen.push_back(*index);
  }
  return chosen;
}

std::optional<double> read_parameter(const Json& json, const FieldPath& path, const ParameterCard& card,
                                     std::vector<double>& weights) {
  std::string absent;  // the word for "no value", if allowed
  if (card.nullable) {
    const Json none = card.word.empty() ? Json() : Json(card.word);
    if (json == none) return std::numeric_limits<double>::quiet_NaN();
    absent = " or " + none.dump();
  }
  switch (card.kind) {
    case Kind::number:
      return read_number(json, path, card.range, absent);
    case Kind::integer:
      return read_whole(json, path, card.range, absent);
    case Kind::choice: {
      if (card.weights && json.is_object()) {
        if (!read_weights(json, path, weights)) return std::nullopt;
        return static_cast<double>(card.choices.size());
      }
      const auto index = read_name(json, path, Names(card.choices.begin(), card.choices.end()), card.name,
                                   card.weights ? fmt::format(" or {}", weights_shape) : "");
      if (!index) return std::nullopt;
      return static_cast<double>(*index);
    }
    case Kind::flag:
      if (!json.is_boolean()) {
        path.fault("must be true or false", json, "true, false");
        return std::nullopt;
      }
      return json.get<bool>() ? 1 : 0;
  }
  return std::nullopt;
}

}  // namespace least::server

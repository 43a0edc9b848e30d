#include "server/decode/objection_place.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/decode/wording.hpp"

namespace least::server {
namespace {

std::string_view stem_of(std::string_view name) { return name.substr(0, name.find('[')); }

// place_in returns how the request gives `/masses/x[2]`: so, or for the whole list as `/masses/x`, or for all as
// `/masses`.
std::optional<std::string> place_in(const Json& problem, std::string_view pointer) {
  const std::string_view key = pointer.substr(1, pointer.find('/', 1) - 1);
  const Json* const texts = find(problem, key);
  if (texts == nullptr) return std::nullopt;
  if (key.size() + 1 == pointer.size() || !texts->is_object()) return "/" + std::string(key);
  const std::string_view name = pointer.substr(key.size() + 2);
  if (find(*texts, name)) return std::string(pointer);
  for (const auto& entry : texts->items())
    if (stem_of(entry.key()) == stem_of(name)) return "/" + std::string(key) + pointer_step(entry.key());
  return "/" + std::string(key);
}

// in_words returns what the text at a pointer is.
std::string in_words(std::string_view pointer) {
  const std::size_t second = pointer.find('/', 1);
  const std::string_view key = pointer.substr(1, second - 1);
  const std::string name(second == pointer.npos ? std::string_view() : pointer.substr(second + 1));
  if (key == "masses") return "the mass of " + name;
  if (key == "equations" && !name.empty()) return "the rate of " + name;
  if (key == "lagrangian") return "the Lagrangian";
  if (key == "hamiltonian") return "the Hamiltonian";
  if (key == "action_curvature") return "the action curvature";
  return "the " + std::string(key);
}

/// Given are the parameters that one key of a request sets: a number, or the elements of a list.
struct Given {
  std::string key;
  std::vector<std::size_t> parameters;
};

std::vector<Given> given_in(const Json& problem, const std::vector<ParameterCard>& cards) {
  std::vector<Given> all;
  for (const auto& entry : problem.items()) {
    Given given{entry.key(), {}};
    for (std::size_t i = 0; i < cards.size(); ++i)
      if (cards[i].name == entry.key() || (entry.value().is_array() && stem_of(cards[i].name) == entry.key()))
        given.parameters.push_back(i);
    if (!given.parameters.empty()) all.push_back(std::move(given));
  }
  return all;
}

}  // namespace

void add_objection(const Json& root, const FieldPath& top, const Scene& scene,
                   const text::TextScene::Objection& objection, const std::function<bool(const Scene&)>& holds) {
  const FieldPath path = top.at("problem");
  const Json* const problem = find(root, "problem");
  if (const auto place = problem ? place_in(*problem, objection.pointer) : std::nullopt)
    return top.faults->add({path.pointer + *place, objection.detail, {}, {}, {}});
  const std::string what = in_words(objection.pointer) + " " + objection.detail;
  const auto& cards = scene.card().parameters;
  const auto by_default = [&](const std::vector<std::size_t>& parameters) {
    Scene other = scene;
    for (const std::size_t i : parameters) other.parameters[i] = cards[i].value;
    return holds(other);
  };
  const std::vector<Given> all = problem && problem->is_object() ? given_in(*problem, cards) : std::vector<Given>();
  const Given* culprit = nullptr;
  for (const Given& given : all)
    if (by_default(given.parameters)) {
      if (culprit) return path.lacks(what, "other parameters, as the default ones");
      culprit = &given;
    }
  if (culprit) {
    const FieldPath place = path.at(culprit->key);
    const Json& value = (*problem)[culprit->key];
    if (value.is_array())
      for (std::size_t k = 0; k < culprit->parameters.size() && k < value.size(); ++k) {
        const std::size_t i = culprit->parameters[k];
        if (by_default({i}))
          return place.at(k).fault("with it " + what, value[k],
                                   fmt::format("another number, as its default {}", shortest(cards[i].value)));
      }
    const std::size_t first = culprit->parameters.front();
    return place.fault("with it " + what, value,
                       value.is_array()
                           ? std::string("other numbers, as its default ones")
                           : fmt::format("another number, as its default {}", shortest(cards[first].value)));
  }
  if (find(root, "initial")) return top.at("initial").lacks(what, "another start, as the default one");
  path.lacks(what, "other parameters, as the default ones");
}

}  // namespace least::server

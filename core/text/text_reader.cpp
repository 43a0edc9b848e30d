#include "core/text/text_reader.hpp"

#include <algorithm>
#include <map>

#include "core/text/expansion.hpp"

namespace least::text {

std::string pointer_to(std::string_view key, std::string_view name) {
  std::string pointer(key);
  for (const char c : name) {
    if (c == '~' || c == '/') {
      pointer += c == '~' ? "~0" : "~1";
    } else {
      pointer += c;
    }
  }
  return pointer;
}

TextReader::TextReader(const Definition& definition) : given_(definition), form_(std::make_shared<Form>()) {
  form_->coordinates = given_.variables.size();
  form_->numbers = flow() ? Numbering::of_flow(n()) : Numbering::of_mechanics(n());
}

void TextReader::check_names() {
  const int most = flow() ? most_variables : most_coordinates;
  if (given_.variables.empty() || given_.variables.size() > static_cast<std::size_t>(most))
    return fault("/variables",
                 given_.variables.empty() ? "must name at least one variable" : "names too many variables",
                 "1 to " + std::to_string(most));
  constexpr std::string_view variable = "a variable";
  std::map<std::string, std::string_view, std::less<>> taken{
      {"t", "the time"}, {"s", "the action"}, {"pi", "the constant"}, {"energy", "the energy"}};
  for (const auto word : {"and", "or", "not"}) taken.emplace(word, "a word of conditions");
  for (const auto column : column_names()) taken.emplace(column, "a column");
  for (const auto function : function_names()) taken.emplace(function, "a function");
  const auto take = [&](const std::string& pointer, const std::string& name, std::string_view what,
                        std::size_t most_letters) {
    const auto element = element_of(name);
    const std::string_view letters = element ? element->first : std::string_view(name);
    if (!is_name(letters) || letters.size() > most_letters) {
      fault(pointer, "\"" + name.substr(0, 40) + "\" cannot be a name",
            "a letter, then letters, digits, _: at most " + std::to_string(most_letters));
    } else if (const auto [known, is_new] = taken.emplace(name, what); !is_new) {
      fault(pointer,
            name + " is " + std::string(known->second) + " already: it cannot be " + std::string(what) + ", too",
            "names that differ");
    }
  };
  // Names of velocities and momenta follow from those of variables: where they coincide with another variable, the
  // fault asks to rename that variable.
  const auto take_beside = [&](std::size_t i, const std::string& name, std::string_view what) {
    const auto known = taken.find(name);
    if (known == taken.end() || known->second != variable)
      return take("/variables/" + std::to_string(i), name, what, longest_name + 1);
    const auto other = std::ranges::find(given_.variables, name) - given_.variables.begin();
    fault("/variables/" + std::to_string(other),
          name + " is " + std::string(what) + " already, of " + given_.variables[i] + ": it cannot be a variable, too",
          "names that differ");
  };
  for (std::size_t i = 0; i < given_.variables.size(); ++i)
    take("/variables/" + std::to_string(i), given_.variables[i], variable, longest_name);
  if (!faults_.empty()) return;
  if (!flow())
    for (std::size_t i = 0; i < given_.variables.size(); ++i) {
      take_beside(i, velocity_name(given_.variables[i]), "a velocity");
      take_beside(i, momentum_name(given_.variables[i]), "a momentum");
    }
  if (given_.parameters.size() > static_cast<std::size_t>(most_parameters))
    fault("/parameters", "are too many", "at most " + std::to_string(most_parameters));
  for (const auto& [name, value] : given_.parameters) {
    const auto keys = reserved_keys();
    if (std::ranges::find(keys, name) != keys.end()) {
      fault(pointer_to("/parameters/", name), name + " is a key of a scene and cannot be a parameter", "another name");
    } else {
      take(pointer_to("/parameters/", name), name, "a parameter", longest_parameter);
    }
  }
}

Words TextReader::words(char momentum, std::string_view no_velocity, std::string_view no_momentum,
                        std::string_view no_s) {
  Words all;
  names_.clear();
  names_.reserve(4 * n());
  auto& tape = form_->tape;
  const auto turned = [this](const Symbol& x) { return given_.backward ? -x : x; };
  for (std::size_t i = 0; i < n(); ++i) {
    all.add({given_.variables[i], Symbol::variable(tape, i)});
    if (flow()) continue;
    const Symbol moving = turned(Symbol::variable(tape, static_cast<std::size_t>(form_->numbers.momentum) + i));
    all.add({names_.emplace_back(velocity_name(given_.variables[i])), moving,
             momentum == 'v' ? std::string_view() : no_velocity});
    all.add({names_.emplace_back(momentum_name(given_.variables[i])), moving,
             momentum == 'p' ? std::string_view() : no_momentum});
  }
  all.add({"t", turned(Symbol::time(tape))});
  all.add({"s", turned(Symbol::variable(tape, static_cast<std::size_t>(form_->numbers.action))), no_s});
  for (std::size_t k = 0; k < given_.parameters.size(); ++k)
    all.add(
        {given_.parameters[k].first, Symbol::variable(tape, static_cast<std::size_t>(form_->numbers.parameter) + k)});
  return all;
}

std::vector<const std::string*> TextReader::texts_by_variable(std::string_view key, const Definition::Named& texts,
                                                              std::string_view what) {
  std::vector<const std::string*> all(n(), nullptr);
  for (const auto& [name, text] : texts) {
    const auto which = std::ranges::find(given_.variables, name);
    if (which == given_.variables.end()) {
      fault(pointer_to(key, name), "is " + std::string(what) + " no variable", "one of the variables");
    } else if (auto& known = all[static_cast<std::size_t>(which - given_.variables.begin())]; known != nullptr) {
      fault(pointer_to(key, name), "is " + std::string(what) + " " + name + " once more",
            "one text for every variable");
    } else {
      known = &text;
    }
  }
  return all;
}

std::optional<Symbol> TextReader::record(const std::string& pointer, const std::string& text, const Words& known) {
  characters_ += text.size();
  const std::size_t most = given_.typed ? most_written : most_characters;
  if (characters_ > most) {
    fault(pointer, "the texts of the scene are too long together", std::to_string(most) + " characters");
    return std::nullopt;
  }
  const std::size_t sums = given_.sums ? given_.sums->all.size() : 0;
  auto parsed = Expression::parse(text, most, sums);
  if (auto* wrong = std::get_if<Fault>(&parsed)) {
    faults_.push_back({pointer, std::move(*wrong)});
    return std::nullopt;
  }
  auto symbol = std::get<Expression>(parsed).record(form_->tape, known, operations(), given_.sums.get(), &summed_);
  if (auto* wrong = std::get_if<Fault>(&symbol)) {
    faults_.push_back({pointer, std::move(*wrong)});
    return std::nullopt;
  }
  return std::get<Symbol>(symbol);
}

}  // namespace least::text

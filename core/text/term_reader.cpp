#include "core/text/term_reader.hpp"

#include <algorithm>

#include "core/text/characters.hpp"

namespace least::text {
namespace {

/// has_exponents tells whether the text has an exponent that is not just digits.
bool has_exponents(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '^' && text.substr(at, 2) != "**") continue;
    std::size_t next = at + (text[at] == '^' ? 1 : 2);
    while (next < text.size() && is_space(text[next])) ++next;
    if (next == text.size() || !is_digit(text[next])) return true;
  }
  return false;
}

}  // namespace

std::uint32_t SumNames::number_of(std::string_view list, std::size_t index) {
  auto known = elements_.find(list);
  if (known == elements_.end()) known = elements_.emplace(list, std::vector<std::uint32_t>()).first;
  if (known->second.size() <= index) known->second.resize(index + 1, 0);
  std::uint32_t& number = known->second[index];
  if (number == 0) {
    all_.push_back(index == 0 ? std::string(list) : element_name(list, static_cast<std::int64_t>(index)));
    number = static_cast<std::uint32_t>(all_.size());
  }
  return number - 1;
}

std::uint32_t SumNames::number_of(std::int64_t value) {
  const auto [known, is_new] = values_.try_emplace(value, static_cast<std::uint32_t>(all_.size()));
  if (is_new) all_.push_back(std::to_string(value));
  return known->second;
}

void TermReader::append_argument(std::uint32_t name) {
  const auto known = std::ranges::find(given_, name);
  const auto place = known - given_.begin();
  if (known == given_.end()) given_.push_back(name);
  text_ += "a[";
  text_ += std::to_string(place + 1);
  text_ += ']';
}

bool TermReader::append_number(std::int64_t value) {
  if (!numbers_differ_) return false;
  has_numbers_ = true;
  append_argument(sums_.names.number_of(value));
  return true;
}

bool TermReader::finish() {
  const auto [known, is_new] = shape_of_text_.try_emplace(text_, sum_.shapes.size());
  if (is_new && has_numbers_ && has_exponents(text_)) return false;
  if (is_new) sum_.shapes.push_back({text_, given_.size()});
  KeptSum::Shape& shape = sum_.shapes[known->second];
  shape.given.insert(shape.given.end(), given_.begin(), given_.end());
  ++shape.terms;
  ++terms_;
  text_.clear();
  given_.clear();
  return sum_.shapes.size() <= most_shapes;
}

}  // namespace least::text

#include "core/text/term_reader.hpp"

#include <algorithm>

namespace least::text {

std::uint32_t TermReader::number_of(std::string_view list, std::size_t index) {
  auto known = numbers_.find(list);
  if (known == numbers_.end()) {
    known = numbers_.emplace(list, std::vector<std::uint32_t>()).first;
    speaks_of_foreign_ = speaks_of_foreign_ || foreign_.contains(list);
  }
  if (known->second.size() <= index) known->second.resize(index + 1, 0);
  std::uint32_t& number = known->second[index];
  if (number == 0) {
    sum_.names.push_back(index == 0 ? std::string(list) : element_name(list, static_cast<std::int64_t>(index)));
    number = static_cast<std::uint32_t>(sum_.names.size());
  }
  return number - 1;
}

void TermReader::append_argument(std::uint32_t name) {
  const auto known = std::ranges::find(given_, name);
  const auto place = known - given_.begin();
  if (known == given_.end()) given_.push_back(name);
  text_ += "a[";
  text_ += std::to_string(place + 1);
  text_ += ']';
}

bool TermReader::finish() {
  const auto [known, is_new] = shape_of_text_.try_emplace(text_, sum_.shapes.size());
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

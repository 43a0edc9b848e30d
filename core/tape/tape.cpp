#include "core/tape/tape.hpp"

#include <algorithm>

namespace least::tape {

Index Tape::insert_at_run(const Node& node) { return insert(node); }

bool Terms::operator==(const Terms& other) const {
  const auto same = [](const Node& a, const Node& b) { return a.is(b); };
  return arguments == other.arguments && count == other.count && sums == other.sums && results == other.results &&
         into == other.into && given == other.given && std::ranges::equal(formula, other.formula, same);
}

Index Tape::keep(Terms terms) {
  std::vector<bool> given(nodes_.size(), false);
  for (const Index i : terms.given) given[static_cast<std::size_t>(i)] = true;
  terms.operands.clear();
  for (Index i = 0; i < size(); ++i)
    if (given[static_cast<std::size_t>(i)]) terms.operands.push_back(i);
  const auto known = std::ranges::find(terms_, terms);
  const auto number = static_cast<Index>(known - terms_.begin());
  if (known == terms_.end()) terms_.push_back(std::move(terms));
  return number;
}

std::size_t Tape::bytes() const {
  std::size_t all = nodes_.capacity() * sizeof(Node) + places_.capacity() * sizeof(Index);
  for (const Terms& one : terms_) all += (one.given.capacity() + one.into.capacity()) * sizeof(Index);
  return all;
}

}  // namespace least::tape

#include "core/tape/tape.hpp"

#include <bit>

namespace least::tape {
namespace {

bool same(const Node& x, const Node& y) {
  return x.op == y.op && x.a == y.a && x.b == y.b && x.c == y.c &&
         std::bit_cast<std::uint64_t>(x.value) == std::bit_cast<std::uint64_t>(y.value) &&
         std::bit_cast<std::uint64_t>(x.low) == std::bit_cast<std::uint64_t>(y.low);
}

std::size_t hash(const Node& x) {
  std::uint64_t h = std::bit_cast<std::uint64_t>(x.value) + static_cast<std::uint64_t>(x.op);
  for (const Index part : {x.a, x.b, x.c}) h = (h ^ static_cast<std::uint64_t>(part + 1)) * 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

}  // namespace

/// Where it stands in the table, or the empty place for it.
std::size_t Tape::place_of(const Node& node) const {
  const std::size_t mask = places_.size() - 1;
  std::size_t place = hash(node) & mask;
  while (places_[place] != none && !same((*this)[places_[place]], node)) place = (place + 1) & mask;
  return place;
}

bool Tape::is_linear(const Node& node) const {
  const auto fixed = [&](Index i) { return (*this)[i].op == Op::constant; };
  const auto linear = [&](Index i) { return (*this)[i].linear || fixed(i); };
  switch (node.op) {
    case Op::time:
      return true;
    case Op::add:
    case Op::subtract:
      return linear(node.a) && linear(node.b);
    case Op::multiply:
      return linear(node.a) && linear(node.b) && (fixed(node.a) || fixed(node.b));
    case Op::divide:
      return linear(node.a) && fixed(node.b);
    default:
      return false;
  }
}

Index Tape::write(Node node) {
  std::size_t place = place_of(node);
  if (places_[place] != none) return places_[place];
  node.linear = is_linear(node);
  nodes_.push_back(node);
  const Index written = size() - 1;
  if (2 * nodes_.size() < places_.size()) return places_[place] = written;
  places_.assign(2 * places_.size(), none);
  for (Index i = 0; i <= written; ++i) places_[place_of((*this)[i])] = i;
  return written;
}

}  // namespace least::tape

#include "core/tape/long_sums.hpp"

#include <algorithm>
#include <utility>

namespace least::tape {

namespace {

constexpr std::size_t few_terms = 8;  // the fewest terms of a long sum

std::size_t place_of(Index i) { return static_cast<std::size_t>(i); }

bool adds(Code code) { return code == Code::add || code == Code::subtract; }

}  // namespace

LongSums::LongSums(std::span<const Operation> steps, std::span<const Index> ends)
    : sum_of_(steps.size(), none), absorbed_(steps.size()) {
  std::vector<int> readers(steps.size(), 0);
  for (const Operation& step : steps) for_each_operand(step, [&](Index part) { ++readers[place_of(part)]; });
  for (const Index end : ends) readers[place_of(end)] += 2;
  for (std::size_t i = steps.size(); i-- > 0;) {
    if (!adds(steps[i].code) || absorbed_[i]) continue;
    const auto is_link = [&](Index part) { return adds(steps[place_of(part)].code) && readers[place_of(part)] == 1; };
    Sum sum;
    std::vector<Index> links;
    for (auto link = static_cast<Index>(i); link != none;) {
      const Operation& step = steps[place_of(link)];
      const bool other_way = step.code == Code::add && !is_link(step.a) && is_link(step.b);
      sum.head = other_way ? step.b : step.a;
      sum.terms.push_back(other_way ? step.a : step.b);
      sum.signs.push_back(step.code == Code::add ? 1 : -1);
      links.push_back(link);
      link = is_link(sum.head) ? sum.head : none;
    }
    if (sum.terms.size() < few_terms) continue;
    std::ranges::reverse(sum.terms);
    std::ranges::reverse(sum.signs);
    for (const Index link : links) absorbed_[place_of(link)] = link != static_cast<Index>(i);
    sum_of_[i] = static_cast<Index>(sums_.size());
    sums_.push_back(std::move(sum));
  }
}

}  // namespace least::tape

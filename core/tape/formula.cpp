#include "core/tape/formula.hpp"

#include <limits>
#include <map>

#include "core/tape/long_sums.hpp"
#include "core/tape/translation.hpp"

namespace least::tape {

/// Gives each step of a translation a register, reused after the last reader of its value. The sums of terms come first
/// and keep their registers.
class Formula::Allocator {
 public:
  Allocator(const Tape& tape, const Translation& from, Formula& formula, SharedSums* shared)
      : tape_(tape),
        from_(from),
        formula_(formula),
        shared_(shared),
        given_(from.steps.size()),
        last_(from.steps.size(), none) {}

  void allocate() {
    for (const Operation& step : from_.steps)
      if (step.code == Code::add_up) place_sums(static_cast<Index>(step.value));
    find_last_readers();
    for (Index i = 0; i < size(); ++i) {
      const Operation& step = from_.steps[at(i)];
      if (step.code == Code::total) {
        given_[at(i)] = static_cast<Register>(first_sum_[static_cast<Index>(from_.steps[at(step.a)].value)] +
                                              static_cast<Index>(step.value));
      } else if (step.code == Code::add_up) {
        add_up(step, i);
      } else {
        compute(step, i);
      }
    }
    for (const Index end : from_.ends) formula_.outputs_.push_back(given_[at(end)]);
  }

 private:
  static constexpr Index forever = 1 << 30;
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  Index size() const { return static_cast<Index>(from_.steps.size()); }

  void place_sums(Index terms) {
    first_sum_[terms] = static_cast<Index>(formula_.registers_);
    formula_.registers_ += at(tape_.terms(terms).sums);
    if (formula_.registers_ > std::numeric_limits<Register>::max()) throw TooManyOperations();
  }

  /// Calls f with each step whose register this step reads.
  template <class F>
  void for_each_read(const Operation& step, F&& f) const {
    if (step.code == Code::total) return;
    if (step.code != Code::add_up) return for_each_operand(step, f);
    for (const Index operand : tape_.terms(static_cast<Index>(step.value)).operands)
      if (from_.place[at(operand)] != none) f(from_.place[at(operand)]);
  }
  void find_last_readers() {
    for (Index i = 0; i < size(); ++i) for_each_read(from_.steps[at(i)], [&](Index part) { last_[at(part)] = i; });
    for (const Index end : from_.ends) last_[at(end)] = forever;
    for (Index i = 0; i < size(); ++i)
      if (from_.steps[at(i)].code == Code::total) last_[at(i)] = forever;
  }
  void free_what_ends(const Operation& step, Index i) {
    for_each_read(step, [&](Index part) {
      if (last_[at(part)] != i) return;
      free_.push_back(given_[at(part)]);
      last_[at(part)] = none;  // freed once, even if it is named twice
    });
  }

  void compute(const Operation& step, Index i) {
    const bool of_scene = step.code == Code::variable;
    const auto place = [&](Index part) { return part == none ? Register(0) : given_[at(part)]; };
    Narrow narrow{step.code,     0,         of_scene ? static_cast<Register>(step.a) : place(step.a), place(step.b),
                  place(step.c), step.value};
    free_what_ends(step, i);
    if (last_[at(i)] == none) last_[at(i)] = i;
    if (free_.empty()) {
      if (formula_.registers_ > std::numeric_limits<Register>::max()) throw TooManyOperations();
      free_.push_back(static_cast<Register>(formula_.registers_++));
    }
    narrow.out = given_[at(i)] = free_.back();
    free_.pop_back();
    formula_.steps_.push_back(narrow);
  }

  void add_up(const Operation& step, Index i) {
    const auto terms = static_cast<Index>(step.value);
    Narrow narrow{.code = Code::add_up};
    narrow.out = static_cast<Register>(first_sum_[terms]);
    narrow.a = static_cast<Register>(formula_.sums_.size());
    formula_.sums_.push_back(sums_of(terms));
    formula_.steps_.push_back(narrow);
    free_what_ends(step, i);
  }

  std::shared_ptr<const TermSums> sums_of(Index terms) {
    if (shared_)
      if (const auto known = shared_->find(terms); known != shared_->end()) return known->second;
    const auto registered = [&](Index node) { return static_cast<std::uint32_t>(given_[at(from_.place[at(node)])]); };
    auto made = std::make_shared<const TermSums>(tape_, tape_.terms(terms), registered);
    if (shared_ && !made->reads_registers()) shared_->emplace(terms, made);
    return made;
  }

  const Tape& tape_;
  const Translation& from_;
  Formula& formula_;
  SharedSums* const shared_;
  std::vector<Register> given_, free_;  ///< by step; those that are free
  std::vector<Index> last_;             ///< by step: its last reader
  std::map<Index, Index> first_sum_;    ///< by terms: the register of their first sum
};

Formula::Formula(const Tape& tape, std::span<const Index> outputs, SharedSums* shared) {
  const Translation from = translated(tape, outputs);
  Allocator(tape, from, *this, shared).allocate();
  if (sums_.empty()) batches_ = Batches::of(from.steps, from.ends);
}

std::size_t Formula::operations() const {
  std::size_t all = steps_.size();
  for (const auto& sums : sums_) all += sums->operations();
  return all;
}

}  // namespace least::tape

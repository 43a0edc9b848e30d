#include "core/ensemble/lane_compiler.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "core/ensemble/lane_registers.hpp"

namespace least {

class LaneCompiler {
 public:
  LaneCompiler(const LaneSource& source, CompiledLanes& made)
      : source_(source),
        nodes_(source.trace->nodes()),
        made_(made),
        same_(nodes_.size()),
        needed_(nodes_.size(), false),
        rank_(nodes_.size(), of_step),
        place_(nodes_.size(), nowhere) {}

  void compile() {
    find_same();
    find_needed();
    rank();
    made_.rows_ = source_.rows;
    place_inputs();
    write_constant();
    if (!source_.kept.empty()) write_part(0, source_.begin, made_.start_);
    write_part(source_.begin, source_.end, made_.step_);
    made_.registers_ = registers_.count();
    made_.forces_at_start_ = source_.forces_at_start;
    made_.forces_of_step_ = source_.forces_of_step;
  }

 private:
  using Place = Trace::Place;
  using Node = Trace::Node;
  using Kind = Trace::Kind;
  using Register = std::uint32_t;
  static constexpr Register nowhere = LaneRegisters::nowhere;
  /// Rank tells by bits what a number depends on: the time, and the members' own constants. With no bit set it depends
  /// on the step length alone; what depends on the state has both.
  using Rank = std::uint8_t;
  static constexpr Rank of_step = 0, of_time = 1, of_members = 2, of_state = of_time | of_members;

  static std::size_t at(Place i) { return static_cast<std::size_t>(i); }
  const Node& node(Place i) const { return nodes_[at(i)]; }
  bool in_step(Place i) const { return i >= source_.begin; }
  bool in_lanes(Place i) const { return (rank_[at(i)] & of_members) != 0; }
  /// is_constant: an operation whose result is the same in all steps of one length.
  bool is_constant(Place i) const {
    return node(i).kind == Kind::operation && in_step(i) && (rank_[at(i)] & of_time) == 0;
  }
  /// is_kept: a value that the step reads from the step before it.
  bool is_kept(Place i) const { return node(i).kind == Kind::operation && !in_step(i); }
  static std::array<Place, 3> operands(const Node& n) {
    return n.kind == Kind::operation ? std::array{n.a, n.b, n.c} : std::array<Place, 3>{-1, -1, -1};
  }

  /// find_same maps equal operations of the step, and equal shared constants, to the first of them.
  void find_same() {
    std::map<std::array<Place, 4>, Place> operations;
    std::map<std::uint64_t, Place> constants;
    std::map<Place, Place> variables;
    for (Place i = 0; i < source_.end; ++i) {
      const Node& n = node(i);
      same_[at(i)] = i;
      if (n.kind == Kind::constant && !source_.own[at(n.a)]) {
        const auto bits = std::bit_cast<std::uint64_t>(source_.trace->constants()[at(n.a)]);
        same_[at(i)] = constants.try_emplace(bits, i).first->second;
      }
      if (n.kind == Kind::variable) same_[at(i)] = variables.try_emplace(n.a, i).first->second;
      if (n.kind != Kind::operation || !in_step(i)) continue;
      std::array<Place, 4> key{static_cast<Place>(n.code), -1, -1, -1};
      for (std::size_t k = 0; k < 3; ++k)
        if (operands(n)[k] >= 0) key[k + 1] = same(operands(n)[k]);
      if (n.code == LaneCode::add || n.code == LaneCode::multiply) std::sort(key.begin() + 1, key.begin() + 3);
      same_[at(i)] = operations.try_emplace(key, i).first->second;
    }
  }
  Place same(Place i) const { return same_[at(i)]; }

  void need(Place i, std::vector<Place>& open) {
    i = same(i);
    if (needed_[at(i)]) return;
    needed_[at(i)] = true;
    open.push_back(i);
  }
  void find_needed() {
    std::vector<Place> open;
    for (const Place output : source_.outputs) need(output, open);
    if (source_.failed >= 0) need(source_.failed, open);
    while (!open.empty()) {
      const Place i = open.back();
      open.pop_back();
      for (const Place part : operands(node(i)))
        if (part >= 0) need(part, open);
      if (is_kept(i))
        for (const auto& [from, to] : source_.kept)
          if (from == i) need(to, open);
    }
  }

  /// rank() computes all ranks. A kept value is in lanes if it is so at the start or after a step, which may take
  /// several passes to settle.
  void rank() {
    for (bool changed = true; changed;) {
      changed = false;
      for (Place i = 0; i < source_.end; ++i) {
        const Node& n = node(i);
        Rank& rank = rank_[at(i)];
        if (n.kind == Kind::time) rank = of_time;
        if (n.kind == Kind::variable) rank = of_state;
        if (n.kind == Kind::constant && source_.own[at(n.a)]) rank = of_members;
        for (const Place part : operands(n))
          if (part >= 0) rank |= rank_[at(same(part))];
      }
      for (const auto& [from, to] : source_.kept) {
        Rank& rank = rank_[at(from)];
        const Rank now = rank | rank_[at(same(to))] | of_time;
        changed = changed || now != rank;
        rank = now;
      }
    }
  }

  Register shared_register(double value = 0) {
    made_.shared_.push_back(value);
    return static_cast<Register>(made_.shared_.size()) + 1;
  }
  void place_inputs() {
    std::size_t fixed = source_.rows.size();
    for (Place i = 0; i < source_.end; ++i) {
      const Node& n = node(i);
      if (n.kind == Kind::time) place_[at(i)] = 0;
      if (n.kind == Kind::step) place_[at(i)] = 1;
      if (n.kind == Kind::variable) place_[at(i)] = static_cast<Register>(n.a);
      if (n.kind != Kind::constant || same(i) != i || !needed_[at(i)]) continue;
      if (source_.own[at(n.a)]) {
        made_.own_.push_back(at(n.a));
        place_[at(i)] = static_cast<Register>(fixed++);
      } else {
        place_[at(i)] = shared_register(source_.trace->constants()[at(n.a)]);
      }
    }
    for (const auto& [from, to] : source_.kept) {
      if (!needed_[at(from)]) continue;
      place_[at(from)] = in_lanes(from) ? static_cast<Register>(fixed++) : shared_register();
      (in_lanes(from) ? made_.kept_ : made_.kept_shared_).push_back(place_[at(from)]);
    }
    registers_ = LaneRegisters(fixed);
  }

  /// write_constant writes the operations that are the same in all steps, before all others: no other operation may
  /// reuse their registers.
  void write_constant() {
    clear(source_.begin, source_.end);
    std::vector<Place> all;
    for (Place i = source_.begin; i < source_.end; ++i) {
      if (!needed_[at(i)] || same(i) != i || !is_constant(i)) continue;
      if (!in_lanes(i)) {
        write_shared(i, made_.step_, true);
      } else if (!fused_[at(i)]) {
        write_lanes(i);
        all.push_back(i);
      }
    }
    std::vector<bool> read(nodes_.size(), false);
    for (Place i = source_.begin; i < source_.end; ++i)
      if (needed_[at(i)] && same(i) == i && !is_constant(i))
        for (const Place part : operands(node(i)))
          if (part >= 0) read[at(same(part))] = true;
    for (const Place output : source_.outputs) read[at(same(output))] = true;
    if (source_.failed >= 0) read[at(same(source_.failed))] = true;
    for (const auto& [from, to] : source_.kept) read[at(same(to))] = true;
    std::erase_if(all, [&](Place i) { return !read[at(i)]; });
    auto given = settled();
    made_.step_.of_members = registers_.assign(wide_, {}, all, given);
    for (const Place i : all) place_[at(i)] = given[at(i)];
    registers_ = LaneRegisters(registers_.count());
  }

  void clear(Place begin, Place end) {
    wide_.clear();
    spread_.clear();
    next_ = source_.end;
    count_uses(begin, end);
  }
  /// settled() returns the registers in lanes that are already assigned, by value.
  std::vector<Register> settled() const {
    std::vector<Register> given(at(next_), nowhere);
    for (Place i = 0; i < source_.end; ++i)
      if (in_lanes(i)) given[at(i)] = place_[at(i)];
    return given;
  }

  void write_part(Place begin, Place end, CompiledLanes::Part& part) {
    clear(begin, end);
    RegisterEnds ends;
    const bool step = &part == &made_.step_;
    if (step) collect_ends(part, ends);
    for (Place i = begin; i < end; ++i) {
      if (!needed_[at(i)] || same(i) != i || node(i).kind != Kind::operation || is_constant(i)) continue;
      if (!in_lanes(i)) {
        write_shared(i, part, false);
      } else if (!fused_[at(i)]) {
        write_lanes(i);
      }
    }
    allocate(part, ends, step);
  }

  void count_uses(Place begin, Place end) {
    uses_.assign(at(source_.end), 0);
    fused_.assign(at(source_.end), false);
    const auto use = [&](Place i) { ++uses_[at(same(i))]; };
    for (Place i = begin; i < end; ++i)
      if (needed_[at(i)] && same(i) == i)
        for (const Place part : operands(node(i)))
          if (part >= 0) use(part);
    for (const Place output : source_.outputs) use(output);
    if (source_.failed >= 0) use(source_.failed);
    for (const auto& [from, to] : source_.kept) use(from), use(to);
    for (Place i = begin; i < end; ++i) {
      const Node& n = node(i);
      if (!needed_[at(i)] || same(i) != i || n.kind != Kind::operation) continue;
      if (n.code != LaneCode::add && n.code != LaneCode::subtract) continue;
      const Place a = same(n.a), b = same(n.b);
      if (!in_lanes(a) || !in_lanes(b)) continue;
      const auto fits = [&](Place product) {
        return can_fuse(product, begin) && is_constant(product) == is_constant(i);
      };
      if (fits(b)) {
        fused_[at(b)] = true;
      } else if (n.code == LaneCode::add && fits(a)) {
        fused_[at(a)] = true;
      }
    }
  }
  bool can_fuse(Place i, Place begin) const {
    const Node& n = node(i);
    return i >= begin && n.kind == Kind::operation && n.code == LaneCode::multiply && in_lanes(i) &&
           uses_[at(i)] == 1 && (in_lanes(same(n.a)) || in_lanes(same(n.b)));
  }

  /// lanes(i) returns the value i in lanes, spreading a shared one.
  Place lanes(Place i) {
    i = same(i);
    if (in_lanes(i)) return i;
    const auto [known, fresh] = spread_.try_emplace(i, next_);
    if (fresh) wide_.push_back({LaneCode::spread, next_++, static_cast<Place>(place_[at(i)])});
    return known->second;
  }
  Place shared(Place i) const { return static_cast<Place>(place_[at(same(i))]); }

  void write_lanes(Place i) {
    using enum LaneCode;
    const Node& n = node(i);
    if (n.b >= 0 && !in_lanes(same(n.a)) && !in_lanes(same(n.b))) return write_function(n, i);
    const auto is_shared = [&](Place part) { return !in_lanes(same(part)); };
    const auto product = [&](LaneCode of_two, LaneCode scaled, Place sum, Place with) {
      const Node& m = node(with);
      if (is_shared(m.a)) return wide_.push_back({scaled, i, sum, shared(m.a), same(m.b)});
      if (is_shared(m.b)) return wide_.push_back({scaled, i, sum, shared(m.b), same(m.a)});
      wide_.push_back({of_two, i, sum, same(m.a), same(m.b)});
    };
    switch (n.code) {
      case add: {
        if (is_shared(n.a)) return wide_.push_back({add_shared, i, same(n.b), shared(n.a)});
        if (is_shared(n.b)) return wide_.push_back({add_shared, i, same(n.a), shared(n.b)});
        const Place a = same(n.a), b = same(n.b);
        if (fused_[at(b)]) return product(add_product, add_scaled, a, b);
        if (fused_[at(a)]) return product(add_product, add_scaled, b, a);
        return wide_.push_back({add, i, a, b});
      }
      case subtract:
        if (is_shared(n.a)) return wide_.push_back({from_shared, i, shared(n.a), same(n.b)});
        if (is_shared(n.b)) return wide_.push_back({subtract_shared, i, same(n.a), shared(n.b)});
        if (fused_[at(same(n.b))]) return product(subtract_product, subtract_scaled, same(n.a), same(n.b));
        return wide_.push_back({subtract, i, same(n.a), same(n.b)});
      case multiply:
        if (is_shared(n.a)) return wide_.push_back({scale, i, shared(n.a), same(n.b)});
        if (is_shared(n.b)) return wide_.push_back({scale, i, shared(n.b), same(n.a)});
        return wide_.push_back({multiply, i, same(n.a), same(n.b)});
      case divide:
        if (is_shared(n.a)) return wide_.push_back({over_shared, i, shared(n.a), same(n.b)});
        if (is_shared(n.b)) return wide_.push_back({divide_shared, i, same(n.a), shared(n.b)});
        return wide_.push_back({divide, i, same(n.a), same(n.b)});
      default:
        write_function(n, i);
    }
  }
  /// write_function: all operands must be in lanes.
  void write_function(const Node& n, Place i) {
    LaneOperation one{n.code, i, lanes(n.a)};
    if (n.b >= 0) one.b = lanes(n.b);
    if (n.c >= 0) one.c = lanes(n.c);
    wide_.push_back(one);
  }
  void write_shared(Place i, CompiledLanes::Part& part, bool constant) {
    const Node& n = node(i);
    const auto of = [&](Place operand) { return operand < 0 ? Register(0) : place_[at(same(operand))]; };
    if (place_[at(i)] == nowhere) place_[at(i)] = shared_register();
    auto& code = constant ? part.of_step : part.of_time;
    code.push_back({n.code, place_[at(i)], of(n.a), of(n.b), of(n.c)});
  }

  /// At its end a step leaves the state and the kept values in the registers where the next step expects them.
  using RegisterEnds = std::vector<LaneRegisters::End>;
  void collect_ends(CompiledLanes::Part& part, RegisterEnds& ends) {
    for (std::size_t k = 0; source_.steps && k < source_.outputs.size(); ++k)
      add_end(source_.outputs[k], static_cast<Register>(k), ends);
    for (const auto& [from, to] : source_.kept) {
      if (!needed_[at(from)] || same(to) == from) continue;
      if (in_lanes(from)) {
        add_end(to, place_[at(from)], ends);
      } else if (is_kept(same(to))) {  // which by then holds another value
        part.of_time.push_back({LaneCode::copy, shared_register(), place_[at(same(to))]});
        after_.emplace_back(from, part.of_time.back().out);
      } else {
        after_.emplace_back(from, nowhere);
      }
    }
  }
  void add_end(Place value, Register where, RegisterEnds& ends) {
    value = same(value);
    if (in_lanes(value) && place_[at(value)] == where) return;
    if (in_lanes(value) && place_[at(value)] != nowhere) {  // its register will be overwritten: it is copied at once
      wide_.push_back({LaneCode::copy, next_, value});
      value = next_++;
    }
    ends.emplace_back(value, where);
  }

  /// at_end returns the value i in lanes, after all other operations.
  Place at_end(Place i) {
    i = same(i);
    if (in_lanes(i)) return i;
    wide_.push_back({LaneCode::spread, next_, shared(i)});
    return next_++;
  }
  void allocate(CompiledLanes::Part& part, RegisterEnds& ends, bool step) {
    std::vector<Place> alive;
    for (auto& [value, where] : ends)
      if (value < source_.end) value = at_end(value);
    if (step && source_.failed >= 0) alive.push_back(at_end(source_.failed));
    if (step && !source_.steps)
      for (const Place output : source_.outputs) alive.push_back(at_end(output));
    auto given = settled();
    part.of_lanes = registers_.assign(wide_, ends, alive, given);
    if (!step) return;
    std::size_t next = 0;
    if (source_.failed >= 0) made_.failed_ = static_cast<std::int32_t>(given[at(alive[next++])]);
    for (; next < alive.size(); ++next) made_.outputs_.push_back(given[at(alive[next])]);
    for (const auto& [from, copy] : after_) {
      const auto to = std::ranges::find(source_.kept, from, &std::pair<Place, Place>::first)->second;
      made_.after_.push_back({LaneCode::copy, place_[at(from)], copy == nowhere ? place_[at(same(to))] : copy});
    }
  }

  const LaneSource& source_;
  const std::vector<Node>& nodes_;
  CompiledLanes& made_;
  std::vector<Place> same_;
  std::vector<bool> needed_, fused_;
  std::vector<Rank> rank_;
  std::vector<Register> place_;  ///< by shared number, and by value that is always in the same register in lanes
  std::vector<int> uses_;
  std::vector<LaneOperation> wide_;
  std::map<Place, Place> spread_;
  std::vector<std::pair<Place, Register>> after_;  ///< kept shared numbers, and where they were copied to
  Place next_ = 0;                                 ///< the number of the next value that the trace does not have
  LaneRegisters registers_{0};
};

CompiledLanes::CompiledLanes(const LaneSource& source) { LaneCompiler(source, *this).compile(); }

LaneProgram CompiledLanes::program() const {
  return {shared_,      rows_, own_.size(), registers_, start_.view(),    step_.view(),   after_,
          kept_shared_, kept_, outputs_,    failed_,    forces_at_start_, forces_of_step_};
}

}  // namespace least

#include "core/ensemble/lane_members.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/ensemble/lane_plane.hpp"
#include "core/ensemble/member_group.hpp"
#include "core/ensemble/member_starts.hpp"
#include "core/run/diagnostics/watch.hpp"
#include "core/run/integrator.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/step_guard.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

constexpr std::size_t bytes_of_operation = 100;  ///< of a trace and of the program compiled from it

/// LaneBlock runs one block in lanes.
class LaneBlock final : public LaneHost {
 public:
  LaneBlock(const EnsemblePlan& plan, const MemberColumns& columns, Block& block, const std::atomic<bool>& cancelled)
      : plan_(plan),
        columns_(columns),
        block_(block),
        request_(plan.request),
        card_(request_.scene->card()),
        watch_(request_),
        needed_(columns.needed().size()) {
    request_.columns = columns.needed();
    request_.measures = {};
    const auto count = static_cast<std::size_t>(block.count);
    const std::size_t numbers = 2 * card_.variables.size() + plan.members.vary.size() + 2 * columns_.size() + 4;
    tables_ = sizeof(double) * (numbers * count + 3 * (section_count(plan) + row_count(plan)));
    block.held.add(tables_);
    if (const std::size_t points = count * section_count(plan); points > 0)
      block.harvest.section.make_room(std::min(points, most_points()), columns_.size(), block.held);
    const SchemeCard& scheme = request_.scene->mechanics->schemes()[request_.scheme];
    const Grid grid(request_, request_.settings[*scheme.find("step")]);
    looks_ = looks_of(plan);
    constexpr double at_the_end = std::numeric_limits<double>::infinity();
    for (const Look& look : looks_) times_.push_back(look.row && look.t == grid.end ? at_the_end : look.t);
    task_.scheme = static_cast<std::size_t>(std::ranges::find(lane_schemes, scheme.id) - lane_schemes.begin());
    task_.settings = request_.settings;
    task_.parameters = request_.scene->parameters;
    task_.count = count;
    full_ = std::ranges::any_of(request_.columns, [&](std::size_t i) { return card_.columns[i].full_state; });
    task_.start_time = grid.start;
    task_.step = grid.step;
    task_.end = grid.end;
    task_.tail = grid.tail;
    task_.steps = grid.steps;
    task_.step_limit = request_.limits.steps;
    task_.times = times_;
    if (!watch_.empty()) {
      fits_ = is_of_lanes(plan);
      task_.watches = true;
      if (const auto level = level_of(request_)) {
        task_.watched = level->variable;
        task_.level = level->value;
      }
      full_ = full_ || request_.watched.full_state();
      left_.resize(card_.variables.size() + 1);
      right_ = between_ = left_;
    }
    task_.host = this;
    task_.cancelled = &cancelled;

    fill_tables();
    ended_.assign(count, static_cast<std::uint8_t>(ReturnCode::cancelled));
    crossings_.assign(count, 0);
    looked_.assign(count, 0);
    if (task_.watches) unresolved_.resize(count);
    if (task_.watches && task_.watched < 0) steps_.resize(count);
    finals_.resize(count * columns_.size());
    if (!plan.trajectories) return;
    block.harvest.trajectories.open(block.first, count, row_count(plan) * columns_.size(), block.held);
  }

  bool run(const LaneUnit& unit) {
    if (!fits_ || task_.scheme == lane_schemes.size()) return false;
    return request_.scene->mechanics->text() ? run_text(unit) : run_problem(unit);
  }
  void gather() {
    Harvest& harvest = block_.harvest;
    const auto columns = static_cast<std::ptrdiff_t>(columns_.size());
    for (std::size_t m = 0; m < ended_.size(); ++m) {
      ++harvest.ended[ended_[m]];
      if (static_cast<ReturnCode>(ended_[m]) != ReturnCode::completed) continue;
      harvest.final_member.push_back(block_.first + static_cast<std::int64_t>(m));
      const auto row = finals_.begin() + static_cast<std::ptrdiff_t>(m) * columns;
      harvest.final.insert(harvest.final.end(), row, row + columns);
    }
    for (std::size_t m = 0; m < unresolved_.size(); ++m)
      if (unresolved_[m].which != 0) harvest.add_unresolved(block_.first + static_cast<std::int64_t>(m));
    harvest.cost.steps = task_.taken;
    harvest.cost.force_evaluations = task_.forces;
    keep_first_points();
    harvest.trajectories.close(columns_.size());
    const std::size_t kept = sizeof(double) * (harvest.final.capacity() + harvest.final_member.capacity());
    block_.held.shrink_by(tables_ - std::min(tables_, kept));
  }

  double turn_limit(double damping_step) override {
    const auto known = limits_.find(damping_step);
    if (known != limits_.end()) return known->second;
    const auto bound = [&](double a) { return stability_bound(request_.scheme, request_.settings, a); };
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const bool grows = stability_bound(request_.scheme, request_.settings, 0, 0) == 0;
    const double most = grows ? infinite : bound(damping_step);
    return limits_[damping_step] = most * most * (1 + 1e-6);
  }
  bool is_too_fast(double turn_squared, double damping_step) override {
    const auto [known, fresh] = too_fast_.try_emplace({turn_squared, damping_step});
    if (fresh) {
      StepGuard guard(request_.scheme, request_.settings, damping_step, true, true, false);
      guard.see(turn_squared);
      known->second = guard.exceeded();
    }
    return known->second;
  }
  void at_time(std::size_t m, double t, const double* state) override {
    const Look& look = looks_[looked_[in_block(m)]++];
    look.row ? add_row(m, t, state) : add_point(m, t, state);
  }
  void at_step(std::size_t m, double t_before, std::span<const double> before, double t,
               std::span<const double> after) override {
    std::ranges::copy(before, left_.begin());
    std::ranges::copy(after, right_.begin());
    if (!may_cross(m, t_before, t)) return;
    const auto state_at = [&](double time, double* state) {
      return group_->advance(m, t_before, time - t_before, left_.data(), state);
    };
    Watch::Unresolved& unresolved = unresolved_[in_block(m)];
    watch_.turn_to(unresolved);
    for (const Zero& zero : watch_.locate(left_.data(), t_before, right_.data(), t, state_at, 1)) {
      const double* state = zero.t > t_before ? right_.data() : left_.data();
      if (zero.t > t_before && zero.t < t && state_at(zero.t, between_.data())) state = between_.data();
      add_point(m, zero.t, state);
    }
    unresolved = watch_.unresolved();
  }

 private:
  bool gone() const { return task_.cancelled->load(std::memory_order_relaxed); }
  /// may_cross judges the states at both ends of a step. For a level, lanes have judged already whether it may be
  /// crossed twice.
  bool may_cross(std::size_t m, double from, double to) {
    if (task_.watched >= 0) {
      const Watch::Signs was = watch_.signs(left_.data(), from), is = watch_.signs(right_.data(), to);
      return was == is || watch_.crossed(was, is);
    }
    Watch::Looks& looks = steps_[in_block(m)];
    if (!(looks.t_last() == from)) watch_.look(looks, left_.data(), from);
    return watch_.look(looks, right_.data(), to) != 0;
  }
  /// run_problem runs members of a problem of the catalogue: by compiled steps if the unit has them and members share
  /// all parameters; else by a program in which varied parameters are the members' own constants.
  bool run_problem(const LaneUnit& unit) {
    const RunLanes compiled = varied_.empty() && !full_ ? unit.problem(card_.id) : nullptr;
    return (compiled && run_compiled(compiled)) || run_as_program(unit);
  }
  bool run_compiled(RunLanes compiled) {
    auto trace = trace_problem(request_, {}, task_.watches ? std::optional(task_.scheme) : std::nullopt, false);
    if (!trace) return false;
    const Held held = HeldByThread::take(bytes_of_operation * trace->trace.nodes().size());
    MemberGroup group = group_of_all(std::move(*trace));
    group.compile_values();
    if (task_.watches) group.compile_steps();
    std::vector<double> final(start_.size());
    task_.start = start_.data();
    task_.final = final.data();
    task_.ended = ended_.data();
    group_ = &group;
    const bool ran = compiled(task_);
    if (ran) take_final();
    group_ = nullptr;
    return ran;
  }
  bool run_as_program(const LaneUnit& unit) {
    auto trace = trace_problem(request_, varied_, task_.scheme, full_);
    if (!trace) return false;
    const Held held = HeldByThread::take(bytes_of_operation * trace->trace.nodes().size());
    MemberGroup group = group_of_all(std::move(*trace));
    const std::size_t count = ended_.size();
    for (std::size_t k = 0; k < varied_.size(); ++k)
      group.set_parameter(k, std::span(values_).subspan(k * count, count));
    run_group(unit, group);
    return true;
  }
  MemberGroup group_of_all(StepTrace&& trace) const {
    MemberGroup group(std::move(trace));
    for (std::size_t m = 0; m < ended_.size(); ++m) group.add(m, {});
    return group;
  }

  /// run_text runs members with equal traces together. Where parameters vary each member is traced, and only so many
  /// traces are kept at once. False, too, where hardly two are alike: they are better run one by one.
  bool run_text(const LaneUnit& unit) {
    constexpr std::size_t most_kept = 2'000'000, many = 64, alike = 4;  // most_kept: constants and operations
    const text::TextScene& text = *request_.scene->mechanics->text();
    std::vector<MemberGroup> groups;
    std::size_t kept = 0, members = 0;
    Held held = HeldByThread::take(0);
    const auto run_groups = [&] {
      if (groups.size() > many && members < alike * groups.size()) return false;
      for (MemberGroup& group : groups)
        if (!gone()) run_group(unit, group);
      groups.clear();
      held = HeldByThread::take(0);
      kept = members = 0;
      return true;
    };
    for (std::size_t m = 0; m < ended_.size() && !gone(); ++m) {
      if (varied_.empty() && m > 0) {
        groups[0].add(m, {});
        continue;
      }
      const auto parameters = parameters_of(m);
      if (!varied_.empty() && text.objection(parameters)) {  // such as a mass that is not positive
        ended_[m] = static_cast<std::uint8_t>(ReturnCode::singular);
        continue;
      }
      auto trace = trace_text(request_, parameters, task_.scheme, full_);
      if (!trace) return false;
      std::vector<double> constants;
      if (!varied_.empty()) constants = trace->trace.constants();
      auto group = std::ranges::find_if(groups, [&](const MemberGroup& one) { return one.has(*trace); });
      if (group == groups.end()) {
        kept += trace->trace.nodes().size();
        held.add(bytes_of_operation * trace->trace.nodes().size());
        group = groups.emplace(groups.end(), std::move(*trace));
      }
      kept += constants.size();
      ++members;
      group->add(m, std::move(constants));
      if (kept > most_kept && !varied_.empty() && !run_groups()) return false;
    }
    return run_groups();
  }
  void run_group(const LaneUnit& unit, MemberGroup& group) {
    group.compile_values();
    const std::size_t count = group.members().size(), rows = card_.variables.size();
    std::size_t moving = rows;  // an s that the motion does not need is the last variable
    while (moving > 0 && card_.variables[moving - 1].optional) --moving;
    std::vector<double> start(rows * count), final(rows * count), state(rows);
    std::vector<std::uint8_t> ended(count, static_cast<std::uint8_t>(ReturnCode::cancelled));
    for (std::size_t i = 0; i < count && !gone(); ++i) {
      bool near = true;
      for (const std::size_t k : group.rows()) {  // other rows are not part of the state and may be NaN
        state[k] = start[k * count + i] = start_[k * ended_.size() + group.members()[i]];
        near = near && (k >= moving || std::abs(state[k]) < largest_component);
      }
      const ReturnCode objection = group.objection_to_start(i, task_, state.data(), near);
      if (objection != ReturnCode::completed) ended[i] = static_cast<std::uint8_t>(objection);
    }
    if (gone()) return;
    group.compile_steps();
    LaneTask whole = task_;
    task_.program = &group.step();
    task_.own = group.own();
    task_.count = count;
    task_.start = start.data();
    task_.final = final.data();
    task_.ended = ended.data();
    task_.variables = rows;
    task_.moving = moving;
    group_ = &group;
    unit.programs().run(task_);
    take_final();
    for (std::size_t i = 0; i < count; ++i) ended_[group.members()[i]] = ended[i];
    group_ = nullptr;
    whole.taken = task_.taken;
    whole.forces = task_.forces;
    task_ = whole;
  }

  /// in_block returns the place in the block of a member of the task.
  std::size_t in_block(std::size_t m) const { return group_->members()[m]; }
  void take_final() {
    std::vector<double> state(task_.variables), row;
    for (std::size_t m = 0; m < task_.count; ++m) {
      if (gone()) return;  // as evaluating expressions may take long
      if (static_cast<ReturnCode>(task_.ended[m]) != ReturnCode::completed) continue;
      for (std::size_t i = 0; i < state.size(); ++i) state[i] = task_.final[i * task_.count + m];
      row.clear();
      append_columns(m, task_.end, state.data(), row);
      std::ranges::copy(row, finals_.begin() + static_cast<std::ptrdiff_t>(in_block(m) * row.size()));
    }
  }

  std::vector<double> parameters_of(std::size_t m) const {
    std::vector<double> parameters = request_.scene->parameters;
    for (std::size_t k = 0; k < varied_.size(); ++k) parameters[varied_[k]] = values_[k * ended_.size() + m];
    return parameters;
  }

  void fill_tables() {
    const std::size_t count = task_.count;
    start_.resize(card_.variables.size() * count);
    for (const Variation& variation : plan_.members.vary)
      if (variation.is_parameter()) varied_.push_back(variation.index);
    values_.resize(varied_.size() * count);
    const MemberStarts starts(plan_);
    std::vector<double> parameters, initial;
    for (std::size_t m = 0; m < count; ++m) {
      starts.find(block_.first + static_cast<std::int64_t>(m), parameters, initial);
      for (std::size_t i = 0; i < initial.size(); ++i) start_[i * count + m] = initial[i];
      for (std::size_t k = 0; k < varied_.size(); ++k) values_[k * count + m] = parameters[varied_[k]];
    }
  }

  void append_columns(std::size_t m, double t, const double* state, std::vector<double>& to) {
    group_->columns(m, t, state, needed_.data());
    own_values_.clear();
    for (std::size_t k = 0; k < varied_.size(); ++k) own_values_.push_back(values_[k * ended_.size() + in_block(m)]);
    to.resize(to.size() + columns_.size());
    columns_.fill(needed_.data(), t, own_values_, &to[to.size() - columns_.size()]);
  }
  void add_row(std::size_t m, double t, const double* state) {
    if (gone()) return;
    row_.clear();
    append_columns(m, t, state, row_);
    block_.harvest.trajectories.add(in_block(m), row_);
  }
  void add_point(std::size_t m, double t, const double* state) {
    SectionPoints& points = block_.harvest.section;
    if (gone()) return;  // then the block is discarded
    if (points.t.size() >= most_points()) keep_first_points();
    points.make_room(points.t.size() + 1, columns_.size(), block_.held);
    points.member.push_back(block_.first + static_cast<std::int64_t>(in_block(m)));
    points.crossing.push_back(crossings_[in_block(m)]++);
    points.t.push_back(t);
    append_columns(m, t, state, points.values);
  }
  /// most_points() is the number of points kept before the surplus is removed.
  std::size_t most_points() const { return static_cast<std::size_t>(5 * plan_.request.most_points() / 4 + block_size); }
  /// keep_first_points orders the points by member and crossing, and keeps as many as the limit allows.
  void keep_first_points() {
    SectionPoints& all = block_.harvest.section;
    const auto most = static_cast<std::size_t>(plan_.request.most_points());
    block_.harvest.truncated = block_.harvest.truncated || all.t.size() > most;
    all.sort(block_.first, static_cast<std::size_t>(block_.count), most, block_.held, [&] { return !gone(); });
  }

  const EnsemblePlan& plan_;
  const MemberColumns& columns_;
  Block& block_;
  Request request_;  ///< that of the plan, with the needed columns instead
  const ProblemCard& card_;
  Watch watch_;
  bool fits_ = true;        ///< lanes can watch the plane
  bool full_ = false;       ///< s is part of the state where the scene has one
  std::size_t tables_ = 0;  ///< bytes of the block's tables, and of final states
  LaneTask task_;
  std::vector<double> left_, right_, between_;     ///< states around a crossing, as an expression reads them
  MemberGroup* group_ = nullptr;                   ///< whose members the task has
  std::vector<double> needed_, own_values_, row_;  ///< for one row: columns of the card, varied parameters, result
  std::vector<double> times_, start_, values_, finals_;
  std::vector<std::size_t> varied_;
  std::vector<std::uint8_t> ended_;
  std::vector<std::int64_t> crossings_;
  std::vector<Look> looks_;                    ///< common to all members
  std::vector<std::size_t> looked_;            ///< by member, how many looks it has had
  std::vector<Watch::Looks> steps_;            ///< by member, where all of its steps are reported
  std::vector<Watch::Unresolved> unresolved_;  ///< by member, where its steps are reported
  std::map<double, double> limits_;
  std::map<std::pair<double, double>, bool> too_fast_;
};

}  // namespace

void evaluate_in_lanes(const LaneProgram& program, const LanePoint& point, double* out) {
  static const auto evaluate = lane_units().back().programs().evaluate;
  thread_local std::vector<double> room;
  evaluate(program, point, room, out);
}

bool run_lane_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled, const LaneUnit& unit) {
  LaneBlock lanes(plan, columns, block, cancelled);
  if (!lanes.run(unit)) {
    block.harvest = {};
    return false;
  }
  lanes.gather();
  return true;
}

}  // namespace least

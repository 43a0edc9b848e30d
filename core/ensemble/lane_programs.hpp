// Interprets programs (core/ensemble/lane_program.hpp) in lanes, each instruction for all packs of a group. Only the
// lane units include this header.
#pragma once

#include "core/ensemble/lane_run.hpp"

namespace least {

/// Functions that no compiled problem needs in lanes.
namespace lane_functions {
using least::abs, least::cos, least::exp, least::expm1, least::log, least::pow, least::sin, least::sqrt, least::tanh;
#ifdef LEAST_SLEEF
#define LEAST_LANE_FUNCTION(name) \
  LEAST_INLINE Lanes name(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(name, u10)); }
#else
#define LEAST_LANE_FUNCTION(name) \
  LEAST_INLINE Lanes name(const Lanes& a) { return detail::each(a, Sleef_cinz_##name##d1_u10purec); }
#endif
#define LEAST_BOTH(name)    \
  LEAST_LANE_FUNCTION(name) \
  inline double name(double a) { return Sleef_cinz_##name##d1_u10purec(a); }
LEAST_BOTH(tan)
LEAST_BOTH(sinh)
LEAST_BOTH(cosh)
LEAST_BOTH(atan)
LEAST_BOTH(asin)
LEAST_BOTH(acos)
#undef LEAST_BOTH
#undef LEAST_LANE_FUNCTION
}  // namespace lane_functions

/// execute runs instructions on registers of Width numbers T each; `shared` are the shared registers.
template <class T, std::size_t Width>
void execute(std::span<const LaneInstruction> code, T* registers, const double* shared) {
  using enum LaneCode;
  for (const LaneInstruction& one : code) {
    T* const out = registers + one.out * Width;
    const auto at = [registers](std::uint32_t place) { return registers + place * Width; };
    const auto with_a = [&](auto&& f) {
      const T* const a = at(one.a);
#pragma GCC unroll 8
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(a[j]);
    };
    const auto with_b = [&](auto&& f) {
      const T* const b = at(one.b);
#pragma GCC unroll 8
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(b[j]);
    };
    const auto with_two = [&](auto&& f) {
      const T *const a = at(one.a), *const b = at(one.b);
#pragma GCC unroll 8
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(a[j], b[j]);
    };
    const auto with_three = [&](auto&& f) {
      const T *const a = at(one.a), *const b = at(one.b), *const c = at(one.c);
#pragma GCC unroll 8
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(a[j], b[j], c[j]);
    };
    const auto scaled = [&](auto&& f) {
      const T u(shared[one.b]), *const a = at(one.a), *const c = at(one.c);
#pragma GCC unroll 8
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(a[j], u * c[j]);
    };
    // Not unrolled, as functions are called.
    const auto call = [&](auto&& f) {
      const T* const a = at(one.a);
#pragma GCC unroll 1
      for (std::size_t j = 0; j < Width; ++j) out[j] = f(a[j]);
    };
    switch (one.code) {
      case add:
        with_two([](const T& a, const T& b) { return a + b; });
        break;
      case subtract:
        with_two([](const T& a, const T& b) { return a - b; });
        break;
      case multiply:
        with_two([](const T& a, const T& b) { return a * b; });
        break;
      case divide:
        with_two([](const T& a, const T& b) { return a / b; });
        break;
      case add_shared:
        with_a([u = T(shared[one.b])](const T& a) { return a + u; });
        break;
      case subtract_shared:
        with_a([u = T(shared[one.b])](const T& a) { return a - u; });
        break;
      case from_shared:
        with_b([u = T(shared[one.a])](const T& b) { return u - b; });
        break;
      case scale:
        with_b([u = T(shared[one.a])](const T& b) { return u * b; });
        break;
      case divide_shared:
        with_a([u = T(shared[one.b])](const T& a) { return a / u; });
        break;
      case over_shared:
        with_b([u = T(shared[one.a])](const T& b) { return u / b; });
        break;
      case add_product:
        with_three([](const T& a, const T& b, const T& c) { return a + b * c; });
        break;
      case subtract_product:
        with_three([](const T& a, const T& b, const T& c) { return a - b * c; });
        break;
      case add_scaled:
        scaled([](const T& a, const T& product) { return a + product; });
        break;
      case subtract_scaled:
        scaled([](const T& a, const T& product) { return a - product; });
        break;
      case copy:
        with_a([](const T& a) { return a; });
        break;
      case spread: {
        const T u(shared[one.a]);
        for (std::size_t j = 0; j < Width; ++j) out[j] = u;
        break;
      }
      case sqrt:
        with_a([](const T& a) { return lane_functions::sqrt(a); });
        break;
      case abs:
        with_a([](const T& a) { return lane_functions::abs(a); });
        break;
      case raise: {
        const T *const a = at(one.a), *const b = at(one.b);
#pragma GCC unroll 1
        for (std::size_t j = 0; j < Width; ++j) out[j] = lane_functions::pow(a[j], b[j]);
        break;
      }
      case exp:
        call([](const T& a) { return lane_functions::exp(a); });
        break;
      case expm1:
        call([](const T& a) { return lane_functions::expm1(a); });
        break;
      case log:
        call([](const T& a) { return lane_functions::log(a); });
        break;
      case sin:
        call([](const T& a) { return lane_functions::sin(a); });
        break;
      case cos:
        call([](const T& a) { return lane_functions::cos(a); });
        break;
      case tan:
        call([](const T& a) { return lane_functions::tan(a); });
        break;
      case sinh:
        call([](const T& a) { return lane_functions::sinh(a); });
        break;
      case cosh:
        call([](const T& a) { return lane_functions::cosh(a); });
        break;
      case tanh:
        call([](const T& a) { return lane_functions::tanh(a); });
        break;
      case atan:
        call([](const T& a) { return lane_functions::atan(a); });
        break;
      case asin:
        call([](const T& a) { return lane_functions::asin(a); });
        break;
      case acos:
        call([](const T& a) { return lane_functions::acos(a); });
        break;
      case less:
        with_two([](const T& a, const T& b) { return least::select(a < b, T(1.0), T(0.0)); });
        break;
      case not_greater:
        with_two([](const T& a, const T& b) { return least::select(a <= b, T(1.0), T(0.0)); });
        break;
      case LaneCode::select:
        with_three(
            [](const T& a, const T& b, const T& c) { return least::select(lane_functions::abs(a) > T(0.0), b, c); });
        break;
    }
  }
}

/// ProgramRun is a program with its registers: program.registers × Width numbers in lanes, and shared_count(program)
/// shared ones, both owned by the caller.
template <class T, std::size_t Width>
class ProgramRun {
 public:
  static std::size_t shared_count(const LaneProgram& program) { return 2 + program.shared.size(); }

  ProgramRun(const LaneProgram& program, T* registers, double* shared)
      : program_(program), registers_(registers), shared_(shared) {
    std::ranges::copy(program.shared, shared_ + 2);
  }
  T* at(std::size_t place) { return registers_ + place * Width; }

  /// start(t, h) computes, from the state in its registers, the values that the first step expects from a step before
  /// it.
  void start(double t, double h) {
    shared_[0] = t;
    set_step(h);
    run(program_.start.of_step);
    run(program_.start.of_time);
    execute<T, Width>(program_.start.of_lanes, registers_, shared_);
  }
  void set_step(double h) {
    if (h == shared_[1] && prepared_) return;
    shared_[1] = h;
    prepared_ = true;
    run(program_.step.of_step);
    execute<T, Width>(program_.step.of_members, registers_, shared_);
  }
  /// forget_step(): the members' own constants have changed, so that what depends on them is to be computed anew.
  void forget_step() { prepared_ = false; }
  void step(double t) {
    shared_[0] = t;
    run(program_.step.of_time);
    execute<T, Width>(program_.step.of_lanes, registers_, shared_);
    run(program_.after);
  }

  /// StepCache saves the values that are carried from one step to the next, to undo steps.
  struct StepCache {
    std::vector<T> lanes;
    std::vector<double> shared;
  };
  void keep(StepCache& kept) {
    kept.lanes.clear();
    kept.shared.clear();
    for (const auto place : program_.kept) kept.lanes.insert(kept.lanes.end(), at(place), at(place) + Width);
    for (const auto place : program_.kept_shared) kept.shared.push_back(shared_[place]);
  }
  void take_back(const StepCache& kept) {
    std::size_t k = 0;
    for (const auto place : program_.kept) std::copy_n(kept.lanes.data() + Width * k++, Width, at(place));
    for (k = 0; k < kept.shared.size(); ++k) shared_[program_.kept_shared[k]] = kept.shared[k];
  }

 private:
  void run(std::span<const LaneInstruction> code) { execute<double, 1>(code, shared_, nullptr); }

  const LaneProgram& program_;
  T* registers_;
  double* shared_;
  bool prepared_ = false;
};

/// ProgramSteps is the stepper of a group by the program of its task.
class ProgramSteps final : public GroupSteps {
 public:
  ProgramSteps(const LaneTask& task, std::size_t first, const Lanes* x)
      : program_(*task.program),
        registers_(program_.registers * packs),
        shared_(ProgramRun<Lanes, packs>::shared_count(program_)),
        run_(program_, registers_.data(), shared_.data()),
        x_(x, x + packs * task.variables) {
    show_states(x_.data(), task.variables, task.moving, task.variables);
    for (std::size_t k = 0; k < program_.own; ++k)
      for (std::size_t j = 0; j < packs; ++j)
        for (std::size_t lane = 0; lane < lane_count; ++lane)
          run_.at(program_.rows.size() + k)[j][lane] =
              task.own[k * task.count + std::min(first + j * lane_count + lane, task.count - 1)];
    load();
    run_.start(task.start_time, task.step);
  }

  void advance(double, double start, double step, std::int64_t n, std::int64_t count, double h,
               StepObservations& seen) override {
    load();
    run_.set_step(h);
    for (std::int64_t end = n + count; n < end; ++n) {
      run_.step(start + static_cast<double>(n) * step);
      if (program_.failed < 0) continue;
      const Lanes* const failed = run_.at(static_cast<std::size_t>(program_.failed));
      for (std::size_t j = 0; j < packs; ++j) seen.well[j] = seen.well[j] & (failed[j] <= Lanes(0));
    }
    steps_ += count;
    for (std::size_t k = 0; k < program_.rows.size(); ++k)
      for (std::size_t j = 0; j < packs; ++j) state(j)[program_.rows[k]] = run_.at(k)[j];
  }
  void keep() override {
    run_.keep(kept_);
    kept_steps_ = steps_;
  }
  void take_back() override {
    run_.take_back(kept_);
    steps_ = kept_steps_;
  }
  void take_lane(GroupSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                 std::size_t lane) override {
    auto& run = static_cast<ProgramSteps&>(other).run_;
    const auto take = [&](std::size_t place) { run_.at(place)[pack][lane] = run.at(place)[from_pack][from]; };
    for (std::size_t k = 0; k < program_.own; ++k) take(program_.rows.size() + k);
    for (const auto place : program_.kept) take(place);
    run_.forget_step();
  }
  LaneFaults after(std::size_t j, const StepObservations& seen, double step, bool exactly) override {
    using enum ReturnCode;
    if (!exactly || program_.failed < 0) return GroupSteps::after(j, seen, step, exactly);
    const Lanes failure = run_.at(static_cast<std::size_t>(program_.failed))[j];
    const auto is = [&](StepFailure why) {
      const Lanes code(static_cast<double>(why));
      return (failure >= code) & (failure <= code);
    };
    const LaneMask good = finite(state(j), moving());
    LaneFaults faults;
    faults.add(is(StepFailure::singular), singular);
    faults.add(is(StepFailure::left_domain) & good, left_domain);
    faults.add(!good, not_finite);
    faults.add(is(StepFailure::unstable), unstable_step);
    return faults;
  }
  Work work() const override { return {program_.forces_at_start + steps_ * program_.forces_of_step}; }

 private:
  void load() {
    for (std::size_t k = 0; k < program_.rows.size(); ++k)
      for (std::size_t j = 0; j < packs; ++j) run_.at(k)[j] = state(j)[program_.rows[k]];
  }

  const LaneProgram& program_;
  std::vector<Lanes> registers_;
  std::vector<double> shared_;
  ProgramRun<Lanes, packs> run_;
  ProgramRun<Lanes, packs>::StepCache kept_;
  std::vector<Lanes> x_;
  std::int64_t steps_ = 0, kept_steps_ = 0;
};

class ProgramMaker final : public GroupMaker {
 public:
  explicit ProgramMaker(const LaneTask& task) : task_(task) {}
  std::unique_ptr<GroupSteps> of(std::size_t first, const Lanes* x) const override {
    return std::make_unique<ProgramSteps>(task_, first, x);
  }

 private:
  const LaneTask& task_;
};

/// run_program runs a task by its program.
inline void run_program(LaneTask& task) {
  run_members(task, ProgramMaker(task), task.program->registers * packs * sizeof(Lanes), task.variables);
}

/// evaluate_program implements LanePrograms::evaluate.
inline void evaluate_program(const LaneProgram& program, const LanePoint& point, std::vector<double>& room,
                             double* out) {
  using Run = ProgramRun<double, 1>;
  room.resize(std::max(room.size(), program.registers + Run::shared_count(program)));
  Run run(program, room.data(), room.data() + program.registers);
  const std::size_t rows = program.rows.size();
  for (std::size_t k = 0; k < rows; ++k) *run.at(k) = point.values[program.rows[k]];
  for (std::size_t k = 0; k < program.own; ++k) *run.at(rows + k) = point.own[k];
  run.start(point.t, point.h);
  run.step(point.t);
  if (!program.outputs.empty()) {
    for (const auto place : program.outputs) *out++ = *run.at(place);
    return;
  }
  for (std::size_t k = 0; k < rows; ++k) *out++ = *run.at(k);
  if (program.failed >= 0) *out = *run.at(static_cast<std::size_t>(program.failed));
}

}  // namespace least

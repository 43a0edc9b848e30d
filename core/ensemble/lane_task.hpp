// The interface between an ensemble and the units of lanes, which are compiled for several instruction sets: only
// numbers and pointers, and nothing that a unit would compile for another one.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/ensemble/lane_program.hpp"

namespace least {

/// The names of the schemes that lanes know: those with fixed steps and without equations to solve. A scheme is given
/// by its place here.
inline constexpr std::array<std::string_view, 9> lane_schemes{
    "explicit_euler", "explicit_midpoint",        "runge_kutta_4",    "ruth_3",           "symplectic_euler",
    "leapfrog",       "contact_symplectic_euler", "contact_leapfrog", "contact_splitting"};

/// LaneHost is what lanes ask of, and report to, the owner of a task.
class LaneHost {
 public:
  virtual ~LaneHost() = default;
  /// turn_limit returns the value of (ωh)² from which on a step is unstable; infinite: never. `damping_step` is αh.
  virtual double turn_limit(double damping_step) = 0;
  /// is_too_fast answers the same question where ω is the same in all states.
  virtual bool is_too_fast(double turn_squared, double damping_step) = 0;
  /// at_time reports a member's state at a time asked for; at_step the states before and after a step in which the
  /// watched quantity may have changed its sign, once or twice.
  virtual void at_time(std::size_t member, double t, const double* state) = 0;
  virtual void at_step(std::size_t member, double t_before, std::span<const double> before, double t,
                       std::span<const double> after) = 0;
};

/// LaneTask is a set of members of one scene and scheme that start at the same time. Tables have a row for each
/// quantity with an entry per member: entry m of row k is at [k·count + m].
struct LaneTask {
  std::size_t scheme = 0;                ///< place in lane_schemes
  std::span<const double> settings;      ///< of the scheme
  std::span<const double> parameters;    ///< of the problem
  const LaneProgram* program = nullptr;  ///< instead of a compiled problem: a step as a program
  const double* own = nullptr;           ///< table of the program's constants of which each member has its own
  const double* start = nullptr;         ///< table of the variables
  std::size_t count = 0;

  double start_time = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0, step_limit = 0;
  std::span<const double> times;  ///< ascending times at which states are reported
  bool watches = false;           ///< steps are reported to the host
  int watched = -1;               ///< only steps in which this variable may cross `level`; −1: all steps
  double level = 0;
  LaneHost* host = nullptr;
  const std::atomic<bool>* cancelled = nullptr;

  // The result.
  double* final = nullptr;        ///< table of the variables
  std::uint8_t* ended = nullptr;  ///< by member, a ReturnCode; on entry `cancelled` for all members that are to be run
  std::int64_t taken = 0;         ///< steps of all members
  std::int64_t forces = 0;        ///< force evaluations of all members
  /// Rows of `final` that are valid; for a program, set by the caller: the variables of the card
  std::size_t variables = 0;
  std::size_t moving = 0;  ///< for a program: how many of them the motion needs; they come first
};

/// LanePoint is where a program is evaluated: t, h, the variables of the card, and a member's own constants.
struct LanePoint {
  double t = 0, h = 0;
  const double *values = nullptr, *own = nullptr;
};

/// LanePrograms is what a unit of lanes can do with programs.
struct LanePrograms {
  void (*run)(LaneTask& task) = nullptr;
  /// Writes the program's values at a point: its outputs; for a step, the new state and, where it can fail, its
  /// StepFailure. `room` is scratch for registers. Null in all units but one, as single states have the same bits in
  /// all.
  void (*evaluate)(const LaneProgram& program, const LanePoint& point, std::vector<double>& room,
                   double* out) = nullptr;
};
/// RunLanes runs members of one problem that share its parameters. False: problem and scheme are not compiled together,
/// or the start is a series.
using RunLanes = bool (*)(LaneTask& task);

}  // namespace least

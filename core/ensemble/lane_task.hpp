// What goes between an ensemble and the units of lanes, which are compiled for several instruction sets: numbers and
// pointers, and nothing that such a unit would compile for another.
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

/// The schemes that lanes know, by a position of their own: those of steps of equal length without equations to solve.
inline constexpr std::array<std::string_view, 9> lane_schemes{
    "explicit_euler", "explicit_midpoint",        "runge_kutta_4",    "ruth_3",           "symplectic_euler",
    "leapfrog",       "contact_symplectic_euler", "contact_leapfrog", "contact_splitting"};

/// What the lanes ask of who gave them a task.
class LaneHost {
 public:
  virtual ~LaneHost() = default;
  /// (ωh)² from which on a step is unstable where the damping is α; infinite: never.
  virtual double turn_limit(double damping_step) = 0;
  /// The same question of a scene whose ω is the same everywhere.
  virtual bool is_too_fast(double turn_squared, double damping_step) = 0;
  /// A member's state at a time that was asked for, or before and after a step in which what is watched may have
  /// changed its sign, once or twice.
  virtual void at_time(std::size_t member, double t, const double* state) = 0;
  virtual void at_step(std::size_t member, double t_before, std::span<const double> before, double t,
                       std::span<const double> after) = 0;
};

/// Members of one scene under one scheme, all from the same time on. Tables hold a row for each quantity with an entry
/// per member: entry m of row k stands at [k·count + m].
struct LaneTask {
  std::size_t scheme = 0;                ///< position among lane_schemes
  std::span<const double> settings;      ///< of the scheme
  std::span<const double> parameters;    ///< of the problem
  const LaneProgram* program = nullptr;  ///< in the place of a problem: a step that was written down
  const double* own = nullptr;           ///< table of the constants of the program that each member has of its own
  const double* start = nullptr;         ///< table of the variables
  std::size_t count = 0;

  double start_time = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0, step_limit = 0;
  std::span<const double> times;  ///< at which states are asked for, increasing
  bool watches = false;           ///< whether steps are told
  int watched = -1;               ///< only those in which this variable may pass the level; −1: all of them
  double level = 0;
  LaneHost* host = nullptr;
  const std::atomic<bool>* cancelled = nullptr;

  // The result.
  double* final = nullptr;        ///< table of the variables
  std::uint8_t* ended = nullptr;  ///< by member: ReturnCode; before, `cancelled` for all that are to be run
  std::int64_t taken = 0;         ///< steps of all members
  std::int64_t forces = 0;        ///< force evaluations of all members
  std::size_t variables = 0;      ///< rows of `final` that mean something; of a program given, as the card has them
  std::size_t moving = 0;         ///< of a program given: those of them that the motion needs, the first ones
};

/// Where a program is evaluated: t, h, the variables of the card, and the constants of one's own.
struct LanePoint {
  double t = 0, h = 0;
  const double *values = nullptr, *own = nullptr;
};

/// What a unit of lanes can do with programs.
struct LanePrograms {
  void (*run)(LaneTask& task) = nullptr;
  /// What the program makes of a point: its outputs, of one that makes steps the state and, where one can fail, its
  /// StepFailure. `room` is for its registers. Null but in one unit, as single states have the same bits in all.
  void (*evaluate)(const LaneProgram& program, const LanePoint& point, std::vector<double>& room,
                   double* out) = nullptr;
};
/// Runs members of one problem that share its parameters. False: the pair is not compiled, or its start is a series.
using RunLanes = bool (*)(LaneTask& task);

}  // namespace least

// What goes between an ensemble and the units of lanes, which are compiled for several instruction sets: numbers and
// pointers, and nothing that such a unit would compile for another.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

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
  /// A member's state at a time that was asked for, or before and after a step in which a variable passed its level.
  virtual void at_time(std::size_t member, double t, const double* state) = 0;
  virtual void at_step(std::size_t member, double t_before, const double* before, double t, const double* after) = 0;
};

/// Members of one scene under one scheme, all from the same time on. Tables hold a row for each quantity with an entry
/// per member: entry m of row k stands at [k·count + m].
struct LaneTask {
  std::size_t scheme = 0;               ///< position among lane_schemes
  std::span<const double> settings;     ///< of the scheme
  std::span<const double> parameters;   ///< of the problem
  std::span<const std::size_t> varied;  ///< parameters of which each member has its own value
  const double* values = nullptr;       ///< table of those
  const double* start = nullptr;        ///< table of the variables
  std::size_t count = 0;
  bool full = false;  ///< s is carried where the scene has one

  double start_time = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0, step_limit = 0;
  std::span<const double> times;  ///< at which states are asked for, increasing
  int watched = -1;               ///< a variable whose passages of a level are asked for; −1: none
  double level = 0;
  int direction = 0;  ///< of the passages: 1 up, −1 down, 0 both
  LaneHost* host = nullptr;
  const std::atomic<bool>* cancelled = nullptr;

  // The result.
  double* final = nullptr;        ///< table of the variables
  std::uint8_t* ended = nullptr;  ///< by member: ReturnCode
  std::int64_t taken = 0;         ///< steps of all members
  std::int64_t forces = 0;        ///< force evaluations of all members
  std::size_t variables = 0;      ///< rows of `final` that mean something
};

/// A state of a member, and where columns of it go.
struct LaneState {
  std::span<const double> parameters;  ///< of the problem
  bool full = false;                   ///< with s wherever the scene has one
  double t = 0;
  const double* values = nullptr;        ///< the variables
  std::span<const std::size_t> columns;  ///< of the card
  double* out = nullptr;
};
/// A step of a member, in which a variable passed a level.
struct LaneCrossing {
  std::span<const double> parameters;
  bool full = false;
  double t_before = 0, t_after = 0;
  const double *before = nullptr, *after = nullptr;
  std::size_t variable = 0;
  double level = 0;
  double* out = nullptr;  ///< found: the variables there
  double t = 0;           ///< found: when
};

/// What a unit of lanes can do with one problem. The last two are null in units that share parameters.
struct LaneMechanics {
  /// False: the pair cannot run in lanes, or not from this start, or not in this unit.
  bool (*run)(LaneTask& task) = nullptr;
  void (*columns)(const LaneState& state) = nullptr;
  void (*locate)(LaneCrossing& crossing) = nullptr;
};

}  // namespace least

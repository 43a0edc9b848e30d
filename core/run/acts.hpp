// What events do to the state of a run: at a zero of its expression variables take other values, and the motion goes on
// from there. How such an act changes neighbours is told by the saltation matrix
//   S = G + (f₊ − G f₋ − g_t) hᵀ/(hᵀf₋ + h_t),   G = ∂g/∂x of the act x → g(x, t), f₋ and f₊ the rates before and after
// it, h = ∂/∂x of the expression that vanishes: an act keeps the symplectic form, or the contact form, if S does.
// Source: Leine, Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// One of the variables that an event sets.
struct Setting {
  std::string name, text;
  std::size_t index = 0;  ///< of the card's variables; of velocities of the coordinates
  bool velocity = false;
};

/// All that one event does: the values of its settings are read before any is written.
struct Act {
  std::vector<Setting> settings;
  Measures values;        ///< what the settings take, in their order
  std::int64_t most = 0;  ///< how often the event may act before the run ends; 0: that is not said
};

/// The acts of one run.
class Acts {
 public:
  /// All outlive it.
  Acts(const RunBackend& backend, const Request& request);

  bool any() const { return any_; }
  enum class Effect : std::uint8_t {
    goes_on,
    completes,   ///< the event has acted as often as it may
    not_finite,  ///< there is no such state
    piles_up,    ///< the times between its acts shrink to nothing before `limit`
    rests        ///< it leaves the motion at rest against where it happens, and would have to act again at once
  };
  /// x becomes what the event made of it.
  Effect act(std::size_t event, RunState& x);
  double limit() const { return limit_; }
  std::int64_t count(std::size_t event) const { return done_[event].count; }
  /// Of each event that has acted: name, count, keeps and defect.
  std::vector<Report> reports() const;

 private:
  struct Done {
    std::int64_t count = 0;
    std::array<double, 4> times{};  ///< of the last acts, the latest first
    double rate = unknown;          ///< of the expression right after the last act
    double defect = 0;
  };
  bool has_piled_up(std::size_t event, const RunState& after);
  /// Whether the act has left the expression at rest where it vanishes, and the motion from there takes it on in the
  /// direction in which it came: as a ball that keeps nothing of its speed lies on the floor.
  bool comes_to_rest(std::size_t event, const RunState& before, const RunState& after);
  /// ẋ, and the rate of the expression along the motion.
  std::vector<double> rates_at(const RunState& x) const;
  double rate_of(std::size_t event, const RunState& x) const;
  double value_of(std::size_t event, const RunState& x) const;
  /// What the rounding of a state makes of the expression of an event there.
  double rounding_of(std::size_t event, const RunState& x) const;
  /// Whether round-off hides what the expression of an event does until it vanishes again, so long after this state.
  bool is_hidden(std::size_t event, const RunState& after, double until_next) const;
  double defect_of(std::size_t event, const RunState& before, const RunState& after) const;

  const RunBackend& backend_;
  const Request& request_;
  bool any_ = false;
  std::vector<Done> done_;
  double limit_ = unknown;
};

}  // namespace least

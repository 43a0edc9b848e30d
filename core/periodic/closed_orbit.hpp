// Closed orbits of a scene: found from a guess, with their multipliers, whether they are stable, what becomes of them
// where a number of the scene or of the orbit moves, and the manifolds of those that are not stable.
#pragma once

#include <atomic>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/periodic/dense.hpp"
#include "core/run/request.hpp"
#include "core/status.hpp"

namespace least::periodic {

class Motion;

/// A curve of closed orbits, along which this number moves.
struct FamilyAsked {
  enum class By : std::uint8_t { parameter, start, period, energy };
  By by = By::parameter;
  std::size_t index = 0;  ///< of the card's parameters or variables
  std::string name;       ///< as the request has it
  double to = 0;
  int count = 50;  ///< members at most
};
inline constexpr int most_members = 1000;

/// Trajectories that leave the orbit along its unstable, or come to it along its stable eigenvector.
struct ManifoldsAsked {
  int count = 20;  ///< of each side of each of the two
  double until = 0;
};
inline constexpr int most_of_a_manifold = 200;

/// Of a motion at most, whose derivative by all of them is followed.
inline constexpr std::size_t most_components = 64;

struct Question {
  std::shared_ptr<const Scene> scene;  ///< its start is the guess; it goes forward
  double period = 0;
  std::vector<std::size_t> fixed;  ///< variables of the card that keep the guess's value
  bool symmetric = false;
  std::vector<double> settings;  ///< of the scheme `taylor`
  std::optional<FamilyAsked> family;
  std::optional<ManifoldsAsked> manifolds;
  Limits limits;
};

/// What is wrong with a question, and where.
struct Objection {
  std::string pointer, detail, allowed;
};
/// What can be seen before anything is computed: a scene without derivatives, a drive that does not repeat, variables
/// that the motion does not have.
std::optional<Objection> objection(const Question& question);

/// The motion with its derivatives, made once for all that a question asks of it.
struct Motions {
  std::shared_ptr<Motion> by_start;
  std::shared_ptr<Motion> by_parameter;  ///< along which a family moves, too; null: none does
  double seconds = 0;                    ///< that it took to make them
};
/// Where there is an objection, their equations are too long. Throws MemoryShortage.
std::variant<Motions, Objection> motions_of(const Question& question);

enum class MultiplierKind : std::uint8_t { unit, elliptic, hyperbolic, inverse_hyperbolic, complex };
inline constexpr std::string_view multiplier_kinds[] = {"unit", "elliptic", "hyperbolic", "inverse_hyperbolic",
                                                        "complex"};
struct Multiplier {
  std::complex<double> value;
  std::optional<MultiplierKind> kind{};  ///< nothing: it is so small that rounding of the others hides what it is
};

/// Eigenvalues of the derivative of the motion over a period, those first that time, what is kept and symmetries
/// make 1.
struct Stability {
  std::vector<Multiplier> multipliers;
  std::size_t by_time = 0, by_invariants = 0, by_symmetries = 0;
  std::optional<bool> stable;                                        ///< by all others; nothing: they do not tell
  double pairing_defect = std::numeric_limits<double>::quiet_NaN();  ///< NaN: there are no pairs
  double pair_product = std::numeric_limits<double>::quiet_NaN();

  std::size_t trivial() const { return by_time + by_invariants + by_symmetries; }
};

struct Orbit {
  std::shared_ptr<const Scene> scene;  ///< that starts on it
  double period = 0, closure = 0;
  std::size_t segments = 1;
  double energy = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<std::string, double>> invariants;  ///< those that are declared
  std::vector<std::string> rows;                           ///< of the monodromy: names of variables
  Matrix monodromy;
  Stability stability;
};

enum class Bifurcation : std::uint8_t { none, fold, period_doubling, pitchfork_or_transcritical, torus };
inline constexpr std::string_view bifurcation_names[] = {"", "fold", "period_doubling", "pitchfork_or_transcritical",
                                                         "torus"};

struct Member {
  double value = 0;
  double period_slope = std::numeric_limits<double>::quiet_NaN();  ///< dT/dvalue along the family
  Orbit orbit;
  Bifurcation bifurcation = Bifurcation::none;
};

struct Manifold {
  bool stable = false;
  double multiplier = std::numeric_limits<double>::quiet_NaN();
  std::string reason;  ///< why there is none
  /// Of each of its trajectories the times, and states component by component of `Orbit::rows`.
  struct Curve {
    int side = 1;
    std::vector<double> t;
    std::vector<std::vector<double>> states;
  };
  std::vector<Curve> curves;
};

struct Answer {
  bool closed = false;
  std::string reason;  ///< why it is not
  int iterations = 0;
  Orbit orbit;                 ///< the nearest to one that was found
  std::vector<Member> family;  ///< empty where each was taken as it came
  std::string family_end;      ///< why it ends there
  std::vector<Manifold> manifolds;
  ReturnCode end = ReturnCode::completed;  ///< where a limit has ended it
  std::int64_t steps = 0;
  double seconds = 0;
  Held held = HeldByThread::take(0);
};

/// `motions`: of the question, that nobody else moves; what they took counts in its seconds. Each member is given to
/// `take`, which says whether it wants more; without it they are kept. Throws MemoryShortage.
Answer close_orbit(const Question& question, const Motions& motions, const std::atomic<bool>& cancelled,
                   const std::function<bool(const Member&)>& take = {});

}  // namespace least::periodic

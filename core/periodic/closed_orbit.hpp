// Closed orbits of a scene, found from a guess: their multipliers and stability, their families as a number of the
// scene or of the orbit changes, and the stable and unstable manifolds of unstable orbits.
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

/// FamilyAsked asks for a one-parameter family of closed orbits along a number, from its present value to `to`.
struct FamilyAsked {
  enum class By : std::uint8_t { parameter, start, period, energy };
  By by = By::parameter;
  std::size_t index = 0;  ///< of the card's parameters or variables
  std::string name;       ///< the name in the request
  double to = 0;
  int count = 50;  ///< limit of members
};
inline constexpr int most_members = 1000;

/// ManifoldsAsked asks for trajectories that leave the orbit along its unstable eigenvector, or approach it along its
/// stable one.
struct ManifoldsAsked {
  int count = 20;  ///< trajectories on each side of the orbit, for each of the two manifolds
  double until = 0;
};
inline constexpr int most_of_a_manifold = 200;

/// Limit of components of a motion, as its full Jacobian is followed.
inline constexpr std::size_t most_components = 64;

/// Question is what a request asks for.
struct Question {
  std::shared_ptr<const Scene> scene;  ///< its start is the guess; it must not be time-reversed
  double period = 0;
  std::vector<std::size_t> fixed;  ///< variables of the card that keep the values of the guess
  bool symmetric = false;
  std::vector<double> settings;  ///< of the scheme `taylor`, in the order of its card
  std::optional<FamilyAsked> family;
  std::optional<ManifoldsAsked> manifolds;
  Limits limits;
};

/// Objection says what is wrong with a question; `pointer` is the place in the request.
struct Objection {
  std::string pointer, detail, allowed;
};
/// objection finds what can be known without computing an orbit: a scene without derivatives, a drive that does not
/// repeat after the period, variables that the motion does not have; nothing where all is well.
std::optional<Objection> objection(const Question& question);

/// Motions holds the motion and its derivatives, made once and shared by all parts of the answer.
struct Motions {
  std::shared_ptr<Motion> by_start;
  std::shared_ptr<Motion> by_parameter;  ///< with derivatives by the family's parameter; null where the family has none
  double seconds = 0;                    ///< the time it took to make them
};
/// motions_of makes them, or objects that their equations are too long. Throws MemoryShortage.
std::variant<Motions, Objection> motions_of(const Question& question);

enum class MultiplierKind : std::uint8_t { unit, elliptic, hyperbolic, inverse_hyperbolic, complex };
inline constexpr std::string_view multiplier_kinds[] = {"unit", "elliptic", "hyperbolic", "inverse_hyperbolic",
                                                        "complex"};
struct Multiplier {
  std::complex<double> value;
  /// Nothing where it is so small that rounding errors of the others hide its kind
  std::optional<MultiplierKind> kind{};
  /// Of the value where it is near another, as the errors of the monodromy matrix move both; else 0
  double error = 0;
};

/// Stability holds the eigenvalues of the monodromy matrix. The trivial ones come first: those that are 1 because of
/// time translation, conserved quantities and symmetries.
struct Stability {
  std::vector<Multiplier> multipliers;
  std::size_t by_time = 0, by_invariants = 0, by_symmetries = 0;
  std::optional<bool> stable;  ///< judged by the non-trivial ones; nothing where they do not decide
  /// Largest relative defect of the products of pairs; NaN where there are no pairs
  double pairing_defect = std::numeric_limits<double>::quiet_NaN();
  /// The product of each pair, e^{−∫∂H/∂s dt}: 1 for symplectic motions; NaN where there are no pairs
  double pair_product = std::numeric_limits<double>::quiet_NaN();

  std::size_t trivial() const { return by_time + by_invariants + by_symmetries; }
};

/// Orbit is a closed orbit, or the best approximation to one. `closure` is the largest mismatch of shooting, in units
/// of the orbit's extents; `segments` is how many shooting segments were used.
struct Orbit {
  std::shared_ptr<const Scene> scene;  ///< starts on the orbit
  double period = 0, closure = 0;
  std::size_t segments = 1;
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< NaN where it is not conserved
  std::vector<std::pair<std::string, double>> invariants;    ///< the values of the declared ones
  std::vector<std::string> rows;  ///< names of the variables that the rows of `monodromy` stand for
  Matrix monodromy;
  Stability stability;
};

enum class Bifurcation : std::uint8_t { none, fold, period_doubling, pitchfork_or_transcritical, torus };
inline constexpr std::string_view bifurcation_names[] = {"", "fold", "period_doubling", "pitchfork_or_transcritical",
                                                         "torus"};

/// Member is an orbit of a family at `value` of the family's number; `bifurcation` names the one located there, if any.
struct Member {
  double value = 0;
  double period_slope = std::numeric_limits<double>::quiet_NaN();  ///< dT/dvalue along the family
  Orbit orbit;
  Bifurcation bifurcation = Bifurcation::none;
};

/// Manifold is the stable or the unstable manifold of an orbit; `multiplier` is the one of its direction.
struct Manifold {
  bool stable = false;
  double multiplier = std::numeric_limits<double>::quiet_NaN();
  std::string reason;  ///< why there are no curves
  /// Curve is a trajectory: its times, and the states component by component in the order of `Orbit::rows`.
  struct Curve {
    int side = 1;
    std::vector<double> t;
    std::vector<std::vector<double>> states;
  };
  std::vector<Curve> curves;
};

struct Answer {
  bool closed = false;
  std::string reason;  ///< why no orbit was closed
  int iterations = 0;
  Orbit orbit;                 ///< the one nearest to closed, where none was closed
  std::vector<Member> family;  ///< empty where `take` was given
  std::string family_end;      ///< why the family ends where it does
  std::vector<Manifold> manifolds;
  ReturnCode end = ReturnCode::completed;  ///< which limit ended the computation
  std::int64_t steps = 0;
  double seconds = 0;
  Held held = HeldByThread::take(0);
};

/// close_orbit answers a question. `motions` must be those of the question and used by no other thread; the time they
/// took counts towards the limit of seconds. `take` receives each member and returns whether it wants more; without it
/// members are stored in the answer. Throws MemoryShortage.
Answer close_orbit(const Question& question, const Motions& motions, const std::atomic<bool>& cancelled,
                   const std::function<bool(const Member&)>& take = {});

}  // namespace least::periodic

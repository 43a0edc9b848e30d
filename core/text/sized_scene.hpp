// The mechanics of a scene as text of any size, which is known when it runs. Components of a state stand one after the
// other: coordinates, momenta, and s where the scene has it; of a flow its variables; of a forced scene at last the
// work of the forces. What the motion does not need, as the s of a damped scene, comes last. Variables on the tapes
// have the same numbers.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"
#include "core/tape/program.hpp"
#include "core/tape/sparse_jacobian.hpp"
#include "core/text/form.hpp"
#include "core/text/velocities.hpp"

namespace least::text {

/// A formula of a state; where velocities are found from momenta when it runs, of these as well, as variables that
/// stand behind the state.
class StateFormula {
 public:
  StateFormula() = default;
  StateFormula(tape::Formula formula, std::size_t components, std::shared_ptr<const Velocities> velocities)
      : formula_(std::move(formula)), components_(components), velocities_(std::move(velocities)) {}

  template <class T, class S>
  void evaluate(const T* x, const S& t, T* out) const {
    if (!velocities_) return formula_.evaluate(x, t, out);
    thread_local std::vector<T> all;
    const std::size_t n = velocities_->size();
    all.assign(x, x + components_);
    all.resize(components_ + n);
    velocities_->find(x, components_ > 2 * n ? x[2 * n] : T(0), t, all.data() + components_);
    formula_.evaluate(all.data(), t, out);
  }
  std::size_t outputs() const { return formula_.outputs(); }
  std::size_t operations() const { return formula_.operations(); }

 private:
  tape::Formula formula_;
  std::size_t components_ = 0;
  std::shared_ptr<const Velocities> velocities_;
};

/// A form with numbers in the place of its parameters.
class SizedScene {
 public:
  /// Operations of its equations of motion, with their common parts written once.
  static constexpr tape::Index most_equations = 1 << 18;

  /// Coordinates up to which equations for momenta are solved where forces read those of other coordinates.
  static constexpr std::size_t most_coupled = 64;

  /// Coordinates up to which schemes solve equations whose matrix is taken for a full one.
  static constexpr std::size_t most_full = 256;

  /// The same where the matrix has a row for each coordinate, and is made anew once in a few rounds.
  static constexpr std::size_t most_with_full_mass = 256;

  /// Whether there is one of a form: of any but a Lagrangian that couples too many velocities.
  static bool has(const Form& form);
  /// Of such a form. Throws tape::TooManyOperations where its equations of motion take more than those of a scene may.
  SizedScene(const Form& form, std::span<const double> parameters);

  FormKind kind;
  std::size_t coordinates, components;
  std::size_t moving;  ///< components that the motion needs, the first ones
  bool flow, forced, acting, reads_action, constant_damping, autonomous, keeps_energy;

  tape::Tape equations;            ///< ẋ of all components
  std::vector<tape::Index> rates;  ///< their places; behind them v̇ of velocities that are found from momenta
  StateFormula rate;               ///< ẋ of the components
  tape::Formula potential, gradient, damping;
  double constant_potential = 0;         ///< the sum of the numbers among the terms of V, of a conservative scene
  tape::Formula varying_potential;       ///< V without them, where there are any
  tape::Formula potential_and_gradient;  ///< V, ∇V of no more than tape::SparseJacobian::few coordinates; else none
  StateFormula hamiltonian;              ///< where the motion reads s, and of general mechanics: H, and H_s
  /// Of (q, v, s) L, L_q, L_v, L_s where steps are made of them: of a general Lagrangian, of one whose metric depends
  /// on the place, and of a scene quadratic in s with no more than most_full coordinates.
  tape::Formula lagrangian;
  std::shared_ptr<const Velocities> velocities;  ///< that are found from momenta; else null
  // Where the metric depends on the place:
  StateFormula raised;                      ///< g⁻¹p
  tape::Formula lowered;                    ///< of (q, v): L and g v
  double action_curvature = 0, offset = 0;  ///< γ and R of such a scene, else 0
  std::shared_ptr<const Lift> lift;         ///< of a general Hamiltonian that has one
  tape::Formula invariants;                 ///< most_invariants; those that the scene has not are 0

  /// What is known of the forces F(q, p, t); of all but their values beside a constant metric only.
  struct Forces {
    bool linear = true;         ///< in p
    bool diagonal = true;       ///< F_i reads p_i alone of all momenta
    bool constant = true;       ///< ∂F/∂p is of numbers
    bool jumps = false;         ///< at rest, as dry friction does
    bool jumps_alone = true;    ///< where they jump, this is with the momentum that each acts on, with no other
    std::vector<bool> jumping;  ///< of each coordinate whether its force jumps; of none where none does
    double friction = 0;        ///< c where F is −c p, which damping says as well; else 0
    tape::Formula values;       ///< F
    tape::Formula jacobian;  ///< F and ∂F/∂p: where it is diagonal that by each p_i, else row by row; of too many none
    bool solvable() const { return jacobian.outputs() > 0; }
    /// Whether kicks know what such forces hold at rest.
    bool can_rest() const { return jumps && jumps_alone && solvable(); }
  };
  Forces forces;

  /// V − constant_potential: what is large and the same everywhere takes no digits from differences of V.
  const tape::Formula& potential_beside_constant() const {
    return varying_potential.outputs() > 0 ? varying_potential : potential;
  }
  /// ẋ of the components that move.
  const StateFormula& motion() const { return components > moving ? motion_ : rate; }

  /// v = g⁻¹p of a constant metric, to n numbers.
  template <class T>
  void velocity(const T* p, T* v) const {
    const std::size_t n = coordinates;
    for (std::size_t i = 0; i < n; ++i) {
      if (!has_full_mass()) {
        v[i] = inverse_mass_[i] * p[i];
        continue;
      }
      T sum(0);
      for (const auto& [j, share] : inverse_matrix_[i]) sum = sum + share * p[j];
      v[i] = sum;
    }
  }
  /// Variables of the equations of motion that stand behind a state: velocities that are found from momenta.
  std::size_t found() const { return velocities ? coordinates : 0; }
  /// A state with them, which are written behind its components that move; to as many digits as T has.
  template <class T>
  void find_velocities(T* x, double t) const {
    if (velocities) velocities->find(x, acting ? x[2 * coordinates] : T(0), t, x + moving);
  }
  /// α(t) of a damped scene; 0 where there is none.
  double damping_at(double t) const {
    if (constant_damping || kind != FormKind::contact_linear) return constant_alpha_;
    double alpha = 0;
    const double* const none = nullptr;
    damping.evaluate(none, t, &alpha);
    return alpha;
  }
  /// H_s of a contact scene with a potential, and what s adds to its H.
  template <class T>
  T action_slope(const T& s, double t) const {
    return is_quadratic() ? T(action_curvature * s) : T(damping_at(t));
  }
  template <class T>
  T action_energy(const T& s, double t) const {
    return is_quadratic() ? T(0.5 * action_curvature * (s * s) - offset) : T(damping_at(t) * s);
  }
  /// Whether H = ½ pᵀg⁻¹p + V(q, t) + a function of s with a constant g.
  bool has_constant_metric() const {
    return kind == FormKind::separable || kind == FormKind::contact_linear || is_quadratic();
  }
  bool is_quadratic() const { return kind == FormKind::contact_quadratic; }
  bool has_full_mass() const { return !inverse_matrix_.empty(); }
  /// Whether steps that solve for places find M + β V″ small enough, which is full where M is.
  bool solves_for_places() const { return !has_full_mass() || coordinates <= most_with_full_mass; }
  std::span<const double> inverse_mass() const { return inverse_mass_; }
  /// Of each row the columns that are not zero, and what stands there.
  using SparseRow = std::vector<std::pair<std::size_t, double>>;
  const std::vector<SparseRow>& inverse_mass_matrix() const { return inverse_matrix_; }

  /// The equations with all sums written out, for what goes through them operation by operation.
  struct Plain {
    const tape::Tape& tape;
    std::span<const tape::Index> rates;
  };
  /// Nothing where that takes more than tape::most_written_out. Made when it is first asked for. Throws MemoryShortage.
  std::optional<Plain> plain() const;
  /// V″(q, t) where there is a potential; made when it is first asked for.
  const tape::SparseJacobian& curvature() const;
  /// What series of all components are made of, or of those that move; made when it is first asked for. Throws
  /// MemoryShortage, and tape::TooManyOperations where there are no plain equations.
  const tape::Program& series(bool all) const;

 private:
  /// What its tape and formulas come to in memory, about.
  std::size_t bytes() const;
  /// Of a general Lagrangian: finds out what else is known, and returns ẋ. `fold` takes velocities for momenta.
  std::vector<Symbol> set_lagrangian(const Form& form, tape::Substitution& fold);
  /// The same where the metric depends on the place. Where it couples many coordinates, `rate` finds velocities when it
  /// runs, for which series have no use.
  std::vector<Symbol> set_metric(const Form& form, tape::Substitution& fold);
  tape::Formula formula_of(const std::vector<Symbol>& all);
  /// A function of (q, v, s), and its derivatives.
  std::vector<Symbol> with_slopes(const Symbol& value);
  /// Of L with a constant metric.
  std::vector<Symbol> slopes_of_lagrangian(const Symbol& v_of_place, const Symbol& of_action);
  void set_forces(const std::vector<Symbol>& all);
  /// Of the switches where forces jump, in the order of the tape: whose force each is a part of, and what it reads.
  void set_jumps(const std::vector<Symbol>& all, const std::vector<tape::Index>& jumps);
  /// `second`: the numbers of the entries of ∂²L/∂v² or ∂²H/∂p² where the metric is not diagonal.
  void set_mass(const std::vector<Symbol>& mass, const SymbolMatrix& hessian, const std::vector<double>& second,
                bool of_velocities);

  MemoryBudget* const budget_ = HeldByThread::budget();  ///< of whom it was made for, also for what is made later
  Held held_ = HeldByThread::take(0);
  StateFormula motion_;                    ///< where not all components move
  tape::SharedSums shared_;                ///< of formulas, while they are made
  double constant_alpha_ = 0;              ///< where the damping is constant
  std::vector<double> inverse_mass_;       ///< of each coordinate
  std::vector<SparseRow> inverse_matrix_;  ///< where the metric is not diagonal: g⁻¹

  struct Curvature {
    std::once_flag made;
    std::unique_ptr<const tape::SparseJacobian> of;
    Held held{};
  };
  struct WrittenOut {
    std::once_flag made;
    std::optional<const tape::PlainTape> of;
    Held held{};
  };
  std::shared_ptr<WrittenOut> written_out_ = std::make_shared<WrittenOut>();
  std::vector<tape::Index> slopes_;  ///< ∇V
  std::shared_ptr<Curvature> curvature_ = std::make_shared<Curvature>();
  struct SeriesProgram {
    std::once_flag made;
    std::optional<const tape::Program> of;
    Held held{};
  };
  std::shared_ptr<SeriesProgram> series_ = std::make_shared<SeriesProgram>(),
                                 motion_series_ = std::make_shared<SeriesProgram>();
};

/// Scenes made of one form. The last one is kept: who reads a scene asks for it several times, and a search again and
/// again.
class SizedScenes {
 public:
  /// Throws tape::TooManyOperations where its equations of motion take more than those of a scene may.
  std::shared_ptr<const SizedScene> with(const Form& form, std::span<const double> parameters);

 private:
  std::mutex mutex_;
  std::vector<double> parameters_;
  std::shared_ptr<const SizedScene> last_;
};

}  // namespace least::text

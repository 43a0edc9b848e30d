// The mechanics of a scene given as text, with a size that is known at run time only. The components of a state are
// coordinates, momenta, and s where the scene has it; for a flow, its variables; a forced scene has the work of the
// forces as its last component. Components that the motion does not read, such as the s of a damped scene, come last.
// Variables on the tapes have the numbers of these components.
#pragma once

#include <algorithm>
#include <array>
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

/// StateFormula is a formula of a state. Where velocities have to be found from momenta at run time, its formula also
/// reads these velocities, as variables behind the state.
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
  /// Formula::evaluate_rows.
  void evaluate_rows(const double* rows, std::size_t width, std::size_t count, double* out) const {
    if (!velocities_) return formula_.evaluate_rows(rows, width, count, out);
    for (std::size_t i = 0; i < count; ++i, rows += width, out += outputs()) evaluate(rows + 1, rows[0], out);
  }
  std::size_t outputs() const { return formula_.outputs(); }
  std::size_t operations() const { return formula_.operations(); }

 private:
  tape::Formula formula_;
  std::size_t components_ = 0;
  std::shared_ptr<const Velocities> velocities_;
};

/// SizedScene is a form with numbers in the place of its parameters: its equations of motion, and formulas of H, L, V,
/// the metric and the forces.
class SizedScene {
 public:
  /// Limit of operations of the equations of motion, with common subexpressions written once.
  static constexpr tape::Index most_equations = 1 << 18;

  /// Limit of coordinates up to which implicit equations for momenta are solved where a force reads momenta of other
  /// coordinates than its own.
  static constexpr std::size_t most_coupled = 64;

  /// Limit of coordinates up to which schemes solve equations with a dense matrix.
  static constexpr std::size_t most_full = 256;

  /// The same limit where the mass matrix is dense; the matrix is then remade only once in a few iterations.
  static constexpr std::size_t most_with_full_mass = 256;

  /// has(form) tells whether there is a SizedScene of a form: of every form but a Lagrangian that couples too many
  /// velocities.
  static bool has(const Form& form);
  /// Takes a form with has(form). Throws tape::TooManyOperations where its equations of motion exceed most_equations.
  SizedScene(const Form& form, std::span<const double> parameters);

  FormKind kind;
  std::size_t coordinates, components;
  std::size_t moving;  ///< the number of components that the motion needs; they come first
  bool flow, forced, acting, reads_action, constant_damping, autonomous, keeps_energy;

  tape::Tape equations;            ///< the tape of all symbols; ẋ of all components is at `rates`
  std::vector<tape::Index> rates;  ///< places of ẋ on `equations`, then of v̇ of velocities that are found from momenta
  StateFormula rate;               ///< ẋ of all components
  tape::Formula potential, gradient, damping;
  double constant_potential = 0;    ///< of a conservative scene: the sum of the constant terms of V
  tape::Formula varying_potential;  ///< V without its constant terms, where there are any
  /// V and ∇V of at most tape::SparseJacobian::few coordinates; else without outputs
  tape::Formula potential_and_gradient;
  StateFormula hamiltonian;  ///< H and H_s, where the motion reads s and of general mechanics
  /// Function of (q, v, s): L, L_q, L_v, L_s. Made where steps need it: for a general Lagrangian, for a metric that
  /// depends on q, and for a scene with γs²/2 or with friction beside a general H, of at most most_full coordinates.
  tape::Formula lagrangian;
  std::shared_ptr<const Velocities> velocities;  ///< solves ∂L/∂v = p for v; null where velocities are explicit
  // Where the metric depends on q:
  StateFormula raised;                      ///< g⁻¹p
  tape::Formula lowered;                    ///< function of (q, v): L, then g v
  double action_curvature = 0, offset = 0;  ///< γ and R of a scene with H = … + γs²/2 − R, else 0
  std::shared_ptr<const Lift> lift;         ///< of a general Hamiltonian that has a lift, else null
  tape::Formula invariants;                 ///< most_invariants values; those that the scene does not have are 0

  /// Forces describes the forces F(q, p, t). Beside a metric that is not constant, only `values` is known.
  struct Forces {
    bool linear = true;         ///< F is affine in p
    bool diagonal = true;       ///< F_i reads no momentum but p_i
    bool constant = true;       ///< ∂F/∂p consists of numbers
    bool jumps = false;         ///< F is discontinuous at rest, as dry friction is
    bool jumps_alone = true;    ///< each jump depends only on the momentum of the coordinate that the force acts on
    std::vector<bool> jumping;  ///< by coordinate, whether its force jumps; empty where none does
    double friction = 0;        ///< c where F = −c p, which `damping` expresses as well; else 0
    tape::Formula values;       ///< F
    /// F, then ∂F_i/∂p_i where `diagonal`, else ∂F/∂p row-major; without outputs where too many are coupled
    tape::Formula jacobian;
    bool solvable() const { return jacobian.outputs() > 0; }
    /// can_rest tells whether kicks can compute the static friction by which such forces hold a coordinate at rest.
    bool can_rest() const { return jumps && jumps_alone && solvable(); }
  };
  Forces forces;

  /// potential_beside_constant returns V − constant_potential: a large constant would cost digits in differences of V.
  const tape::Formula& potential_beside_constant() const {
    return varying_potential.outputs() > 0 ? varying_potential : potential;
  }
  /// potential_with_gradient(q, t, slope) returns V at the place q of n coordinates and writes the n numbers of ∇V to
  /// `slope`. Where there is one formula for both, their common parts are evaluated once.
  template <class T>
  T potential_with_gradient(const T* q, double t, T* slope) const {
    T value(0);
    if (potential_and_gradient.outputs() == 0) {
      potential.evaluate(q, t, &value);
      gradient.evaluate(q, t, slope);
      return value;
    }
    std::array<T, 1 + tape::SparseJacobian::few> both;
    potential_and_gradient.evaluate(q, t, both.data());
    std::copy_n(both.begin() + 1, coordinates, slope);
    return both[0];
  }
  /// motion() returns ẋ of the first `moving` components.
  const StateFormula& motion() const { return components > moving ? motion_ : rate; }

  /// velocity(p, v) writes the n numbers v = g⁻¹p of a constant metric.
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
  /// found() returns how many velocities, found from momenta, the equations of motion read behind a state.
  std::size_t found() const { return velocities ? coordinates : 0; }
  /// find_velocities(x, t) writes these velocities behind the `moving` components of x, to the precision of T.
  template <class T>
  void find_velocities(T* x, double t) const {
    if (velocities) velocities->find(x, acting ? x[2 * coordinates] : T(0), t, x + moving);
  }
  /// damping_at(t) returns α(t) of a damped scene; 0 of any other.
  double damping_at(double t) const {
    if (constant_damping || kind != FormKind::contact_linear) return constant_alpha_;
    double alpha = 0;
    const double* const none = nullptr;
    damping.evaluate(none, t, &alpha);
    return alpha;
  }
  /// action_slope returns H_s of a contact scene with a potential, action_energy the terms with s of its H.
  template <class T>
  T action_slope(const T& s, double t) const {
    return is_quadratic() ? T(action_curvature * s) : T(damping_at(t));
  }
  template <class T>
  T action_energy(const T& s, double t) const {
    return is_quadratic() ? T(0.5 * action_curvature * (s * s) - offset) : T(damping_at(t) * s);
  }
  /// has_constant_metric tells whether H = ½ pᵀg⁻¹p + V(q, t) + a function of s, with constant g.
  bool has_constant_metric() const {
    return kind == FormKind::separable || kind == FormKind::contact_linear || is_quadratic();
  }
  bool is_quadratic() const { return kind == FormKind::contact_quadratic; }
  bool has_full_mass() const { return !inverse_matrix_.empty(); }
  /// solves_for_places tells whether n is small enough for steps that solve for q with the matrix M + β V″, which is
  /// dense where M is.
  bool solves_for_places() const { return !has_full_mass() || coordinates <= most_with_full_mass; }
  std::span<const double> inverse_mass() const { return inverse_mass_; }
  /// By row, the columns and values of the entries that are not zero.
  using SparseRow = std::vector<std::pair<std::size_t, double>>;
  const std::vector<SparseRow>& inverse_mass_matrix() const { return inverse_matrix_; }

  /// Plain is the equations with all kept sums written out, for users that go through them operation by operation.
  struct Plain {
    const tape::Tape& tape;
    std::span<const tape::Index> rates;
  };
  /// plain() is made on first use; nothing where it takes more than tape::most_written_out. Throws MemoryShortage.
  std::optional<Plain> plain() const;
  /// curvature() returns V″(q, t) where there is a potential; made on first use.
  const tape::SparseJacobian& curvature() const;
  /// series(all) returns the Taylor-series program of all components, or of the `moving` ones; made on first use.
  /// Throws MemoryShortage, and tape::TooManyOperations where there are no plain equations.
  const tape::Program& series(bool all) const;

 private:
  /// About the memory of the tape and its formulas.
  std::size_t bytes() const;
  /// Of a general Lagrangian: sets the members that follow from L and returns ẋ. `fold` reads velocities as momenta.
  std::vector<Symbol> set_lagrangian(const Form& form, tape::Substitution& fold);
  /// Of a metric that depends on q: sets the members that follow from it and returns ẋ. Where the metric couples many
  /// coordinates, `rate` finds velocities at run time instead; series cannot use that and take the returned ẋ.
  std::vector<Symbol> set_metric(const Form& form, tape::Substitution& fold);
  tape::Formula formula_of(const std::vector<Symbol>& all);
  /// with_slopes returns a function of (q, v, s) and its 2n + 1 derivatives.
  std::vector<Symbol> with_slopes(const Symbol& value);
  /// slopes_of_lagrangian returns L and its derivatives for a constant metric, V and the terms with s.
  std::vector<Symbol> slopes_of_lagrangian(const Symbol& v_of_place, const Symbol& of_action);
  void set_forces(const std::vector<Symbol>& all);
  /// set_jumps finds, for each switch in `jumps` (in tape order), the forces that it is a part of and the momenta it
  /// reads.
  void set_jumps(const std::vector<Symbol>& all, const std::vector<tape::Index>& jumps);
  /// `second` are the values of the entries of ∂²L/∂v² (`of_velocities`) or ∂²H/∂p², where the metric is not diagonal.
  void set_mass(const std::vector<Symbol>& mass, const SymbolMatrix& hessian, const std::vector<double>& second,
                bool of_velocities);

  /// Of the request that the scene was made for; also charged for what is made later
  MemoryBudget* const budget_ = HeldByThread::budget();
  Held held_ = HeldByThread::take(0);
  StateFormula motion_;                    ///< where moving < components
  tape::SharedSums shared_;                ///< common subexpressions of the formulas, while these are made
  double constant_alpha_ = 0;              ///< where the damping is constant
  std::vector<double> inverse_mass_;       ///< of each coordinate
  std::vector<SparseRow> inverse_matrix_;  ///< where the metric is not diagonal: g⁻¹ by rows

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

/// SizedScenes makes scenes of one form and keeps the last one: a request asks for its scene several times, and a
/// search asks again and again.
class SizedScenes {
 public:
  /// Throws tape::TooManyOperations where the equations of motion exceed SizedScene::most_equations.
  std::shared_ptr<const SizedScene> with(const Form& form, std::span<const double> parameters);

 private:
  std::mutex mutex_;
  std::vector<double> parameters_;
  std::shared_ptr<const SizedScene> last_;
};

}  // namespace least::text

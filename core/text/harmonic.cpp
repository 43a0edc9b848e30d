#include "core/text/harmonic.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/number/linear.hpp"
#include "core/number/modes.hpp"
#include "core/tape/derivative.hpp"
#include "core/tape/sparse_jacobian.hpp"

namespace least::text {
namespace {

constexpr tape::Index most_of_oscillators = 1 << 17;

using Square = std::vector<double>;  ///< an n × n matrix, row-major

/// lower_root(n, a) returns the Cholesky factor L, LLᵀ = a, of a symmetric positive definite a.
Square lower_root(std::size_t n, const Square& a) {
  Square l(n * n);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = j; i < n; ++i) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
  return l;
}
Square transposed(std::size_t n, const Square& a) {
  Square made(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) made[i * n + j] = a[j * n + i];
  return made;
}
Square product(std::size_t n, const Square& a, const Square& b) {
  Square made(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < n; ++j) made[i * n + j] += a[i * n + k] * b[k * n + j];
  return made;
}
bool is_diagonal(std::size_t n, const Square& a) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (i != j && a[i * n + j] != 0) return false;
  return true;
}

class Oscillators {
 public:
  Oscillators(const Form& form, std::span<const double> parameters)
      : n_(form.coordinates), fold_(form.tape, tape_, [&form, parameters, this](int i) {
          const int first = form.numbers.parameter;
          return i >= first ? Symbol(parameters[static_cast<std::size_t>(i - first)])
                            : Symbol::variable(tape_, static_cast<std::size_t>(i));
        }) {
    tape_.bound(most_of_oscillators);
    slopes_ = tape::gradient(tape_, fold_(form.potential), places());
    set_masses(form);
  }
  Oscillators(const Oscillators&) = delete;
  Oscillators& operator=(const Oscillators&) = delete;

  std::variant<Harmonic, std::string> found() {
    if (std::string why = find_stiffness(); !why.empty()) return why;
    Harmonic made;
    made.mixed = !is_diagonal(n_, stiffness_) || !is_diagonal(n_, inverse_mass_);
    if (!made.mixed) {
      for (std::size_t i = 0; i < n_; ++i) {
        const double weight = inverse_mass_[i * n_ + i], root = std::sqrt(weight);
        made.squares.push_back(stiffness_[i * n_ + i] * weight);
        made.to_places.push_back(root);
        made.to_momenta.push_back(1 / root);
        made.from_places.push_back(1 / root);
      }
    } else {
      const Square l = lower_root(n_, inverse_mass_);
      Modes modes = modes_of(n_, product(n_, transposed(n_, l), product(n_, stiffness_, l)));
      made.squares = std::move(modes.values);
      made.to_places = product(n_, l, modes.vectors);
      Square back = l;
      detail::invert(n_, back.data());
      made.from_places = product(n_, transposed(n_, modes.vectors), back);
      made.to_momenta = transposed(n_, made.from_places);
    }
    made.gradient = gradient();
    return made;
  }

 private:
  static constexpr const char* no_quadratic_part = "V has no quadratic part at the origin, where it is not smooth";

  std::vector<int> places() const {
    std::vector<int> all(n_);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  tape::Formula gradient() {
    std::vector<tape::Index> nodes;
    for (const Symbol& slope : slopes_) nodes.push_back(slope.on(tape_));
    return {tape_, nodes};
  }
  void set_masses(const Form& form) {
    inverse_mass_.assign(n_ * n_, 0);
    if (form.full_mass) {
      for (std::size_t i = 0; i < n_; ++i)
        for (const auto& [j, entry] : form.hessian.row(i)) inverse_mass_[i * n_ + j] = number(fold_(entry));
      if (!form.momenta.empty()) detail::invert(n_, inverse_mass_.data());
      for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t j = 0; j < i; ++j) inverse_mass_[j * n_ + i] = inverse_mass_[i * n_ + j];
      return;
    }
    for (std::size_t i = 0; i < n_; ++i)
      inverse_mass_[i * n_ + i] = i < form.mass.size() ? 1 / number(fold_(form.mass[i])) : 1;
  }
  /// number(y) returns the value of a symbol that depends on nothing.
  double number(const Symbol& y) {
    if (y.is_constant()) return y.constant();
    const tape::Index place = y.on(tape_);
    const std::vector<double> origin(n_, 0.0);
    double value = 0;
    tape::Formula(tape_, std::span(&place, 1)).evaluate(origin.data(), 0.0, &value);
    return value;
  }

  /// find_lasting_stiffness finds V″ at the origin for a V that depends on time, symbolically, to see whether V″ does.
  /// False: it does.
  bool find_lasting_stiffness() {
    std::vector<Symbol> second;
    for (const Symbol& slope : slopes_) {
      const std::vector<Symbol> row = tape::gradient(tape_, slope, places());
      second.insert(second.end(), row.begin(), row.end());
    }
    tape::Dependences depends(tape_, [](int) { return tape::Dependence(1); });
    tape::Substitution at_origin(tape_, tape_, [](int) { return Symbol(0); });
    for (std::size_t i = 0; i < n_ * n_; ++i) {
      const Symbol entry = at_origin(second[i]);
      if ((depends(entry) & tape::on_time) != 0) return false;
      stiffness_[i] = number(entry);
    }
    return true;
  }

  /// find_stiffness finds K = V″ at the origin; it returns why there is none, or an empty text.
  std::string find_stiffness() {
    // Second derivatives of many attracting bodies are long, and V is not smooth at the origin anyway: this is checked
    // first.
    const std::vector<double> origin(n_, 0.0);
    std::vector<double> slopes(n_);
    gradient().evaluate(origin.data(), 0.0, slopes.data());
    if (!std::ranges::all_of(slopes, [](double slope) { return std::isfinite(slope); })) return no_quadratic_part;
    stiffness_.assign(n_ * n_, 0);
    tape::Dependences depends(tape_, [](int) { return tape::Dependence(1); });
    const bool driven =
        std::ranges::any_of(slopes_, [&](const Symbol& slope) { return (depends(slope) & tape::on_time) != 0; });
    if (driven) {
      if (!find_lasting_stiffness()) return "the quadratic part of V depends on time";
    } else {
      std::vector<tape::Index> nodes;
      for (const Symbol& slope : slopes_) nodes.push_back(slope.on(tape_));
      tape::SparseJacobian(tape_, nodes, n_)
          .evaluate(gradient(), origin.data(), 0.0,
                    [&](std::size_t i, std::size_t j, double entry) { stiffness_[i * n_ + j] = entry; });
    }
    if (!std::ranges::all_of(stiffness_, [](double k) { return std::isfinite(k); })) return no_quadratic_part;
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < i; ++j)
        stiffness_[i * n_ + j] = stiffness_[j * n_ + i] = 0.5 * (stiffness_[i * n_ + j] + stiffness_[j * n_ + i]);
    if (std::ranges::all_of(stiffness_, [](double k) { return k == 0; }))
      return "V has no quadratic part at the origin";
    for (std::size_t i = 0; i < n_; ++i)
      if (const double weight = inverse_mass_[i * n_ + i]; !(weight > 0 && std::isfinite(weight)))
        return "a mass is not positive";
    return {};
  }

  std::size_t n_;
  tape::Tape tape_;
  tape::Substitution fold_;
  std::vector<Symbol> slopes_;
  Square inverse_mass_, stiffness_;
};

}  // namespace

std::variant<Harmonic, std::string> harmonic(const Form& form, std::span<const double> parameters) {
  if (form.kind != FormKind::separable) return "H is not ½ pᵀM⁻¹p + V(q, t)";
  if (form.forced) return "forces stand beside it";
  if (form.coordinates > Harmonic::most_coordinates)
    return "it has more than " + std::to_string(Harmonic::most_coordinates) + " coordinates";
  try {
    return Oscillators(form, parameters).found();
  } catch (const tape::TooManyOperations&) {
    return "its derivatives take too many operations";
  }
}

}  // namespace least::text

#include "core/text/magnetic.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/tape/derivative.hpp"
#include "core/text/symbol_matrix.hpp"

namespace least::text {
namespace {

/// What a value may depend on; parameters are numbers here.
constexpr tape::Dependence reads_q = 1, reads_p = 2;

constexpr tape::Index most_of_field = 1 << 17;

/// MagneticField holds H on a tape of its own with the variables q (from 0), then p.
class MagneticField {
 public:
  MagneticField(const Form& form, std::span<const double> parameters, std::span<const std::string> names)
      : names_(names), n_(form.coordinates) {
    tape_.bound(most_of_field);
    tape::Substitution fold(form.tape, tape_, [&](int i) {
      const Numbering& of = form.numbers;
      if (i >= of.parameter) return Symbol(parameters[static_cast<std::size_t>(i - of.parameter)]);
      if (i < of.momentum) return variable(static_cast<std::size_t>(i));
      return i == of.action ? Symbol(0) : variable(n_ + static_cast<std::size_t>(i - of.momentum));
    });
    energy_ = fold(form.hamiltonian);
    // Where a Lagrangian is given, its momenta are m v + a, from which a is taken as it was written.
    for (const Symbol& p : form.momenta) given_.push_back(at(fold(p), [](std::size_t) { return Symbol(0); }));
  }
  MagneticField(const MagneticField&) = delete;
  MagneticField& operator=(const MagneticField&) = delete;

  std::variant<Magnetic, NotMagnetic> found(Pace pace) {
    if (std::string why = find_masses(); !why.empty()) return NotMagnetic{std::move(why)};
    if (std::string why = find_shift(); !why.empty()) return NotMagnetic{std::move(why)};
    if (std::string why = find_groups(); !why.empty()) return NotMagnetic{std::move(why)};
    std::vector<Symbol> fields;
    const std::vector<Symbol> slopes =
        tape::gradient(tape_, at(energy_, [this](std::size_t i) { return shift_[i]; }), places());
    made_.kicks = !std::ranges::all_of(slopes, is_nothing);
    for (std::size_t i = 0; i < n_ && made_.kicks; ++i) fields.push_back(Symbol(-made_.inverse_root[i]) * slopes[i]);
    for (const Magnetic::Group& group : made_.groups) {
      const auto [a, b, c] = group.of;
      if (group.size == 3) {
        fields.push_back(turn(b, c));
        fields.push_back(turn(c, a));
      }
      fields.push_back(turn(a, b));
    }
    made_.fields = formula(fields);
    if (pace == Pace::yes) made_.paced = paced(slopes, fields);
    std::vector<Symbol> shift;
    for (std::size_t i = 0; i < n_; ++i) shift.push_back(Symbol(made_.inverse_root[i]) * shift_[i]);
    made_.shift = formula(shift);
    return std::move(made_);
  }

 private:
  Symbol variable(std::size_t i) { return Symbol::variable(tape_, i); }
  std::vector<int> numbered(std::size_t first) const {
    std::vector<int> all(n_);
    std::iota(all.begin(), all.end(), static_cast<int>(first));
    return all;
  }
  std::vector<int> places() const { return numbered(0); }
  /// at(y, momenta) returns y with momenta(i) in the place of p_i.
  template <class Momenta>
  Symbol at(const Symbol& y, Momenta&& momenta) {
    return tape::Substitution(tape_, tape_, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      return k < n_ ? variable(k) : momenta(k - n_);
    })(y);
  }
  tape::Formula formula(const std::vector<Symbol>& all) {
    std::vector<tape::Index> nodes;
    nodes.reserve(all.size());
    for (const Symbol& y : all) nodes.push_back(y.on(tape_));
    return {tape_, nodes};
  }
  /// number(y) returns the value of a symbol that depends on nothing.
  double number(const Symbol& y) {
    const std::vector<double> nowhere(2 * n_, 0.0);
    double value = 0;
    formula({y}).evaluate(nowhere.data(), 0.0, &value);
    return value;
  }

  /// find_masses checks that ∂²H/∂p² is diagonal with positive numbers.
  std::string find_masses() {
    slopes_ = tape::gradient(tape_, energy_, numbered(n_));
    for (std::size_t i = 0; i < n_; ++i) {
      const std::vector<Symbol> row = tape::gradient(tape_, slopes_[i], numbered(n_));
      for (std::size_t j = 0; j < n_; ++j) {
        const bool own = i == j;
        const std::string term = momentum_name(names_[i]) + (own ? "^2" : "*" + momentum_name(names_[j]));
        const tape::Dependence on = depends_(row[j]);
        if ((on & reads_p) != 0) return "H is not quadratic in " + momentum_name(names_[i]);
        if (on != 0)
          return "the coefficient of " + term + " depends on " + ((on & reads_q) != 0 ? "the place" : "time");
        const double value = number(row[j]);
        if (!own && value != 0) return "the kinetic energy has a term " + term;
        if (!own) continue;
        if (!(value > 0 && std::isfinite(value) && std::isfinite(1 / value)))
          return "the mass of " + std::string(names_[i]) + " is not positive";
        made_.root_mass.push_back(1 / std::sqrt(value));
        made_.inverse_root.push_back(std::sqrt(value));
        masses_.push_back(1 / value);
      }
    }
    return {};
  }

  /// find_shift finds a from ∂H/∂p = −a/m at p = 0.
  std::string find_shift() {
    shift_ = given_;
    if (shift_.empty())
      for (std::size_t i = 0; i < n_; ++i)
        shift_.push_back(Symbol(-masses_[i]) * at(slopes_[i], [](std::size_t) { return Symbol(0); }));
    for (std::size_t i = 0; i < n_; ++i)
      if ((depends_(shift_[i]) & tape::on_time) != 0)
        return "what is linear in " + momentum_name(names_[i]) + " depends on time";
    return {};
  }

  std::string find_groups() {
    slopes_of_shift_.clear();
    for (std::size_t i = 0; i < n_; ++i) slopes_of_shift_.push_back(tape::gradient(tape_, shift_[i], places()));
    std::vector<std::size_t> group(n_);
    std::iota(group.begin(), group.end(), std::size_t(0));
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (group[i] != group[j] && !is_nothing(turn(j, i))) {
          const auto [kept, gone] = std::minmax(group[i], group[j]);
          std::ranges::replace(group, std::size_t(gone), std::size_t(kept));
        }
    for (std::size_t i = 0; i < n_; ++i) {
      Magnetic::Group made{0, {}};
      for (std::size_t j = i; j < n_; ++j) {
        if (group[j] != i) continue;
        if (made.size == made.of.size())
          return "the field turns more than three velocities into one another, from that of " + std::string(names_[i]) +
                 " to that of " + std::string(names_[j]);
        made.of[made.size++] = j;
      }
      if (made.size < 2) continue;
      made_.turns += made.size == 3 ? 3 : 1;
      made_.groups.push_back(made);
    }
    return {};
  }
  tape::Formula paced(const std::vector<Symbol>& slopes, const std::vector<Symbol>& fields) {
    Symbol forces = 0, turns = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const std::vector<Symbol> row = tape::gradient(tape_, slopes[i], places());
      for (std::size_t j = 0; j <= i; ++j) {  // the matrix is symmetric
        if (is_nothing(row[j])) continue;
        const double both = j < i ? 2 : 1, weight = made_.inverse_root[i] * made_.inverse_root[j];
        forces = forces + Symbol(both * weight * weight) * (row[j] * row[j]);
      }
    }
    for (std::size_t i = fields.size() - made_.turns; i < fields.size(); ++i) turns = turns + fields[i] * fields[i];
    const Symbol fourth = forces + turns * turns;
    std::vector<Symbol> all{sqrt(sqrt(fourth))};
    const std::vector<Symbol> changes = tape::gradient(tape_, fourth, places());
    for (std::size_t i = 0; i < n_; ++i)
      all.push_back(is_nothing(changes[i]) ? Symbol(0) : Symbol(0.25 * made_.inverse_root[i]) * changes[i] / fourth);
    return formula(all);
  }
  /// turn returns Ω_ij.
  Symbol turn(std::size_t i, std::size_t j) {
    const Symbol field = slopes_of_shift_[j][i] - slopes_of_shift_[i][j];
    return Symbol(made_.inverse_root[i] * made_.inverse_root[j]) * field;
  }

  std::span<const std::string> names_;
  std::size_t n_;
  tape::Tape tape_;
  tape::Dependences depends_{tape_, [this](int i) { return static_cast<std::size_t>(i) < n_ ? reads_q : reads_p; }};
  Symbol energy_;
  std::vector<Symbol> given_, slopes_, shift_;
  std::vector<double> masses_;
  std::vector<std::vector<Symbol>> slopes_of_shift_;
  Magnetic made_;
};

}  // namespace

std::variant<Magnetic, NotMagnetic> magnetic(const Form& form, std::span<const double> parameters,
                                             std::span<const std::string> names, Pace pace) {
  if (form.kind != FormKind::hamiltonian) return NotMagnetic{"H has no terms that are linear in the momenta"};
  if (form.forced) return NotMagnetic{"forces stand beside it"};
  if (pace == Pace::yes && !form.autonomous) return NotMagnetic{"H depends on time"};
  if (form.reads_action) return NotMagnetic{"the motion depends on s"};
  if (form.coordinates > Magnetic::most_coordinates)
    return NotMagnetic{"it has more than " + std::to_string(Magnetic::most_coordinates) + " coordinates"};
  try {
    return MagneticField(form, parameters, names).found(pace);
  } catch (const tape::TooManyOperations&) {
    return NotMagnetic{"its derivatives take too many operations"};
  }
}

}  // namespace least::text

// Cards: the descriptions of problems and schemes. Decoder, catalogue, page and docs are made from these and from
// nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace least {

/// An interval of allowed values; an open end is excluded.
struct Range {
  double low, high;
  bool low_open = false, high_open = false;
  constexpr bool contains(double x) const {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
};

/// Every finite number.
inline constexpr Range anywhere{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), true,
                                true};

/// any_length allows lengths in time, in a parameter or along a coordinate, in any unit, whose squares do not overflow;
/// any_strength and any_signed_strength allow all coefficients whose squares do not.
inline constexpr Range any_length{0, 1e100, true};
inline constexpr Range any_strength{1e-150, 1e150}, any_signed_strength{-1e150, 1e150};

/// Kind says what values a parameter takes. All are stored as double: a choice as its index, a flag as 0 or 1, null (or
/// the word that stands for it) as NaN.
enum class Kind { number, integer, choice, flag };

/// A parameter of a problem or a scheme.
struct ParameterCard {
  std::string name, symbol, unit, doc;
  Kind kind = Kind::number;
  double value = 0;  ///< the default
  Range range{0, 0};
  std::vector<std::string> choices{};  ///< names by index, for Kind::choice
  std::string suggested{};  ///< not empty: the default is the problem's suggestion of this name, where it has one
  bool nullable = false;
  std::string word{};    ///< the word for NaN where it is nullable; empty: null
  bool weights = false;  ///< custom weights may stand instead of a choice; the value is then choices.size()
};

struct VariableCard {
  std::string name, symbol, unit, doc;
  double value;            ///< the default start; NaN: follows from the others
  bool optional = false;   ///< the motion does not need it: integrated only if it is asked for
  Range range = anywhere;  ///< where a run may start
  bool angle = false;      ///< the same after a whole turn, 2π
  bool hidden = false;     ///< beyond the coordinates of a scene whose class has room for more: it stays 0
};
/// A variable that is an angle.
inline VariableCard angle(std::string name, std::string symbol, std::string doc, double value) {
  return {std::move(name), std::move(symbol), "rad", std::move(doc), value, false, anywhere, true};
}

/// QuantityCard is a quantity that a problem defines.
struct QuantityCard {
  std::string name, symbol, doc;
};

/// What can be asked for as a column.
struct ColumnCard {
  std::string name;
  bool by_default = false;           ///< kept where a request says nothing
  bool full_state = false;           ///< a run that keeps it integrates the full state, not only what the motion needs
  bool nullable = false;             ///< it may be unknown at a state
  std::vector<std::string> words{};  ///< where its numbers are codes: their names, by value
  bool hidden = false;               ///< the column of a hidden variable: it cannot be asked for by name
};

/// What can be asked for as a diagnostic.
struct DiagnosticCard {
  std::string_view name, doc;
  bool by_default = false;  ///< reported where a request says nothing
  bool full_state = false;  ///< a run that reports it integrates the full state, not only what the motion needs
};

using NamedValue = std::pair<std::string, double>;

/// PresetCard is a named set of parameters and start values; values given in a request take precedence over it.
struct PresetCard {
  std::string name{}, doc{};
  std::vector<NamedValue> parameters{}, initial{};  ///< `t` in `initial` is the start time
  std::vector<NamedValue> suggested{};              ///< takes precedence over the problem's own suggestions
  double span = 0;                                  ///< default length of a run; 0: the problem's own
};

/// Lifted says whether lifted_splitting takes a problem, a general Hamiltonian or equations; `exactly`: its lifted
/// motion of the coordinates is linear, so that the flow of this part is known in closed form.
enum class Lifted : std::uint8_t { no, yes, exactly };

struct ProblemCard {
  std::string id{}, title{}, summary{}, formula{};  ///< formula: MathML
  std::vector<VariableCard> variables{};
  std::vector<ParameterCard> parameters{};  ///< filled in from the description
  double span = 0;                          ///< default length of a run in time
  std::vector<NamedValue> suggested{};
  std::vector<PresetCard> presets{};
  std::vector<QuantityCard> invariants{};  ///< conserved by the exact motion, besides the energy
  std::vector<QuantityCard> quantities{};  ///< not conserved
  std::vector<std::string> references{};
  Lifted lift = Lifted::no;
  std::string lift_objection{};  ///< for a general Hamiltonian, why lift is `no`
  // Derived from the mechanics:
  bool keeps_energy = false;                  ///< the exact motion conserves the energy
  bool keeps_form = false;                    ///< the exact motion conserves the symplectic or the contact form
  std::vector<ColumnCard> columns{};          ///< every column that can be asked for, `t` first
  std::vector<DiagnosticCard> diagnostics{};  ///< every diagnostic that can be asked for
  std::vector<std::size_t> schemes{};         ///< indices of the schemes that apply
  std::string offers{};                       ///< what its mechanics can offer to a scheme, in words
};

/// SchemePresetCard is a named set of a scheme's parameters. Values given in a request take precedence over it, and it
/// takes precedence over what a problem suggests.
struct SchemePresetCard {
  std::string name{}, doc{};
  std::vector<NamedValue> settings{};
};

/// Conflict describes settings that are allowed one by one, but not together or not with the problem.
struct Conflict {
  std::string parameter{};  ///< the one to change
  std::string detail{}, allowed{};
};

struct SchemeCard {
  std::string id{}, title{}, summary{};
  /// By the name of a choice or the value of an integer parameter; a single one without a name if it is fixed.
  std::vector<std::pair<std::string, int>> orders{};
  bool implicit = false, symmetric = false;
  std::string structure{};                  ///< symplectic | contact | volume | none
  bool keeps_momenta = false;               ///< conserves those of symmetries; implied where it has a structure
  std::vector<ParameterCard> parameters{};  ///< filled in from the description
  std::string recommended{};                ///< the recommended composition, or empty
  std::vector<SchemePresetCard> presets{};
  bool own_clock = false;  ///< it chooses the times of its steps itself (SelfTimed); derived
  /// conflicts(settings, problem) returns what forbids these settings for this problem; derived, may be null.
  std::vector<Conflict> (*conflicts)(std::span<const double> settings, const ProblemCard& problem) = nullptr;
  /// takes(problem) says whether it takes a problem whose type fits; derived, null: every one.
  bool (*takes)(const ProblemCard& problem) = nullptr;
  std::string good_for{}, fails_when{}, needs{};
  std::vector<std::string> references{};

  /// The index of the parameter with this name.
  std::optional<std::size_t> find(std::string_view parameter) const;
  /// The order with these settings; 0 where none is declared.
  int order(std::span<const double> settings) const;
};

/// MayBeWeights holds for the type of a choice that custom weights may replace (Composition).
template <class M>
concept MayBeWeights = requires(const M& choice) {
  choice.weights();
};

/// Field describes one parameter of the aggregate C: the member that holds its value, and the values that are allowed.
/// Its default is that of C{}. M is the type of the member: double, int, bool, or for a choice an enumeration or
/// Composition.
template <class C, class M = double>
struct Field {
  std::string_view name, symbol, unit, doc;
  M C::*member;
  Range range{0, 0};
  std::span<const std::string_view> choices{};
  std::string_view suggested{};
  std::string_view absent{};  ///< "null" or another word that stands for NaN; empty: a number is required

  ParameterCard card() const {
    constexpr Kind kind = std::is_same_v<M, bool>  ? Kind::flag
                          : std::is_same_v<M, int> ? Kind::integer
                          : std::is_enum_v<M>      ? Kind::choice
                                                   : Kind::number;
    return {.name = std::string(name),
            .symbol = std::string(symbol),
            .unit = std::string(unit),
            .doc = std::string(doc),
            .kind = choices.empty() ? kind : Kind::choice,
            .value = static_cast<double>(C{}.*member),
            .range = range,
            .choices = {choices.begin(), choices.end()},
            .suggested = std::string(suggested),
            .nullable = !absent.empty(),
            .word = std::string(absent == "null" ? std::string_view() : absent),
            .weights = MayBeWeights<M>};
  }
  /// Sets the member from a value that the card allows.
  void set(C& c, double value) const { c.*member = static_cast<M>(value); }
};

/// has_weights says whether this value of the parameter stands for custom weights; they follow the values of all
/// parameters in the list of settings.
inline bool has_weights(const ParameterCard& card, double value) {
  return card.weights && value == static_cast<double>(card.choices.size());
}
inline std::span<const double> weights_of(const SchemeCard& card, std::span<const double> settings) {
  return settings.subspan(card.parameters.size());
}
/// order_with_weights returns the order of a scheme whose settings end with custom weights.
int order_with_weights(const SchemeCard& card, std::span<const double> settings);

/// What a problem's file says about itself beside its mechanics: `fields`, a tuple of Field, and `card()`.
template <template <class> class P>
struct About;

}  // namespace least

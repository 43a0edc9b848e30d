// Cards: what the descriptions of problems and schemes say about themselves. Decoder, catalogue, page and docs are made
// from these and from nothing else.
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

/// Every length in time, in a parameter or along a coordinate, whatever its unit, of which squares do not overflow; and
/// every strength.
inline constexpr Range any_length{0, 1e100, true};
inline constexpr Range any_strength{1e-150, 1e150}, any_signed_strength{-1e150, 1e150};

/// What values a parameter takes. All are held as double: a choice by its index, a flag as 0 or 1, null (or the word
/// that stands for it) as NaN.
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
  std::string word{};    ///< what stands for NaN where it is nullable; empty: null
  bool weights = false;  ///< a list of numbers may stand instead of a choice: the choice after the last
};

struct VariableCard {
  std::string name, symbol, unit, doc;
  double value;            ///< the default start; NaN: follows from the others
  bool optional = false;   ///< not part of the motion: carried along where it is asked for
  Range range = anywhere;  ///< where a run may start
  bool angle = false;      ///< the same after a whole turn, 2π
  bool hidden = false;     ///< of a capacity that a scene does not use: it rests at zero, and nobody asks for it
};
/// A variable that is an angle.
inline VariableCard angle(std::string name, std::string symbol, std::string doc, double value) {
  return {std::move(name), std::move(symbol), "rad", std::move(doc), value, false, anywhere, true};
}

/// A quantity of the problem's own.
struct QuantityCard {
  std::string name, symbol, doc;
};

/// What can be asked for as a column.
struct ColumnCard {
  std::string name;
  bool by_default = false;           ///< kept where a request says nothing
  bool full_state = false;           ///< a run that keeps it carries more than the motion needs
  bool nullable = false;             ///< it may be unknown at a state
  std::vector<std::string> words{};  ///< what its numbers stand for, by value, where they are codes
  bool hidden = false;               ///< of a hidden variable: nobody asks for it by name
};

/// What can be asked for as a diagnostic.
struct DiagnosticCard {
  std::string_view name, doc;
  bool by_default = false;  ///< reported where a request says nothing
  bool full_state = false;  ///< a run that is asked for it carries more than the motion needs
};

using NamedValue = std::pair<std::string, double>;

/// A named set of parameters and start values; keys that stand in a request win over it.
struct PresetCard {
  std::string name{}, doc{};
  std::vector<NamedValue> parameters{}, initial{};  ///< `t` among the start's: the start time
  std::vector<NamedValue> suggested{};              ///< wins over the problem's own suggestions
  double span = 0;                                  ///< default length of a run; 0: the problem's own
};

/// Whether a Hamiltonian given as text, or equations are for lifted_splitting, and whether what is linear in the
/// momenta moves the coordinates in a way that can be followed exactly.
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
  std::string lift_objection{};  ///< why not, of a general Hamiltonian
  // Derived from the mechanics:
  bool keeps_energy = false;                  ///< the exact motion conserves the energy
  bool keeps_form = false;                    ///< it keeps the symplectic or the contact form
  std::vector<ColumnCard> columns{};          ///< every column that can be asked for, `t` first
  std::vector<DiagnosticCard> diagnostics{};  ///< every diagnostic that can be asked for
  std::vector<std::size_t> schemes{};         ///< indices of the schemes that apply
  std::string offers{};                       ///< what its mechanics can offer to a scheme, in words
};

/// A named set of a scheme's parameters; keys that stand in a request win over it, it wins over what a problem
/// suggests.
struct SchemePresetCard {
  std::string name{}, doc{};
  std::vector<NamedValue> settings{};
};

/// Settings that each are allowed and do not go together, or not with the problem.
struct Conflict {
  std::string parameter{};  ///< the one to change
  std::string detail{}, allowed{};
};

struct SchemeCard {
  std::string id{}, title{}, summary{};
  std::vector<std::pair<std::string, int>> orders{};  ///< by choice or number, as a composition; or one without a name
  bool implicit = false, symmetric = false;
  std::string structure{};                  ///< symplectic | contact | volume | none
  bool keeps_momenta = false;               ///< of symmetries, whatever its structure; with a structure it always does
  std::vector<ParameterCard> parameters{};  ///< filled in from the description
  std::string recommended{};                ///< the recommended composition, or empty
  std::vector<SchemePresetCard> presets{};
  bool own_clock = false;  ///< its steps are not steps of time, or of any length; derived
  /// What speaks against these settings on this problem; derived, may be null.
  std::vector<Conflict> (*conflicts)(std::span<const double> settings, const ProblemCard& problem) = nullptr;
  /// Whether it takes a problem that is of a type which fits it; derived, null: every one.
  bool (*takes)(const ProblemCard& problem) = nullptr;
  std::string good_for{}, fails_when{}, needs{};
  std::vector<std::string> references{};

  /// The position of a parameter.
  std::optional<std::size_t> find(std::string_view parameter) const;
  /// With these settings; 0 where none is declared.
  int order(std::span<const double> settings) const;
};

/// A choice that may be weights of the caller's own instead.
template <class M>
concept MayBeWeights = requires(const M& choice) {
  choice.weights();
};

/// One parameter of the aggregate C: where its value lives and what may stand there. Its default is that of C{}.
/// M is the member's type: double, int, bool, or for a choice an enumeration or what may be weights.
template <class C, class M = double>
struct Field {
  std::string_view name, symbol, unit, doc;
  M C::*member;
  Range range{0, 0};
  std::span<const std::string_view> choices{};
  std::string_view suggested{};
  std::string_view absent{};  ///< "null" or another word: may stand instead of a number and is NaN

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

/// Whether the value of a parameter stands for weights of the caller's own, which then stand after all settings.
inline bool has_weights(const ParameterCard& card, double value) {
  return card.weights && value == static_cast<double>(card.choices.size());
}
inline std::span<const double> weights_of(const SchemeCard& card, std::span<const double> settings) {
  return settings.subspan(card.parameters.size());
}
/// The order of a scheme with such weights.
int order_with_weights(const SchemeCard& card, std::span<const double> settings);

/// What a problem's file says about itself beside its mechanics: `fields`, a tuple of Field, and `card()`.
template <template <class> class P>
struct About;

}  // namespace least

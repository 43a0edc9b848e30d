// Symmetric compositions: a symmetric step of order 2 (or 4) taken with the weights γ₁h, …, γ_s h, γ_i = γ_{s+1−i}, is
// a symmetric step of higher order. The coefficients have 36 digits (Sofroniou–Spaletta: the 26 published), so that in
// quad precision their errors stay below 1e-25. Sources: Yoshida, Phys. Lett. A 150, 262 (1990); Suzuki, Phys. Lett. A
// 146, 319 (1990); Suzuki & Umeno 1993; Kahan & Li, Math. Comp. 66, 1089 (1997); Sofroniou & Spaletta, Optim. Methods
// Softw. 20, 597 (2005).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeindex>
#include <vector>

#include "core/number/parse.hpp"
#include "core/status.hpp"

namespace least {

/// Composition is one of the named compositions, or a list of custom weights. Copies share that list. Steppers point
/// into tables that are kept with it (`kept`), so whoever holds a stepper has to hold its scheme, too.
class Composition {
 public:
  enum Name : std::uint8_t {
    none,
    yoshida_4,
    suzuki_4,
    yoshida_6,
    kahan_li_6,
    yoshida_8,
    suzuki_umeno_8,
    kahan_li_8,
    sofroniou_spaletta_10,
    custom,  ///< a list of custom weights, not empty
  };

  Composition(Name name = none) : name_(name) {}  // NOLINT(google-explicit-constructor): a name is a composition
  /// Makes the composition with this index among the names, as settings store it; `weights` are those of `custom`.
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit Composition(Number index, std::span<const double> weights = {}) : name_(static_cast<Name>(index)) {
    if (name_ == custom) list_ = std::make_shared<const List>(weights);
  }
  /// Makes a custom composition; `compositions::objection(weights)` has to be empty.
  explicit Composition(std::span<const double> weights) : Composition(static_cast<int>(custom), weights) {}
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit operator Number() const { return static_cast<Number>(name_); }

  /// The custom weights; empty for a named composition.
  std::span<const double> weights() const { return list_ ? list_->weights : std::span<const double>(); }
  /// kept(make) returns a V that is derived from the custom weights. The first call for each type V makes it; it lives
  /// as long as the list of weights.
  template <class V, class Make>
  const V& kept(Make&& make) const {
    const std::lock_guard lock(list_->mutex);
    auto& place = list_->made[typeid(V)];
    if (!place) place = std::make_shared<const V>(make());
    return *static_cast<const V*>(place.get());
  }

  friend bool operator==(const Composition& a, const Composition& b) {
    return a.name_ == b.name_ && std::ranges::equal(a.weights(), b.weights());
  }

 private:
  struct List {
    explicit List(std::span<const double> all) : weights(all.begin(), all.end()) {}
    std::vector<double> weights;
    mutable std::mutex mutex;
    mutable std::map<std::type_index, std::shared_ptr<const void>> made;
  };

  Name name_;
  std::shared_ptr<const List> list_;
};

namespace compositions {

inline constexpr int most_stages = 35;
inline constexpr double largest_weight = 100;

/// objection returns in words why a list of weights is not allowed, or an empty string. Weights have to be 1 to
/// most_stages finite numbers, symmetric, with the sum 1 up to a rounding of each weight to 15 digits.
std::string objection(std::span<const double> weights);
/// order_of returns the order, at most 10, of the composition of a symmetric scheme with these weights. It checks the
/// order conditions: with the scheme written as exp(hX₁ + h³X₃ + h⁵X₅ + …), the coefficients of the words in X₁, X₃, …
/// of the product have to be those of exp(hX₁). `base` is the order of the scheme: 2, or 4 where X₃ = 0. Source:
/// Hairer, Lubich, Wanner 2006, III.3.
int order_of(std::span<const double> weights, int base = 2);

inline constexpr std::array<std::string_view, 9> names{"none",           "yoshida_4",  "suzuki_4",
                                                       "yoshida_6",      "kahan_li_6", "yoshida_8",
                                                       "suzuki_umeno_8", "kahan_li_8", "sofroniou_spaletta_10"};

/// Order of the composed scheme when the base is of order 2.
inline constexpr std::array<int, 9> orders{2, 4, 4, 6, 6, 8, 8, 8, 10};

/// The first half of the symmetric list of weights: outermost first, the middle one last.
inline constexpr std::string_view none[] = {"1"};
inline constexpr std::string_view yoshida_4[] = {
    "1.35120719195965763404768780897146083",
    "-1.70241438391931526809537561794292165",
};
inline constexpr std::string_view suzuki_4[] = {
    "0.414490771794375737142354062860761496",
    "0.414490771794375737142354062860761496",
    "-0.657963087177502948569416251443045983",
};
inline constexpr std::string_view yoshida_6[] = {
    "0.784513610477557263819497633866349876",
    "0.235573213359358133684793182978534602",
    "-1.17767998417887100694641568096431573",
    "1.31518632068391121888424972823886251",
};
inline constexpr std::string_view kahan_li_6[] = {
    "0.392161444007314139279250557367727781",  "0.332599136789359438599748637569179297",
    "-0.706246172557639359809964819547430485", "0.0822135962935508002314904480860443303",
    "0.798543990934829963398950353048958155",
};
inline constexpr std::string_view yoshida_8[] = {
    "0.914844246229791566748793489847509605", "0.253693336566211354146146020689942076",
    "-1.44485223686060515769473065753739035", "-0.158240635368050175204066776759754248",
    "1.93813913762252598657918648744364176",  "-1.96061023297531080760763337639966364",
    "0.102799849391796440698115131601225863", "1.70845307078728158466837936222897788",
};
inline constexpr std::string_view suzuki_umeno_8[] = {
    "0.741670364350612953448227801783806316", "-0.409100825800031593997300095893563417",
    "0.190754710296238379953876256450371663", "-0.573862471116082266656387726635535742",
    "0.299064181303655923844463540688602988", "0.334624918245298183784957979882182289",
    "0.315293092396766596632056663811002431", "-0.796887939352916354019788840173733053",
};
inline constexpr std::string_view kahan_li_8[] = {
    "0.130202483088890080878817631959221098",  "0.561162981775108384561964407698960452",
    "-0.389474962644847286408078597894806655", "0.158841906555155600896210745770789559",
    "-0.39590389413323757733623153961796642",  "0.184539640978315707091832541653414114",
    "0.258374387686322047293979110106439375",  "0.295011723609310298870966239991307771",
    "-0.605508533830034511698921079334718588",
};
inline constexpr std::string_view sofroniou_spaletta_10[] = {
    "0.07879572252168641926390768",  "0.31309610341510852776481247",  "0.02791838323507806610952027",
    "-0.2295928415939070941512134",  "0.13096206107716486317465686",  "-0.26973340565451071434460973",
    "0.07497334315589143566613711",  "0.11199342399981020488957508",  "0.36613344954622675119314812",
    "-0.39910563013603589787862981", "0.10308739852747107731580277",  "0.41143087395589023782070412",
    "-0.00486636058313526176219566", "-0.39203335370863990644808194", "0.0519425029624496470371829",
    "0.05066509075992449633587434",  "0.0496743706397298790545688",   "0.04931773575959453791768004",
};
inline constexpr std::array<std::span<const std::string_view>, 9> halves{
    none, yoshida_4, suzuki_4, yoshida_6, kahan_li_6, yoshida_8, suzuki_umeno_8, kahan_li_8, sofroniou_spaletta_10};

}  // namespace compositions

/// Weights holds the weights γ_i of a composition, which add up to 1, in the number S that time is made of.
template <class S>
struct Weights {
  int stages = 1;
  std::array<S, compositions::most_stages> gamma{};
  std::array<S, compositions::most_stages> end{}, middle{};  ///< times of the stages, as fractions of the step

  Weights() = default;
  std::span<const S> ends() const { return {end.data(), static_cast<std::size_t>(stages)}; }
  std::span<const S> middles() const { return {middle.data(), static_cast<std::size_t>(stages)}; }

  /// of(composition) returns its weights; those of a named composition are parsed once for each S.
  static const Weights& of(const Composition& composition);

 private:
  template <class Weight>
  Weights(int count, Weight&& weight) : stages(count) {
    S done(0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(stages); ++i) {
      gamma[i] = weight(i);
      middle[i] = done + gamma[i] / 2;
      end[i] = done = done + gamma[i];
    }
    end[static_cast<std::size_t>(stages) - 1] = S(1);
  }
};

template <class S>
const Weights<S>& Weights<S>::of(const Composition& composition) {
  if (!composition.weights().empty())
    return composition.kept<Weights>([&] {
      const auto list = composition.weights();
      return Weights(static_cast<int>(list.size()), [&](std::size_t i) { return S(list[i]); });
    });
  static const auto table = [] {
    std::array<Weights, compositions::names.size()> all;
    for (std::size_t c = 0; c < all.size(); ++c) {
      const auto half = compositions::halves[c];
      const std::size_t last = 2 * half.size() - 2;
      all[c] =
          Weights(static_cast<int>(last + 1), [&](std::size_t i) { return parse<S>(half[std::min(i, last - i)]); });
    }
    return all;
  }();
  return table[static_cast<std::size_t>(composition)];
}
#ifndef LEAST_LANE_BYTES  // a unit of lanes instantiates its own
extern template const Weights<double>& Weights<double>::of(const Composition& composition);
#endif

/// The size of the largest negative weight; 0 where there is none.
inline double largest_negative_weight(const Composition& composition) {
  double most = 0;
  for (const double gamma : Weights<double>::of(composition).gamma) most = std::max(most, -gamma);
  return most;
}

/// Composed takes a step of a composition as stages of lengths γ_i·h of the symmetric stepper Base; neighbouring stages
/// are not fused. A failed stage leaves the state as it was.
template <class Base, class S>
class Composed {
 public:
  Composed(const Base& base, const Composition& composition) : base_(base), weights_(&Weights<S>::of(composition)) {}

  template <class X>
  StepStatus step(X& x, const S& h) noexcept {
    X y = x;
    S done(0);
    for (int i = 0; i < weights_->stages; ++i) {
      const S& gamma = weights_->gamma[static_cast<std::size_t>(i)];
      y.t = x.t + done * h;
      if (const StepStatus status = base_.step(y, gamma * h); status != StepStatus::ok) {
        if constexpr (requires { base_.begin(x); }) base_.begin(x);
        return status;
      }
      done = done + gamma;
    }
    y.t = x.t;
    x = y;
    return StepStatus::ok;
  }
  const Work& work() const { return base_.work(); }

 private:
  Base base_;
  const Weights<S>* weights_;
};

}  // namespace least

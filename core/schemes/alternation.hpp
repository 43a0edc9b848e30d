// How the two parts of a splitting take turns: drift₀, kick₀, drift₁, …, kick_{n−1}, drift_n, in fractions of the step.
// A symmetric composition of drift ½, kick, drift ½ is one way. The others here are made for motions near to one that
// the drifts solve, H = A + εB with B in the kicks: SABA_n has Gauss' nodes and weights, so that a step is wrong by
// O(ε h^{2n+1} + ε² h³); ABA(8,6,4) and ABA(10,6,4) by O(ε h⁹ + ε² h⁷ + ε³ h⁵) and O(ε h¹¹ + ε² h⁷ + ε³ h⁵). Where ε
// is not small they are symmetric schemes of order 2 and 4.
// Sources: McLachlan, BIT 35, 258 (1995); Laskar & Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001); Blanes, Casas,
// Farrés, Laskar, Makazaga, Murua, Appl. Numer. Math. 68, 58 (2013).
#pragma once

#include "core/composition.hpp"

namespace least {

namespace alternations {

/// The first halves of the palindromes of drifts and of kicks, outermost first, the middle last; 36 digits.
struct Named {
  std::string_view name;
  int order;  ///< where ε is not small
  int stages;
  std::array<std::string_view, 5> drifts, kicks;
};

/// The fourth kick of ABA(8,6,4) is in circulation with a digit too few; it follows from the others, as the sum of all
/// is 1.
inline constexpr std::array<Named, 4> named{{
    {"saba_2", 2, 2, {"0.211324865405187117745425609749021272", "0.577350269189625764509148780501957456"}, {"0.5"}},
    {"saba_4",
     2,
     4,
     {"0.0694318442029737123880267555535952475", "0.260577634004598155210640364894782409",
      "0.339981043584856264802665759103244687"},
     {"0.173927422568726928686531974610999704", "0.326072577431273071313468025389000296"}},
    {"aba_864",
     4,
     7,
     {"0.0711334264982231177779387300061549964", "0.24115342795664009873648779532628965",
      "0.52141176177281478921213607806799423", "-0.333698616227678005726562603400438876"},
     {"0.183083687472197221961703757166430291", "0.310782859898574869507522291054262796",
      "-0.0265646185119588006972121379164987593", "0.0653961422823734184559721793916113436"}},
    {"aba_1064",
     4,
     8,
     {"0.0380944974224121954569753223086375653", "0.14529871611691374929402007266066375",
      "0.207627695725541250716205611324988207", "0.435909703651526159223154862401065184",
      "-0.653861225832786709380711737390709412"},
     {"0.0958588808370752106107715037714588478", "0.204446153142998780680507783916434478",
      "0.217070347978991101714338592430633671", "-0.0173753819590650930056178801185269972"}},
}};

}  // namespace alternations

/// Alternation lists the drifts and kicks of a step as fractions of it, in the number type S of time.
template <class S>
struct Alternation {
  int stages = 1;                                             ///< number of kicks; there is one drift more
  std::array<S, compositions::most_stages> kick{}, middle{};  ///< middle: the time of each kick
  std::array<S, compositions::most_stages + 1> drift{};

  std::span<const S> middles() const { return {middle.data(), static_cast<std::size_t>(stages)}; }

  /// Returns the alternation of drift ½, kick, drift ½ with this composition.
  static const Alternation& of(const Composition& composition);
  /// Returns the i-th of `alternations::named`.
  static const Alternation& named(std::size_t i);

  Alternation() = default;

 private:
  explicit Alternation(const Weights<S>& weights)
      : stages(weights.stages), kick(weights.gamma), middle(weights.middle) {
    const auto last = static_cast<std::size_t>(stages);
    drift[0] = kick[0] * 0.5;
    for (std::size_t i = 1; i < last; ++i) drift[i] = (kick[i - 1] + kick[i]) * 0.5;
    drift[last] = kick[last - 1] * 0.5;
  }
  explicit Alternation(const alternations::Named& text) : stages(text.stages) {
    const auto last = static_cast<std::size_t>(stages);
    S done(0);
    for (std::size_t i = 0; i <= last; ++i) {
      drift[i] = parse<S>(text.drifts[std::min(i, last - i)]);
      if (i == last) break;
      kick[i] = parse<S>(text.kicks[std::min(i, last - 1 - i)]);
      middle[i] = done = done + drift[i];
    }
  }
};

template <class S>
const Alternation<S>& Alternation<S>::of(const Composition& composition) {
  if (!composition.weights().empty()) {
    const auto& weights = Weights<S>::of(composition);  // the composition keeps these, too: first of all
    return composition.kept<Alternation>([&] { return Alternation(weights); });
  }
  static const auto table = [] {
    std::array<Alternation, compositions::names.size()> all;
    for (std::size_t c = 0; c < all.size(); ++c) all[c] = Alternation(Weights<S>::of(static_cast<Composition>(c)));
    return all;
  }();
  return table[static_cast<std::size_t>(composition)];
}
template <class S>
const Alternation<S>& Alternation<S>::named(std::size_t i) {
  static const auto table = [] {
    std::array<Alternation, alternations::named.size()> all;
    for (std::size_t c = 0; c < all.size(); ++c) all[c] = Alternation(alternations::named[c]);
    return all;
  }();
  return table[i];
}
#ifndef LEAST_LANE_BYTES  // units of lanes instantiate everything themselves
extern template const Alternation<double>& Alternation<double>::of(const Composition& composition);
extern template const Alternation<double>& Alternation<double>::named(std::size_t i);
#endif

}  // namespace least

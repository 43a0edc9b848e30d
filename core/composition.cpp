#include "core/composition.hpp"

#include <fmt/format.h>

#include <cmath>

namespace least {

template const Weights<double>& Weights<double>::of(const Composition& composition);

namespace compositions {
namespace {

/// Word is a word in X₁, X₃, X₅, X₇ and X₉ of degree at most 9. The list of all words puts each after the word that it
/// prolongs and begins with the empty one.
struct Word {
  std::size_t shorter;  ///< index of the word without its last letter
  int degree;
  bool pure;   ///< contains X₁ only
  bool third;  ///< contains X₃
};
constexpr int highest = 9;  // symmetric compositions have even order, so order 10 needs degrees up to 9
std::vector<Word> all_words() {
  std::vector<Word> words{{0, 0, true, false}};
  for (std::size_t i = 0; i < words.size(); ++i)
    for (int letter = 1; words[i].degree + letter <= highest; letter += 2)
      words.push_back({i, words[i].degree + letter, words[i].pure && letter == 1, words[i].third || letter == 3});
  return words;
}

/// product returns the coefficients of the words in the product of the exp(γX₁ + γ³X₃ + …) of all weights γ.
template <class Weight>
std::vector<double> product(const std::vector<Word>& words, std::span<const double> weights, Weight&& weight) {
  std::vector<double> all(words.size()), next;
  all[0] = 1;
  for (const double listed : weights) {
    const double gamma = weight(listed);
    next = all;
    for (std::size_t i = 1; i < words.size(); ++i) {
      double factorial = 1, letters = 0;
      for (std::size_t before = i; before != 0;) {
        before = words[before].shorter;
        factorial *= ++letters;
        next[i] += all[before] * std::pow(gamma, words[i].degree - words[before].degree) / factorial;
      }
    }
    all.swap(next);
  }
  return all;
}

}  // namespace

std::string objection(std::span<const double> weights) {
  if (weights.empty() || weights.size() > std::size_t{most_stages})
    return fmt::format("must be 1 to {} weights, not {}", most_stages, weights.size());
  double sum = 0;
  std::string uneven, off;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double twin = weights[weights.size() - 1 - i];
    if (!(std::abs(weights[i]) <= largest_weight))
      return fmt::format("weight {} is {}, beyond ±{}", i + 1, weights[i], largest_weight);
    if (weights[i] != twin && uneven.empty())
      uneven = fmt::format("must be symmetric: weight {} is {}, and weight {} from the end {}", i + 1, weights[i],
                           i + 1, twin);
    sum += weights[i];
  }
  const double slack = 1e-15 * static_cast<double>(weights.size());
  if (!(std::abs(sum - 1) <= slack))
    off = fmt::format("must add up to 1 within {:.2g}: they add up to 1 {} {:.3g}", slack, sum > 1 ? '+' : '-',
                      std::abs(sum - 1));
  return uneven + (uneven.empty() || off.empty() ? "" : "; ") + off;
}

int order_of(std::span<const double> weights, int base) {
  static const std::vector<Word> words = all_words();
  // A condition holds up to rounding: of the sum of its terms, and of weights given with 15 digits.
  constexpr double rounding = 1e-12;
  const auto found = product(words, weights, [](double x) { return x; });
  const auto terms = product(words, weights, [](double x) { return std::abs(x); });
  int wrong = highest + 2;  // the lowest odd degree at which a condition fails
  double factorial = 1;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const Word& word = words[i];
    double exact = 0;
    if (word.third && base > 2) continue;
    if (word.pure) exact = 1 / (factorial *= word.degree);
    if (std::abs(found[i] - exact) > rounding * terms[i]) wrong = std::min(wrong, word.degree | 1);
  }
  return wrong - 1;
}

}  // namespace compositions
}  // namespace least

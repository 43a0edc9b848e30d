#include "core/text/planetary.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/tape/derivative.hpp"
#include "core/text/attraction.hpp"

namespace least::text {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

constexpr tape::Index most_of_potential = 1 << 17;

constexpr const char* between_no_bodies = "a term −k/r is between coordinates that are not those of two bodies";

class Finder {
 public:
  Finder(const Form& form, std::span<const double> parameters, std::span<const std::string> names)
      : names_(names), n_(form.coordinates) {
    tape_.bound(most_of_potential);
    tape::Substitution fold(form.tape, tape_, [&](int i) {
      if (i >= form.numbers.parameter) return Symbol(parameters[static_cast<std::size_t>(i - form.numbers.parameter)]);
      return Symbol::variable(tape_, static_cast<std::size_t>(i));
    });
    potential_ = fold(form.potential);
    masses_.reserve(n_);
    for (const Symbol& m : form.mass) {
      const Symbol mass = fold(m);
      masses_.push_back(mass.is_constant() ? mass.constant() : std::numeric_limits<double>::quiet_NaN());
    }
    masses_.resize(n_, 1);
  }

  std::variant<Planetary, NotPlanetary> find() {
    if (!take_terms()) return NotPlanetary{"V is a sum of too many terms"};
    if (attractions_.empty()) return NotPlanetary{"V has no term −k/r between two bodies or to a fixed place"};
    const bool fixed = std::ranges::any_of(attractions_, [](const Attraction& term) { return term.is_fixed(); });
    std::string why = fixed ? take_fixed() : take_bodies();
    if (why.empty()) why = objection_to_masses();
    if (!why.empty()) return NotPlanetary{std::move(why)};
    write_rest();
    return std::move(found_);
  }

 private:
  /// take_terms splits V into attractions and the rest. False where V has too many terms.
  bool take_terms() {
    constexpr std::size_t most = 1 << 17;
    if (potential_.is_constant()) return true;
    std::vector<std::pair<Index, double>> open{{potential_.place(), 1}};
    for (std::size_t seen = 0; !open.empty(); ++seen) {
      if (seen > most) return false;
      const auto [i, factor] = open.back();
      open.pop_back();
      const Node node = tape_[i];
      const auto is_number = [&](Index j) { return tape_[j].op == Op::constant; };
      if (node.op == Op::add || node.op == Op::subtract) {
        open.emplace_back(node.b, node.op == Op::add ? factor : -factor);
        open.emplace_back(node.a, factor);
      } else if (node.op == Op::multiply && (is_number(node.a) || is_number(node.b))) {
        const bool first = is_number(node.a);
        open.emplace_back(first ? node.b : node.a, factor * tape_[first ? node.a : node.b].value);
      } else if (node.op == Op::divide && is_number(node.b)) {
        open.emplace_back(node.a, factor / tape_[node.b].value);
      } else if (node.op != Op::constant) {
        Monomial term = Monomial::of(tape_, i);
        term.factor *= factor;
        if (auto attraction = Attraction::of(tape_, term)) {
          attractions_.push_back(std::move(*attraction));
        } else {
          rest_.emplace_back(i, factor);
        }
      }
    }
    return true;
  }

  const std::string& name(int i) const { return names_[static_cast<std::size_t>(i)]; }

  /// take_fixed finds bodies about a fixed centre: each term contains the coordinates of one body.
  std::string take_fixed() {
    std::vector<bool> seen(n_);
    for (const Attraction& term : attractions_) {
      if (!term.is_fixed()) continue;
      Planetary::Body body;
      body.strength = term.strength;
      std::array<double, 3> centre{};
      for (std::size_t k = 0; k < term.axes.size(); ++k) {
        const auto i = static_cast<std::size_t>(term.axes[k].first);
        body.coordinates[k] = i;
        centre[k] = term.centre[k];
        if (seen[i]) return name(term.axes[k].first) + " stands in several terms −k/r to a fixed place";
        seen[i] = true;
      }
      if (!found_.bodies.empty() && centre != found_.centre)
        return "the fixed places of its terms −k/r are not the same";
      found_.centre = centre;
      found_.bodies.push_back(body);
    }
    if (std::string why = objection_to_missing(seen); !why.empty()) return why;
    return take_pairs() ? std::string() : between_no_bodies;
  }

  /// take_bodies: coordinates of one body appear in the same terms, and on different axes.
  std::string take_bodies() {
    const std::size_t dimension = attractions_.front().axes.size();
    std::vector<std::size_t> axis(n_);
    std::iota(axis.begin(), axis.end(), std::size_t(0));
    const auto root = [&](std::size_t i) {
      while (axis[i] != i) i = axis[i] = axis[axis[i]];
      return i;
    };
    std::vector<std::vector<std::size_t>> stands(n_);  // by coordinate, the terms that contain it
    std::map<std::vector<std::pair<int, int>>, std::size_t> known;
    for (const Attraction& term : attractions_) {
      if (term.axes.size() != dimension) return "its terms −k/r are not all in the plane or all in space";
      const std::size_t which = known.emplace(term.axes, known.size()).first->second;
      for (const auto& [a, b] : term.axes) {
        for (const int i : {a, b}) {
          auto& all = stands[static_cast<std::size_t>(i)];
          if (all.empty() || all.back() != which) all.push_back(which);
        }
        axis[root(static_cast<std::size_t>(a))] = root(static_cast<std::size_t>(b));
      }
    }
    std::vector<bool> seen(n_);
    for (std::size_t i = 0; i < n_; ++i) seen[i] = !stands[i].empty();
    if (std::string why = objection_to_missing(seen); !why.empty()) return why;
    if (known.size() == 1) {
      take_two(attractions_.front());
    } else if (!take_same(stands, dimension, root)) {
      return "it cannot be told which coordinates are those of one body";
    }
    if (!take_pairs()) return between_no_bodies;
    return take_centre();
  }
  /// take_two: with two bodies, one term contains all coordinates, and equal masses tell the bodies apart.
  void take_two(const Attraction& term) {
    const auto mass = [&](int i) { return masses_[static_cast<std::size_t>(i)]; };
    found_.bodies.resize(2);
    for (std::size_t k = 0; k < term.axes.size(); ++k) {
      auto [a, b] = term.axes[k];
      const double first = mass(term.axes.front().first);
      if (mass(a) != first && mass(b) == first) std::swap(a, b);
      found_.bodies[0].coordinates[k] = static_cast<std::size_t>(a);
      found_.bodies[1].coordinates[k] = static_cast<std::size_t>(b);
    }
  }
  /// take_same groups coordinates that appear in the same terms. False where a group does not have one coordinate for
  /// each axis.
  template <class Root>
  bool take_same(std::vector<std::vector<std::size_t>>& stands, std::size_t dimension, const Root& root) {
    std::map<std::vector<std::size_t>, std::vector<std::size_t>> groups;
    std::vector<std::vector<std::size_t>> in_order;
    for (std::size_t i = 0; i < n_; ++i) {
      std::ranges::sort(stands[i]);
      stands[i].erase(std::unique(stands[i].begin(), stands[i].end()), stands[i].end());
      groups[stands[i]].push_back(i);
    }
    in_order.reserve(groups.size());
    for (const auto& group : groups) in_order.push_back(group.second);
    std::ranges::sort(in_order);
    for (const auto& group : in_order) {
      if (group.size() != dimension) return false;
      Planetary::Body& body = found_.bodies.emplace_back();
      for (const std::size_t i : group) {  // axes are ordered as those of the first body
        std::size_t k = 0;
        while (k < dimension && root(in_order.front()[k]) != root(i)) ++k;
        if (k == dimension || body.coordinates[k] != Planetary::no_axis) return false;
        body.coordinates[k] = i;
      }
    }
    return true;
  }

  std::string objection_to_missing(const std::vector<bool>& seen) const {
    const auto missing = std::ranges::find(seen, false);
    if (missing == seen.end()) return {};
    return name(static_cast<int>(missing - seen.begin())) + " stands in no term −k/r";
  }

  /// take_pairs reads the attraction of each pair of bodies. False where a term is none.
  bool take_pairs() {
    // By coordinate: its body, and which axis of the body it is
    std::vector<std::pair<std::size_t, std::size_t>> place(n_);
    for (std::size_t b = 0; b < found_.bodies.size(); ++b)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::size_t i = found_.bodies[b].coordinates[k]; i != Planetary::no_axis) place[i] = {b, k};
    std::map<std::pair<std::size_t, std::size_t>, double> pairs;
    for (const Attraction& term : attractions_) {
      if (term.is_fixed()) continue;
      std::optional<std::pair<std::size_t, std::size_t>> pair;
      std::size_t axes = 0;
      for (const auto& [i, j] : term.axes) {
        const auto [a, k] = place[static_cast<std::size_t>(i)];
        const auto [b, l] = place[static_cast<std::size_t>(j)];
        const std::pair here = std::minmax(a, b);
        if (a == b || k != l || (pair && *pair != std::pair<std::size_t, std::size_t>(here))) return false;
        pair = here;
        axes |= std::size_t(1) << k;
      }
      const bool plane = found_.bodies[pair->first].coordinates[2] == Planetary::no_axis;
      if (axes != (plane ? 3 : 7)) return false;
      pairs[*pair] += term.strength;
    }
    found_.pairs.reserve(pairs.size());
    for (const auto& [pair, strength] : pairs) found_.pairs.push_back({pair.first, pair.second, strength});
    return true;
  }

  /// take_centre moves the heaviest of the bodies that attract all others to the front.
  std::string take_centre() {
    auto& bodies = found_.bodies;
    std::vector<std::size_t> pulls(bodies.size());
    for (const Planetary::Pair& pair : found_.pairs)
      if (pair.strength != 0) ++pulls[pair.a], ++pulls[pair.b];
    std::optional<std::size_t> centre;
    const auto mass = [&](std::size_t b) { return masses_[bodies[b].coordinates[0]]; };
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (pulls[b] + 1 == bodies.size() && (!centre || mass(b) > mass(*centre))) centre = b;
    if (!centre) return "no body has a term −k/r with each of the others";
    for (std::size_t b = 0; b < bodies.size() && bodies.size() > 2; ++b)
      if (b != *centre && !(mass(b) < mass(*centre))) return "no body is heavier than all others";
    found_.about_body = true;
    const auto renamed = [&](std::size_t b) { return b == *centre ? 0 : b < *centre ? b + 1 : b; };
    std::rotate(bodies.begin(), bodies.begin() + static_cast<std::ptrdiff_t>(*centre),
                bodies.begin() + static_cast<std::ptrdiff_t>(*centre) + 1);
    std::vector<Planetary::Pair> light;
    for (Planetary::Pair pair : found_.pairs) {
      pair = {renamed(pair.a), renamed(pair.b), pair.strength};
      if (pair.a > pair.b) std::swap(pair.a, pair.b);
      if (pair.a == 0) {
        bodies[pair.b].strength = pair.strength;
      } else if (pair.strength != 0) {
        light.push_back(pair);
      }
    }
    found_.pairs = std::move(light);
    return {};
  }

  std::string objection_to_masses() {
    for (Planetary::Body& body : found_.bodies) {
      body.mass = masses_[body.coordinates[0]];
      for (const std::size_t i : body.coordinates)
        if (i != Planetary::no_axis && !(masses_[i] == body.mass))
          return "the masses of " + names_[body.coordinates[0]] + " and " + names_[i] + ", which are one body, differ";
    }
    return {};
  }

  void write_rest() {
    if (rest_.empty()) return;
    Symbol sum = 0;
    for (const auto& [i, factor] : rest_) sum = sum + Symbol(factor) * Symbol::at(tape_, i);
    std::vector<int> variables(n_);
    std::iota(variables.begin(), variables.end(), 0);
    std::vector<Index> places;
    places.reserve(n_);
    for (const Symbol& slope : tape::gradient(tape_, sum, variables)) places.push_back(slope.on(tape_));
    found_.rest = tape::Formula(tape_, places);
  }

  std::span<const std::string> names_;
  std::size_t n_;
  tape::Tape tape_;
  Symbol potential_;
  std::vector<double> masses_;  ///< by coordinate
  std::vector<Attraction> attractions_;
  std::vector<std::pair<Index, double>> rest_;  ///< terms, and the factor of each
  Planetary found_;
};

}  // namespace

std::variant<Planetary, NotPlanetary> planetary(const Form& form, std::span<const double> parameters,
                                                std::span<const std::string> names) {
  if (form.kind != FormKind::separable) return NotPlanetary{"H is not Σ p²/2m + V(q, t)"};
  if (form.forced) return NotPlanetary{"forces stand beside it"};
  if (form.full_mass) return NotPlanetary{"its kinetic energy is not Σ p²/2m"};
  try {
    return Finder(form, parameters, names).find();
  } catch (const tape::TooManyOperations&) {
    return NotPlanetary{"V takes too many operations"};
  }
}

}  // namespace least::text

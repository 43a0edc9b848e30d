// What a problem of the catalogue that goes backward in time (core/catalogue/backward.hpp) takes from the forward
// problem: its domain, quantities, orbital elements, its estimate of the local frequency, and the energy of a flow,
// evaluated at the corresponding states of the forward motion.
#pragma once

#include <memory>

#include "core/run/backend.hpp"
#include "core/run/problem_table.hpp"
#include "core/text/scene.hpp"

namespace least {

class ForwardTable {
 public:
  /// The table of a scene that goes backward; null if it goes forward, or if it was given as text, which needs none.
  static std::shared_ptr<const ForwardTable> of(const text::TextScene& scene);

  /// Adds the properties of the forward problem to those of the backward scene.
  void add_to(ProblemTraits& traits) const;

  double gravitational_parameter() const { return table().gravitational_parameter(); }
  /// Returns f(table of the forward problem, x of the forward motion); x is given as the backward motion has it.
  template <class F>
  auto at(StateView x, const F& f) const {
    const RunState turned_state = turned(x);
    return f(table(), StateView{turned_state.t, turned_state.numbers.data()});
  }

 private:
  explicit ForwardTable(const text::TextScene& scene);
  const ProblemTable& table() const { return backend_->motion(); }
  RunState turned(StateView x) const;

  std::unique_ptr<const RunBackend> backend_;
  /// Index of the first component that has the opposite sign in the forward motion, as all later ones have.
  std::size_t turning_ = 0;
};

}  // namespace least

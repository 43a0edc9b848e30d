// What is known of a problem of the catalogue that goes backward in time (core/catalogue/backward.hpp) by the problem
// that goes forward: its domain, its quantities, its orbital elements, and the energy of a flow, at states turned to
// those of the forward motion.
#pragma once

#include <memory>

#include "core/run/backend.hpp"
#include "core/run/problem_table.hpp"
#include "core/text/scene.hpp"

namespace least {

class ForwardTable {
 public:
  /// Of a scene that goes backward; null where it goes forward, or is a text, which says all that there is.
  static std::shared_ptr<const ForwardTable> of(const text::TextScene& scene);

  /// Adds to what is known of the scene that goes backward.
  void add_to(ProblemTraits& traits) const;

  double gravitational_parameter() const { return table().gravitational_parameter(); }
  /// f(table of the forward problem, x turned); x as the motion backward has it.
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
  std::size_t turning_ = 0;  ///< the first component that is the opposite of the forward one; all after it are, too
};

}  // namespace least

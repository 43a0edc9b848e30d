// What a run asks of a scene by a scheme that is found in its text: steps of equal length on components that stand one
// after the other, and the derivatives of such steps by dual numbers.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/catalogue/sized_backend.hpp"
#include "core/catalogue/sized_steps.hpp"
#include "core/catalogue/sized_tangents.hpp"
#include "core/from_values.hpp"
#include "core/run/request.hpp"
#include "core/text/scene.hpp"

namespace least {

/// A scene with these parameters as its class holds it: with the places that it has room for.
struct SceneWithRoom {
  SceneWithRoom(const text::TextScene& scene, std::span<const double> parameters)
      : known(scene.form->coordinates), room(static_cast<std::size_t>(scene.capacity)) {
    text::Form with_room = *scene.form;
    with_room.coordinates = room;
    if (scene.form->kind == text::FormKind::flow) with_room.rates.resize(room);  // the others rest
    if (scene.form->full_mass) {
      with_room.hessian = text::SymbolMatrix(room);
      for (std::size_t i = 0; i < room; ++i) {
        if (i < known)
          with_room.hessian.row(i) = scene.form->hessian.row(i);
        else
          with_room.hessian.row(i).push_back({i, Symbol(1)});
      }
    }
    // A class of general Hamiltonians has a place for s, whether the motion reads it or not.
    const bool resting_action =
        scene.form->kind == text::FormKind::hamiltonian && scene.form->is_compiled() && !scene.form->reads_action;
    sized = std::make_shared<const text::SizedScene>(with_room, parameters, resting_action);
  }
  bool has_component(std::size_t i) const {
    if (sized->flow) return i < known;
    return i < 2 * room ? i % room < known : sized->acting;
  }

  std::size_t known, room;  ///< coordinates, and those that there is room for
  std::shared_ptr<const text::SizedScene> sized;
};

/// F is a scene with what is found in its text:
///   F::Scheme, F::Stepper<T>             a value with begin(x, t), step(x, t, h) and work(), in double and in Slope;
///                                        begin(x, t, start) where steps depend on where their run began
///   scene                                SceneWithRoom
///   objection(scheme)                    in words; empty: none
///   stepper<T>(scheme)                   where there is none
template <class F>
class FoundBackend final : public SizedBackend {
 public:
  using Scheme = typename F::Scheme;

  explicit FoundBackend(std::shared_ptr<const F> found) : SizedBackend(found->scene.sized), found_(std::move(found)) {}

  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid, double) const override {
    return std::make_unique<SizedSteps<Steps>>(table(), Steps(*found_, scheme_of(request)), x, grid);
  }
  bool has_component(std::size_t i) const override { return found_->scene.has_component(i); }

  StepTangents tangents(const Request& request) const override {
    const Scheme scheme = scheme_of(request);
    if (!found_->objection(scheme).empty()) return {};
    const TangentSpace space{found_->scene.room, table().traits.components};
    return tangents_by(request, space, scheme.step, found_->template stepper<Slope>(scheme));
  }

 private:
  /// The stepper as steps of equal length want it. With an objection it takes no step.
  class Steps {
   public:
    Steps(const F& found, const Scheme& scheme) : why_(found.objection(scheme)) {
      if (why_.empty()) stepper_.emplace(found.template stepper<double>(scheme));
    }
    void begin(const double* x, double t) {
      if (stepper_) stepper_->begin(x, t);
    }
    StepStatus step(double* x, double t, double h) noexcept {
      return stepper_ ? stepper_->step(x, t, h) : StepStatus::singular;
    }
    Work work() const { return stepper_ ? stepper_->work() : Work(); }
    double flips_from() const { return std::numeric_limits<double>::infinity(); }
    std::string unsupported_reason() const {
      return why_.empty() ? why_ : Scheme::card().id + " does not run this scene with these parameters: " + why_;
    }

   private:
    std::optional<typename F::template Stepper<double>> stepper_;
    std::string why_;
  };

  static Scheme scheme_of(const Request& request) { return from_values<Scheme>(Scheme::fields, request.settings); }

  std::shared_ptr<const F> found_;
};

}  // namespace least

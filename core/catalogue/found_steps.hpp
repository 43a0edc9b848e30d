// The steps of a scheme that was found in a scene: of equal length, on components in one contiguous list, and their
// derivatives by dual numbers.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/catalogue/found_schemes.hpp"
#include "core/catalogue/sized_steps.hpp"
#include "core/catalogue/sized_tangents.hpp"
#include "core/from_values.hpp"
#include "core/run/request.hpp"

namespace least {

/// FoundOrNot holds the structure that was searched, or the reason in words why there is none.
template <class What>
class FoundOrNot : public Found {
 public:
  template <class Why>
  explicit FoundOrNot(std::variant<What, Why> looked) {
    if (auto* none = std::get_if<Why>(&looked)) {
      if constexpr (std::is_same_v<Why, std::string>) why_ = std::move(*none);
      if constexpr (!std::is_same_v<Why, std::string>) why_ = std::move(none->why);
    } else {
      what_ = std::make_shared<const What>(std::get<What>(std::move(looked)));
    }
  }
  std::string objection() const override { return why_; }

 protected:
  const std::shared_ptr<const What>& what() const { return what_; }  ///< null if there is none

 private:
  std::shared_ptr<const What> what_;
  std::string why_;
};

/// FoundSteps is Found for a scheme that is described by F:
///   F::Scheme, F::What         the scheme, and the structure that it needs
///   look(scene, parameters)    a variant of F::What and the reason why it is missing: a text, or a struct with `why`
///   F::Stepper<T>              made of (what, scheme, room), or of (what, scheme): a value with begin(x, t),
///                              step(x, t, h) and work(), in double and in Slope; begin(x, t, start) if steps depend on
///                              the start of their run. `room` is the number of coordinates that a state has places for
///   objection(what, scheme)    optional: objection to settings of the scheme, in words; empty: none
///   describe(what, card)       optional: adds to the card of the scene
///   vary(form, parameters, i)  optional: as `look`, with parameter i as a variable after those of the state
template <class F>
class FoundSteps final : public FoundOrNot<typename F::What> {
 public:
  using Scheme = typename F::Scheme;

  FoundSteps(const text::TextScene& scene, std::span<const double> parameters)
      : FoundOrNot<typename F::What>(F::look(scene, parameters)) {}

  void describe([[maybe_unused]] ProblemCard& card) const override {
    if constexpr (requires { F::describe(*this->what(), card); }) F::describe(*this->what(), card);
  }
  std::unique_ptr<Integrator> bind(const RunBackend& problem, const Request& request, const RunState& x,
                                   const Grid& grid, double) const override {
    return std::make_unique<SizedSteps<Steps>>(problem.table(), Steps(*this, scheme_of(request), problem), x, grid);
  }

  StepTangents tangents(const RunBackend& problem, const Request& request) const override {
    const Scheme scheme = scheme_of(request);
    if (!objection_to(scheme).empty()) return {};
    const ProblemTraits& traits = problem.table().traits;
    return tangents_by(request, {traits.dof, traits.components}, scheme.step, stepper_of<Slope>(scheme, traits.dof));
  }

  bool has_slopes(bool by_parameter) const override { return !by_parameter || varies; }
  std::unique_ptr<SlopedSteps> with_slopes(const Request& request, std::size_t room,
                                           const Found::Moved* moved) const override {
    class Sloped final : public SlopedSteps {
     public:
      explicit Sloped(typename F::template Stepper<Slope> stepper) : stepper_(std::move(stepper)) {}
      void begin(const Slope* x, double t) override { stepper_.begin(x, t); }
      StepStatus step(Slope* x, double t, double h) override { return stepper_.step(x, t, h); }

     private:
      typename F::template Stepper<Slope> stepper_;
    };
    std::shared_ptr<const typename F::What> what = this->what();
    if constexpr (varies)
      if (moved)
        what = std::make_shared<const typename F::What>(
            std::get<typename F::What>(F::vary(moved->form, moved->parameters, moved->which)));
    return std::make_unique<Sloped>(stepper_on<Slope>(what, scheme_of(request), room));
  }

 private:
  /// Steps is the stepper in the form that SizedSteps needs, in numbers, or in dual numbers if the run carries a
  /// tangent direction. With an objection it takes no step.
  class Steps {
   public:
    Steps(const FoundSteps& found, const Scheme& scheme, const RunBackend& problem) : why_(found.objection_to(scheme)) {
      if (!why_.empty()) return;
      const ProblemTraits& traits = problem.table().traits;
      if (traits.sloped) {
        sloped_.emplace(found.template stepper_of<Slope>(scheme, traits.dof));
        moved_.resize(traits.components);
      } else {
        plain_.emplace(found.template stepper_of<double>(scheme, traits.dof));
      }
    }
    void begin(const double* x, double t) {
      if (plain_) plain_->begin(x, t);
      if (!sloped_) return;
      take(x);
      sloped_->begin(moved_.data(), t);
    }
    StepStatus step(double* x, double t, double h) noexcept {
      if (plain_) return plain_->step(x, t, h);
      if (!sloped_) return StepStatus::singular;
      take(x);
      const StepStatus status = sloped_->step(moved_.data(), t, h);
      normalise(moved_, moved_.size());
      for (std::size_t i = 0; i < moved_.size(); ++i) {
        x[i] = moved_[i].value;
        x[moved_.size() + i] = moved_[i].slope[0];
      }
      return status;
    }
    Work work() const { return plain_ ? plain_->work() : sloped_ ? sloped_->work() : Work(); }
    double flips_from() const { return std::numeric_limits<double>::infinity(); }
    std::string unsupported_reason() const {
      return why_.empty() ? why_ : Scheme::card().id + " does not run this scene with these parameters: " + why_;
    }

   private:
    void take(const double* x) noexcept {
      for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i] = {x[i], {x[moved_.size() + i]}};
    }

    std::optional<typename F::template Stepper<double>> plain_;
    std::optional<typename F::template Stepper<Slope>> sloped_;
    std::vector<Slope> moved_;
    std::string why_;
  };

  static constexpr bool varies = requires(const text::Form& form, std::span<const double> parameters) {
    F::vary(form, parameters, std::size_t(0));
  };

  static Scheme scheme_of(const Request& request) { return from_values<Scheme>(Scheme::fields, request.settings); }
  std::string objection_to([[maybe_unused]] const Scheme& scheme) const {
    if constexpr (requires { F::objection(*this->what(), scheme); })
      if (this->what()) return F::objection(*this->what(), scheme);
    return this->objection();
  }
  template <class T>
  auto stepper_of(const Scheme& scheme, std::size_t room) const {
    return stepper_on<T>(this->what(), scheme, room);
  }
  template <class T>
  static auto stepper_on(const std::shared_ptr<const typename F::What>& what, const Scheme& scheme,
                         [[maybe_unused]] std::size_t room) {
    using Stepper = typename F::template Stepper<T>;
    if constexpr (requires { Stepper(what, scheme, room); }) return Stepper(what, scheme, room);
    if constexpr (!requires { Stepper(what, scheme, room); }) return Stepper(what, scheme);
  }
};

/// look_for is FoundScheme::look for the scheme of F.
template <class F>
std::shared_ptr<const Found> look_for(const text::TextScene& scene, std::span<const double> parameters) {
  return std::make_shared<const FoundSteps<F>>(scene, parameters);
}

}  // namespace least

// Kinetic energies of both signs, and the digits of constants in a text.
#include <gtest/gtest.h>

#include <cmath>

#include "core/text/expression.hpp"
#include "core/text/scene.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace texts;

/// A kinetic energy of both signs is regular: two oscillators, one of which has a negative energy.
TEST(IndefiniteKineticEnergy, MovesByWhatNeedsRegularityAlone) {
  for (const auto& definition : {of(Definition::Kind::lagrangian, {"x", "y"}, {}, "(vx^2 - vy^2)/2 - (x^2 - 4*y^2)/2"),
                                 of(Definition::Kind::hamiltonian, {"x", "y"}, {}, "(px^2 - py^2)/2 + (x^2 - 4*y^2)/2"),
                                 of(Definition::Kind::lagrangian, {"x", "y"}, {},
                                    "(vx^2 - vy^2)/2 + 2*vx*vy + 3*vy^2 - 3*vy^2 - 2*vx*vy - (x^2 - 4*y^2)/2")}) {
    const auto mechanics = mechanics_of(definition);
    EXPECT_EQ(mechanics->text()->form->kind, text::FormKind::hamiltonian);
    EXPECT_TRUE(mechanics->text()->form->keeps_energy);
    for (const char* scheme : {"contact_gauss", "runge_kutta_4", "taylor"}) {
      Request request = typed_as(runs::defaults("henon_heiles", scheme), mechanics);
      auto& initial = runs::scene(request).initial;
      std::ranges::fill(initial, 0);
      initial[0] = initial[1] = 1;
      request.end = 3;
      runs::only_final(request);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << outcome.stop.detail;
      const auto& end = outcome.final;
      EXPECT_NEAR(end[0], std::cos(3), 1e-5) << scheme;
      EXPECT_NEAR(end[1], std::cos(6), 1e-5) << scheme;
    }
    const auto& schemes = mechanics->card().schemes;
    EXPECT_EQ(std::ranges::find(schemes, find_scheme("leapfrog").value()), schemes.end());
  }
  // A metric that is not diagonal, and one whose signs depend on parameters.
  const auto kind = [](const char* text) {
    return mechanics_of(of(Definition::Kind::lagrangian, {"x", "y"}, {{"m", 1}}, text))->text()->form->kind;
  };
  EXPECT_EQ(kind("vx^2/2 + 2*vx*vy + vy^2/2 - x^2"), text::FormKind::hamiltonian);
  EXPECT_EQ(kind("vx^2 + vx*vy + vy^2 - x^2"), text::FormKind::separable);
  EXPECT_EQ(kind("vx^2 + x*vx*vy + vy^2 - x^2"), text::FormKind::metric);
  EXPECT_EQ(kind("(vx^2 - m*vy^2)/2 - x^2"), text::FormKind::separable);
}

/// Constants that are not exact doubles have the digits of two doubles.
TEST(ConstantsOfATextOnItsTape, HaveTwiceTheDigitsOfADouble) {
  const struct {
    const char* text;
    double low;  ///< the value less the nearest double
  } rows[] = {{"1/3", 1.8503717077085942e-17}, {"2/3", 3.7007434154171884e-17}};
  for (const auto& [text, low] : rows) {
    tape::Tape tape;
    const auto parsed = std::get<text::Expression>(text::Expression::parse(text));
    const auto made = std::get<Symbol>(parsed.record(tape, {}));
    EXPECT_NEAR(tape[made.on(tape)].low / low, 1, 1e-12) << text;
  }
}

}  // namespace

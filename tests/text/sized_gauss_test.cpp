// contact_gauss on damped scenes of many coordinates: its order, closed forms of linear chains, the contact form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/catalogue/backward.hpp"
#include "tests/support/sized.hpp"

namespace sized_gauss {
namespace {

using namespace sized;
using std::numbers::pi;

/// Bodies on a ring, each bound to its neighbours and to its own place, with a drive.
std::shared_ptr<const Mechanics> ring(int n, const char* damping, bool coupled = false) {
  text::TypedScene typed;
  const std::string potential = "sum(i=1..n, exp(q[i] - q[mod(i,n)+1]) + q[i]^4/8) + q[1]*sin(t)/5";
  typed.scene = of(Definition::Kind::potential, {"q[n]"}, {{"n", double(n)}, {"alpha", 0.3}}, potential);
  typed.scene.damping = damping;
  if (coupled) {
    typed.scene.kind = Definition::Kind::lagrangian;
    typed.scene.formula =
        "sum(i=1..n, v[i]^2/2) + sum(i=1..n-1, v[i]*v[i+1])/3 - (" + potential + ") - " + damping + "*s";
    typed.scene.damping.reset();
  } else {
    typed.scene.masses = {{"q[i]", "1 + i/n"}};
  }
  return made(typed);
}
/// start_of() returns q, p and s.
std::vector<double> start_of(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.5 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.4 * std::cos(3 * i));
  x.push_back(0.3);
  return x;
}
Request gauss(const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& start, double end,
              double step, int stages) {
  Request request = stepped("contact_gauss", mechanics, start, end, step);
  runs::set(request, "stages", stages);
  runs::show_all(request);
  return request;
}

TEST(SizedGauss, HasTwiceAsHighAnOrderAsStages) {
  for (const auto& [n, coupled] : {std::pair{24, false}, std::pair{9, true}}) {
    const auto mechanics = ring(n, "alpha*(1 + sin(t)/2)", coupled);
    Request exact = request_by("taylor", mechanics, start_of(n), 4);
    runs::show_all(exact);
    const auto truth = final_of(exact);
    ASSERT_EQ(truth.size(), std::size_t(2 * n + 1)) << "with s";
    for (const int stages : {1, 2, 3}) {
      const double step = 0.05 * (1 << stages);
      const auto error = [&](double h) {
        return distance(final_of(gauss(mechanics, start_of(n), 4, h, stages)), truth);
      };
      const double coarse = error(step), middle = error(step / 2), fine = error(step / 4);
      EXPECT_NEAR(std::log2(coarse / middle), 2 * stages, 0.5) << stages << coupled;
      EXPECT_NEAR(std::log2(middle / fine), 2 * stages, 0.2) << stages << coupled;
      EXPECT_GT(fine, 1e-12) << stages << " is at round-off";
    }
  }
}

// Each mode of a harmonic chain is multiplied by the diagonal Padé approximation of e^{iωh}, however long the step is.
TEST(SizedGauss, LongStepsOfAChainAreThePadeApproximation) {
  constexpr int n = 200, k = 190;
  const double omega = 2 * std::sin(k * pi / (2 * (n + 1))), h = 3, steps = 7, z = omega * h;
  ASSERT_GT(z, 5);
  text::TypedScene typed;
  typed.scene =
      of(Definition::Kind::potential, {"q[n]"}, {{"n", n}, {"alpha", 0}}, "sum(i=0..n, (at(i+1) - at(i))^2/2)");
  typed.scene.damping = "alpha";
  typed.definitions = {{"at(i)", "if(i < 1 or i > n, 0, q[i])"}};
  std::vector<double> start;
  for (int j = 1; j <= n; ++j) start.push_back(std::sin(j * k * pi / (n + 1)));
  const double halves[] = {std::atan2(z / 2, 1), std::atan2(z / 2, 1 - z * z / 12),
                           std::atan2(z / 2 - z * z * z / 120, 1 - z * z / 10)};
  for (int stages = 1; stages <= 3; ++stages) {
    const double angle = 2 * halves[stages - 1] * steps;
    const auto last = final_of(gauss(made(typed), start, steps * h, h, stages));
    for (std::size_t j = 0; j < n; ++j) {
      EXPECT_NEAR(last[j], std::cos(angle) * start[j], 1e-11) << stages << " " << j;
      EXPECT_NEAR(last[n + j], -omega * std::sin(angle) * start[j], 1e-11) << stages << " " << j;
    }
  }
}

TEST(SizedGauss, ThereAndBackIsWhereItBegan) {
  constexpr int n = 40;
  const auto mechanics = ring(n, "alpha*(1 + sin(t)/2)");
  const auto start = start_of(n);
  for (const int stages : {1, 2, 3}) {
    const auto there = final_of(gauss(mechanics, start, 6, 0.25, stages));
    EXPECT_GT(distance(there, start), 0.1);
    Request back = gauss(mechanics, there, 0, 0.25, stages);
    runs::scene(back).start = 6;
    back.scene = std::make_shared<const Scene>(std::get<Scene>(backward(*back.scene)));
    auto again = final_of(back);
    for (std::size_t i = n; i < again.size(); ++i) again[i] = -again[i];  // momenta and s of a scene that runs backward
    EXPECT_LT(distance(again, start), 1e-11) << stages;
  }
}

TEST(SizedGauss, KeepsTheContactForm) {
  for (const int n : {9, 50})
    for (const bool coupled : {false, true})
      for (const int stages : {1, 2, 3}) {
        Request request = gauss(ring(n, "alpha*(1 + sin(t)/2)", coupled), start_of(n), 1, 0.25, stages);
        runs::ask(request, "structure");
        const auto reports = runs::go(request).outcome.diagnostics;
        EXPECT_LT(runs::number(reports, "structure/max_defect"), 1e-12) << n << coupled << stages;
        EXPECT_LT(runs::number(reports, "structure/factor"), 0.99) << n << coupled << stages;
      }
}

// Where the damping is not resolved one stage reverses momenta, and λ = (2 − αh)/(2 + αh) has a pole at αh = −2.
TEST(SizedGauss, WarnsWhereTheDampingIsNotResolvedAndStopsAtItsPole) {
  Request request = gauss(ring(9, "alpha"), start_of(9), 10, 1, 1);
  runs::set(request, "alpha", 2.5);
  const auto warnings = runs::go(request).outcome.warnings;
  EXPECT_EQ(std::ranges::count(warnings, "damping_sign", [](const auto& w) { return w.code; }), 1);
  runs::set(request, "alpha", -2);
  EXPECT_EQ(runs::go(request).outcome.stop.reason, ReturnCode::singular);
}

}  // namespace
}  // namespace sized_gauss

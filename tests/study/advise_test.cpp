// Advice about the scheme to take, compared with an exhaustive search.
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/study/search.hpp"
#include "tests/study/studies.hpp"
#include "tests/support/processor_clock.hpp"

namespace {

using namespace studies;

/// spacing() returns the factor between the settings of an exhaustive search. LEAST_EXHAUSTIVE=1 makes the search
/// thorough, which takes minutes.
double spacing() {
  static const bool thorough = std::getenv("LEAST_EXHAUSTIVE") != nullptr;
  return thorough ? 1.1 : 1.3;
}

/// exhaustive() returns the fewest force evaluations, `most` at most, with which any candidate reaches the accuracy.
double exhaustive(const ErrorStudy& subject, const std::vector<SchemeConfig>& all, double accuracy, double most) {
  double fewest = most;
  for (const SchemeConfig& choice : all) {
    const ResolutionParameter dial = dial_of(choice);
    const double ratio = dial.adaptive() ? 2 * spacing() : spacing();
    double value = subject.longest(choice, dial);
    if (dial.name == "step") value = std::min(value, 50 * (subject.end() - subject.start()) / most);
    for (; value > 1e-15; value /= ratio) {
      const Trial trial = subject.run(dial.at(choice, value), 20, static_cast<std::int64_t>(most));
      const auto forces = static_cast<double>(trial.forces);
      if (trial.error <= accuracy) fewest = std::min(fewest, forces);
      if (forces >= fewest || trial.error <= accuracy || trial.status == ReturnCode::step_limit) break;
    }
  }
  return fewest;
}

void hold_against_all(std::string_view problem, std::initializer_list<double> accuracies, double end = 0) {
  Request request = scene(problem, end);
  request.norm = Norm::relative;
  const ErrorStudy subject(request, false, 20, never);
  for (const double accuracy : accuracies) {
    SCOPED_TRACE(std::string(problem) + " " + std::to_string(std::log10(accuracy)));
    if (accuracy < 3 * subject.floor()) continue;
    const Advice advice = advise(request, {accuracy, 0, {}}, never);
    ASSERT_TRUE(advice.choice) << advice.reason;
    EXPECT_TRUE(advice.met) << advice.reason;
    const Trial run = subject.run(*advice.choice, 20, 10'000'000);
    EXPECT_EQ(run.error, advice.estimated_error);
    EXPECT_LE(run.error, accuracy) << advice.reason;
    const auto cost = static_cast<double>(run.forces);
    EXPECT_LE(cost, 1.5 * exhaustive(subject, catalogue_candidates(*request.scene->mechanics, {}), accuracy, cost))
        << advice.reason;
  }
}

// For states far below 1 the accuracy is relative to their size, not to 1, in either norm.
TEST(Advice, IsOfTheDigitsOfSmallStates) {
  for (const Norm norm : {Norm::absolute, Norm::relative}) {
    Request request = scene("harmonic_oscillator", 20);
    runs::scene(request).initial = {1e-6, 0};
    request.norm = norm;
    const Advice advice = advise(request, {1e-6, 0, {}}, never);
    ASSERT_TRUE(advice.choice);
    EXPECT_TRUE(advice.met) << advice.reason;
    EXPECT_LE(advice.estimated_error, 1e-6);
    Request run = with(request, *advice.choice);
    runs::ask(run, "error");
    const double error = runs::number(runs::go(run).outcome.diagnostics, "error/max");
    EXPECT_LT(error, norm == Norm::relative ? 1.1e-6 : 1.1e-12);
  }
}

// The error that the advice names is the one that the run measures, where the error peaks.
TEST(Advice, EstimatesTheLargestErrorOfTheRun) {
  for (const double e : {0.9, 0.99}) {
    Request request = scene("kepler", 6.5 * 2 * std::acos(-1.0));
    request.norm = Norm::relative;
    runs::scene(request).initial = {1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))};
    for (const double accuracy : {1e-3, 1e-6}) {
      const Advice advice = advise(request, {accuracy, 0, {}}, never);
      ASSERT_TRUE(advice.choice) << advice.reason;
      Request run = with(request, *advice.choice);
      runs::ask(run, "error");
      runs::only_final(run);
      const double error = runs::number(runs::go(run).outcome.diagnostics, "error/max");
      EXPECT_NEAR(advice.estimated_error / error, 1, 0.1) << e << ' ' << advice.reason;
    }
  }
}

class Advised : public testing::TestWithParam<std::size_t> {};
TEST_P(Advised, MeetsTheAccuracyAtTheLeastCost) {
  const auto& card = runs::problem_cards()[GetParam()];
  // Chaotic, and beyond the reach of every scheme at its default end.
  const double end = card.id == "thermostat" ? 10 : 0;
  if (card.id == "double_pendulum" && spacing() > 1.2) return hold_against_all(card.id, {1e-3, 1e-6}, 10);
  hold_against_all(card.id, {1e-3, 1e-6, 1e-9}, end);
}
INSTANTIATE_TEST_SUITE_P(AllProblems, Advised, testing::Range<std::size_t>(0, runs::problem_cards().size()),
                         [](const auto& which) { return std::string(runs::problem_cards()[which.param].id); });

// The error of rough runs is that along the whole span, too.
TEST(Advice, IsMeasuredWhereLittleIsAskedFor) {
  hold_against_all("henon_heiles", {8e-3, 3e-2}, 40);
  hold_against_all("van_der_pol", {8e-3, 3e-2});
}

// With one step over the whole run all coarse tolerances make the same run: this is no sign that finer ones do not
// help.
TEST(Advice, LooksBeyondRunsThatAreTheSame) {
  for (const double accuracy : {1e-10, 1e-13}) {
    const Advice advice = advise(scene("harmonic_oscillator", 10), {accuracy, 0, {}}, never);
    ASSERT_TRUE(advice.choice);
    EXPECT_TRUE(advice.met) << advice.reason;
    EXPECT_EQ(schemes()[advice.choice->scheme].id, "taylor") << advice.reason;
    EXPECT_LE(runs::go(with(scene("harmonic_oscillator", 10), *advice.choice)).outcome.cost.force_evaluations, 100);
  }
}

std::string id(const SchemeConfig& choice) { return std::string(schemes()[choice.scheme].id); }

TEST(Advice, KeepsWhatIsToBeKept) {
  const Request pendulum = scene("double_pendulum", 5);
  const auto structure = [](const SchemeConfig& choice) { return schemes()[choice.scheme].structure; };
  EXPECT_EQ(structure(*advise(pendulum, {1e-4, 0, {}}, never).choice), "none") << "the cheapest of all keeps nothing";
  const Advice energy = advise(pendulum, {1e-4, 0, {.energy = true}}, never);
  EXPECT_EQ(structure(*energy.choice), "symplectic");
  for (const Alternative& other : energy.alternatives) EXPECT_EQ(structure(other.scheme), "symplectic");
  const auto ids = [](std::string_view problem, const Keep& keep) {
    std::string all;
    for (const SchemeConfig& choice : catalogue_candidates(*find_problem(problem), keep)) all += id(choice) + " ";
    return all;
  };
  const auto has = [](const std::string& all, std::string_view scheme) {
    return all.find(scheme) != std::string::npos;
  };
  EXPECT_TRUE(has(ids("kepler", {.energy = true}), "adaptive_verlet"));
  EXPECT_FALSE(has(ids("kepler", {.structure = true}), "adaptive_verlet"));
  for (const char* scheme : {"adaptive_verlet", "energy_momentum"}) {
    EXPECT_TRUE(has(ids("kepler", {.momenta = true}), scheme));
    EXPECT_FALSE(has(ids("kepler", {.structure = true}), scheme));
  }
  for (const Keep& keep : {Keep{.energy = true}, Keep{.structure = true}, Keep{.momenta = true}}) {
    EXPECT_FALSE(has(ids("kepler", keep), "jacobi_maupertuis"));
    EXPECT_FALSE(has(ids("kepler", keep), "runge_kutta_4"));
    EXPECT_TRUE(has(ids("kepler", keep), "time_transformed"));
    EXPECT_TRUE(has(ids("damped_oscillator", keep), "contact_gauss"));
    EXPECT_EQ(ids("lorenz", keep), "") << "a flow that is not mechanical has nothing of the kind";
  }
}

TEST(Advice, GivesReasonsAndAlternatives) {
  const Request kepler = scene("kepler");
  const Advice advice = advise(kepler, {1e-6, 0, {}}, never);
  EXPECT_EQ(id(*advice.choice), "time_transformed");
  EXPECT_NE(advice.reason.text().find("against the closed form"), std::string::npos) << advice.reason;
  EXPECT_NE(advice.reason.text().find(name(advice.alternatives.at(0).scheme)), std::string::npos) << advice.reason;
  std::int64_t last = 0;
  for (const Alternative& other : advice.alternatives) {
    EXPECT_GE(other.force_evaluations, last);
    last = other.force_evaluations;
    EXPECT_LE(other.estimated_error, 1e-6);
    const Request again = with(kepler, other.scheme);
    EXPECT_EQ(runs::go(again).outcome.cost.force_evaluations, last);
  }
  const Advice again = advise(kepler, {1e-6, 0, {}}, never);
  EXPECT_EQ(again.choice->settings[0], advice.choice->settings[0]);
  EXPECT_EQ(again.reason, advice.reason);
}

// The orders of a Taylor series count as one alternative.
TEST(Advice, TellsOneOfEverySchemeThatGoesByItsTolerance) {
  for (const char* problem : {"perturbed_kepler", "van_der_pol"})
    for (const bool timed : {false, true}) {
      const Advice advice = advise(scene(problem), timed ? Wish{std::nan(""), 3e-4, {}} : Wish{1e-6, 0, {}}, never);
      ASSERT_TRUE(advice.choice) << advice.reason;
      std::set<std::size_t> told{advice.choice->scheme};
      for (const Alternative& other : advice.alternatives) {
        const bool by_tolerance = dial_of(other.scheme).adaptive();
        EXPECT_TRUE(!by_tolerance || told.insert(other.scheme.scheme).second) << problem << ' ' << name(other.scheme);
      }
    }
}

// Eccentric orbits with drag, constant or not: the advice takes adaptive steps, whether contact maps are asked for or
// not.
TEST(Advice, TakesStepsThatFollowADampedMotion) {
  for (const std::string_view problem : {"damped_kepler", "perturbed_kepler"}) {
    Request orbit = scene(problem, 20);
    orbit.norm = Norm::relative;
    runs::scene(orbit).initial = {0.1, 0, 0, std::sqrt(19.0)};
    for (const Keep& keep : {Keep{}, Keep{.structure = true}}) {
      const Advice advice = advise(orbit, {1e-8, 0, keep}, never);
      ASSERT_TRUE(advice.choice) << problem;
      EXPECT_TRUE(advice.met) << advice.reason;
      const bool follows =
          id(*advice.choice) == "time_transformed" || (!keep.structure && id(*advice.choice) == "taylor");
      EXPECT_TRUE(follows) << advice.reason;
      Request run = with(orbit, *advice.choice);
      runs::ask(run, "error");
      runs::only_final(run);
      const double error = runs::number(runs::go(run).outcome.diagnostics, "error/max");
      EXPECT_NEAR(advice.estimated_error / error, 1, 0.1) << advice.reason;
    }
    // The best scheme of equal steps is far behind.
    std::int64_t equal = 0;
    const ErrorStudy subject(orbit, false, 20, never);
    SchemeConfig splitting = choice(orbit, "contact_splitting", "kahan_li_8");
    const ResolutionParameter dial = dial_of(splitting);
    for (double step = 0.1; step > 1e-5 && equal == 0; step /= 1.3) {
      const Trial trial = subject.run(dial.at(splitting, step), 20, 10'000'000);
      if (trial.error <= 1e-8) equal = trial.forces;
    }
    const Trial chosen = subject.run(*advise(orbit, {1e-8, 0, {}}, never).choice, 20, 10'000'000);
    EXPECT_GT(equal, 4 * chosen.forces) << problem;
  }
}

TEST(Advice, SaysWhatKeepsItFromTheAccuracy) {
  const Advice rounded = advise(scene("henon_heiles", 20), {1e-17, 0, {}}, never);
  EXPECT_FALSE(rounded.met);
  EXPECT_LT(rounded.estimated_error, 1e-13);
  EXPECT_NE(rounded.reason.text().find("nothing reaches"), std::string::npos) << rounded.reason;
  Request chaos = scene("lorenz", 35);
  const Advice conditioned = advise(chaos, {1e-9, 0, {}}, never);
  EXPECT_FALSE(conditioned.met);
  EXPECT_NE(conditioned.reason.text().find("exponentially"), std::string::npos) << conditioned.reason;
  std::atomic<bool> gone{true};
  EXPECT_FALSE(advise(chaos, {1e-3, 0, {}}, gone).choice);
  // A stiff motion: every stable step is accurate.
  Request stiff = scene("damped_oscillator");
  runs::set(stiff, "damping", 1000);
  const Advice easy = advise(stiff, {1e-3, 0, {}}, never);
  EXPECT_TRUE(easy.met) << easy.reason;
  EXPECT_NE(id(*easy.choice), "runge_kutta_4");
}

// A run that is near the true solution at the end of a long chaotic motion is so by chance, as is a single step that
// ends at rest.
TEST(Advice, IsRightForAsLongAsAChaoticMotionCanBeKnown) {
  const ErrorStudy knowable(scene("lorenz", 15), false, 20, never);
  const Wish within{std::nan(""), 0.05, {}};
  for (const auto& [end, wish] :
       {std::pair(60.0, Wish{1e-6, 0, {}}), std::pair(5000.0, Wish{1e-6, 0, {}}), std::pair(60.0, within)}) {
    const Advice advice = advise(scene("lorenz", end), wish, never);
    ASSERT_TRUE(advice.choice) << advice.reason;
    EXPECT_LT(knowable.run(*advice.choice, 20, 10'000'000).error, 1e-6) << advice.reason;
    EXPECT_EQ(advice.met, std::isnan(wish.accuracy));
    EXPECT_TRUE(std::isnan(advice.estimated_error)) << "nothing can be known of the end";
    EXPECT_NE(advice.reason.text().find("exponentially; up to t = "), std::string::npos) << advice.reason;
    EXPECT_TRUE(advice.alternatives.empty());
  }
}

// Errors that have grown as large as the motion do not depend on the step; those at earlier times do.
TEST(Advice, ForeseesErrorsInChaos) {
  const auto trial_of = [](double tolerance) {
    const ErrorStudy subject(scene("thermostat"), false, 20, never);
    const SchemeConfig taylor = choice(scene("thermostat"), "taylor");
    const SchemeConfig turned = dial_of(taylor).at(taylor, tolerance);
    EXPECT_LT(subject.run(turned, 20, 10'000'000).error, 10) << "none is larger than what moves";
    return subject.look(turned, 20, 10'000'000, 1e-9);
  };
  const Trial coarse = trial_of(1e-6), fine = trial_of(1e-8), known = trial_of(1e-12);
  EXPECT_TRUE(coarse.foreseen && fine.foreseen && !known.foreseen);
  EXPECT_NEAR(std::log10(coarse.error / fine.error), 2, 1);
  EXPECT_NEAR(std::log10(fine.error / known.error), 4, 2);
}

TEST(Advice, FindsTheBestWithinATime) {
  const runs::ProcessorClock clock;
  const Request heiles = scene("henon_heiles");
  const Advice quick = advise(heiles, {std::nan(""), 1e-4, {}}, never),
               slow = advise(heiles, {std::nan(""), 1e-2, {}}, never);
  ASSERT_TRUE(quick.choice && slow.choice);
  EXPECT_GT(quick.estimated_error, slow.estimated_error) << quick.reason << slow.reason;
  EXPECT_LT(slow.estimated_error, 1e-8) << slow.reason;
  const ErrorStudy subject(heiles, false, 20, never);
  EXPECT_LT(subject.time(*slow.choice, 1, 100'000'000), 2 * 1e-2);
  EXPECT_FALSE(advise(heiles, {std::nan(""), 1e-9, {}}, never).choice);
}

// The trial runs of a search make the same steps as any run, without warnings and records.
TEST(Advice, ProbesMoveAsRunsDo) {
  Request loud = with(scene("damped_kepler", 20), choice(scene("damped_kepler"), "contact_leapfrog"));
  runs::set(loud, "step", 0.04);
  Request quiet = loud;
  quiet.probe = true;
  const auto run = runs::go(loud).outcome, probe = runs::go(quiet).outcome;
  EXPECT_EQ(run.stop.reason, ReturnCode::completed) << run.stop.detail;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(run.final[i], probe.final[i]);
  EXPECT_EQ(run.cost.force_evaluations, probe.cost.force_evaluations);
  EXPECT_FALSE(run.warnings.empty());
  EXPECT_TRUE(probe.warnings.empty());
}

// Where there is no reference, a run is compared with one of half the step.
TEST(Advice, DoesWithoutAReference) {
  const Request heiles = scene("henon_heiles", 30);
  const ErrorStudy blind(heiles, false, 0, never), seeing(heiles, false, 20, never);
  ASSERT_FALSE(blind.known());
  ASSERT_TRUE(seeing.known());
  const SchemeConfig leapfrog = choice(heiles, "leapfrog", "suzuki_4");
  const Trial guessed = blind.run(leapfrog, 20, 1'000'000), measured = seeing.run(leapfrog, 20, 1'000'000);
  EXPECT_EQ(guessed.forces, measured.forces);
  EXPECT_NEAR(guessed.error, measured.error, 0.2 * measured.error);
}

TEST(Advice, EndsInTime) {
  Request relaxation = scene("van_der_pol", 3500);
  runs::set(relaxation, "epsilon", 1000);
  relaxation.limits.seconds = 0.5;
  const runs::TurnedClock clock(1e-3);
  const Advice advice = advise(relaxation, {1e-6, 0, {}}, never);
  EXPECT_LE(clock.now(), 0.3) << "the rest is for the run";
  EXPECT_TRUE(advice.choice);
  EXPECT_FALSE(advice.known && advice.met) << advice.reason;
  EXPECT_FALSE(advice.reason.empty());
}

// Where the next setting equals the last one, or differs only by rounding, the search ends: it would go on for ever.
TEST(Search, NeverRepeatsARun) {
  const Request oscillator = scene("harmonic_oscillator", 20);
  const ErrorStudy subject(oscillator, false, 20, never);
  Search search(subject, choice(oscillator, "leapfrog"), 1e-12);
  while (!search.bad() || search.least_cost() < 100)
    search.advance(1, 1'000'000, std::numeric_limits<double>::infinity());
  const double value = search.bad()->value, cost = search.least_cost();
  search.advance(1, 1'000'000, std::nextafter(cost, 2 * cost));
  EXPECT_TRUE(search.over());
  EXPECT_EQ(search.bad()->value, value);
  Search other(subject, choice(oscillator, "leapfrog"), 1e-12);
  while (!other.bad() || other.least_cost() < 100) other.advance(1, 1'000'000, std::numeric_limits<double>::infinity());
  other.advance(1, 1'000'000, 1.5 * cost);
  EXPECT_FALSE(other.over());
  EXPECT_LT(other.bad()->value, value);
}

// A first run that is accurate enough is not the last: coarser runs are cheaper.
TEST(Search, GoesBackFromAFineRunToCoarserOnes) {
  const Request orbit = scene("kepler", 20);
  const ErrorStudy subject(orbit, false, 20, never);
  Search search(subject, choice(orbit, "taylor"), 1e-6);
  search.begin_at(1e-12, 1, 1'000'000);
  ASSERT_TRUE(search.good());
  const auto first = search.good()->trial.forces;
  for (int i = 0; i < 20 && !search.over(); ++i) search.advance(1, 1'000'000, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(search.over());
  EXPECT_LT(search.good()->trial.forces, first);
  EXPECT_LE(search.good()->trial.error, 1e-6);
  EXPECT_GT(search.good()->trial.error, 1e-8);
}

}  // namespace

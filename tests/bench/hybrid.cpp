// Tables of RESULTS.md: the Jacobi–Maupertuis hybrid beside leapfrog and beside the other schemes with adaptive steps,
// at equal work. Printed before the benchmarks.
#include <cstdio>
#include <string>
#include <vector>

#include "tests/bench/equal_work.hpp"
#include "tests/bench/table.hpp"

namespace {

using namespace least;

struct Case {
  const char *scheme, *preset, *composition;  // composition nullptr: the scheme has none
  const char* also = "";                      // a further description for the table
};

struct Column {
  const char *heading, *path;  // path: of a number among the diagnostics
};

struct Comparison {
  const char* problem;  // from its default start
  double end;
  std::vector<Case> cases;
  std::vector<double> budgets;  // force evaluations
  std::vector<Column> columns;
};

/// is_length() says whether a setting is the length of a step: in time, in a coordinate or in a parameter.
bool is_length(const ParameterCard& setting) {
  return setting.suggested == "step" || setting.suggested == "theta" || setting.suggested == "sigma";
}

/// scaled() requests the scheme at its suggested settings with all lengths multiplied by `factor`.
Request scaled(const Comparison& all, const Case& c, double factor) {
  Request request = runs::defaults(all.problem, c.scheme);
  request.end = all.end;
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::only_final(request);
  const SchemeCard& card = schemes()[request.scheme];
  for (std::size_t i = 0; i < card.parameters.size(); ++i)
    if (is_length(card.parameters[i])) request.settings[i] *= factor;
  for (const auto& preset : card.presets)
    if (c.preset && preset.name == c.preset)
      for (const auto& [name, value] : preset.settings) runs::set(request, name, value);
  if (c.composition) runs::set(request, "composition", c.composition);
  return request;
}

/// described() returns text such as "κ = −E₀, suzuki_4, σ = 0.1".
std::string described(const Case& c, const Request& request) {
  std::string text = c.also;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (c.composition) add(c.composition);
  const SchemeCard& card = schemes()[request.scheme];
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    if (!is_length(card.parameters[i])) continue;
    char length[32];
    std::snprintf(length, sizeof length, "%.4f", request.settings[i]);
    add(std::string(card.parameters[i].symbol) + " = " + length);
  }
  return text;
}

void print(const Comparison& all) {
  std::printf("| scheme | setting | force evaluations | ms |");
  for (const Column& column : all.columns) std::printf(" %s |", column.heading);
  std::printf("\n|---|---|---|---|");
  for (std::size_t i = 0; i < all.columns.size(); ++i) std::printf("---|");
  std::printf("\n");
  for (const double budget : all.budgets) {
    for (const Case& c : all.cases) {
      const double factor = bench::at_cost(budget, 1, [&](double f) { return scaled(all, c, f); });
      Request request = scaled(all, c, factor);
      const double ms = bench::milliseconds(request);
      for (const Column& column : all.columns) {
        const std::string path = column.path;
        runs::ask(request, path.substr(0, path.find('/')));
      }
      const auto outcome = runs::go(request).outcome;
      std::printf("| `%s` | %s | %lld | %.2f |", c.scheme, described(c, request).c_str(),
                  static_cast<long long>(outcome.cost.force_evaluations), ms);
      for (const Column& column : all.columns) std::printf(" %.1e |", runs::number(outcome.diagnostics, column.path));
      std::printf("%s\n", outcome.stop.reason == ReturnCode::completed ? "" : " stopped");
    }
  }
}

}  // namespace

void bench::hybrid() {
  bench::heading("Steps that follow the motion");
  std::printf("The orbit of Nair, Ober-Blöbaum and Marsden, e = 0.96, 10 periods.\n\n");
  print({"kepler",
         10 * 18.893743377439769,
         {{"leapfrog", nullptr, "none"},
          {"leapfrog", nullptr, "suzuki_4"},
          {"adaptive_verlet", nullptr, nullptr},
          {"energy_momentum", nullptr, nullptr},
          {"jacobi_maupertuis", "paper", nullptr, "`paper`"},
          {"jacobi_maupertuis", "default", nullptr, "`default`"},
          {"time_transformed", nullptr, "kahan_li_6", "κ = 0.75"},
          {"time_transformed", "kepler", "none", "κ = −E₀"},
          {"time_transformed", "kepler", "suzuki_4", "κ = −E₀"},
          {"time_transformed", "kepler", "kahan_li_6", "κ = −E₀"}},
         {20'000, 80'000},
         {{"max. error", "error/max"},
          {"error at the end", "error/final"},
          {"apsidal rotation per revolution", "orbit/apsidal_rotation"},
          {"max. energy error", "energy/max_abs_error"},
          {"max. error of L", "momenta/angular_momentum/max_abs_error"}}});
  std::printf("\nHénon–Heiles, t = 100.\n\n");
  print({"henon_heiles",
         100,
         {{"leapfrog", nullptr, "suzuki_4"},
          {"jacobi_maupertuis", "default", nullptr, "`default`"},
          {"time_transformed", nullptr, "suzuki_4", "κ = 0.06"}},
         {30'000},
         {{"max. error", "error/max"}, {"max. energy error", "energy/max_abs_error"}}});
}

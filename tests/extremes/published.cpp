#include "tests/extremes/published.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/run/suggestions.hpp"
#include "core/schemes/alternation.hpp"
#include "core/study/study.hpp"

namespace torture {
namespace {

using namespace least;
using texts::flow;
using texts::of;
using Kind = text::Definition::Kind;

text::TypedScene typed(text::Definition scene, text::Definition::Named definitions = {}) {
  text::TypedScene all;
  all.scene = std::move(scene);
  all.definitions = std::move(definitions);
  return all;
}
text::TypedScene single(const char* rate) { return typed(flow({"y"}, {}, {{"y", rate}})); }

void add_single_equations(std::vector<Published>& all) {
  all.push_back({"A1", "decay", single("-y"), {1}, 20, {2.061153353012535e-09}, 15, 11});
  all.push_back({"A2", "a Riccati equation", single("-y^3/2"), {1}, 20, {2.182178902359887e-01}, 14, 9});
  all.push_back({"A3", "an oscillation", single("y*cos(t)"), {1}, 20, {2.491650271850414e+00}, 14, 9});
  all.push_back({"A4", "a logistic curve", single("y/4*(1-y/20)"), {1}, 20, {1.773016648131483e+01}, 14, 10});
  all.push_back({"A5", "a spiral", single("(y-t)/(y+t)"), {4}, 20, {-7.887826688964196e-01}, 13, 8});
}

void add_small_systems(std::vector<Published>& all) {
  all.push_back({"B1",
                 "two populations",
                 typed(flow({"a", "b"}, {}, {{"a", "2*(a-a*b)"}, {"b", "-(b-a*b)"}})),
                 {1, 3},
                 20,
                 {6.761876008576667e-01, 1.860816099640036e-01},
                 13,
                 9});
  all.push_back({"B2",
                 "a linear reaction",
                 typed(flow({"a", "b", "c"}, {}, {{"a", "b-a"}, {"b", "a-2*b+c"}, {"c", "b-c"}})),
                 {2, 0, 1},
                 20,
                 {1.000000001030576e+00, 1, 9.999999989694235e-01},
                 14,
                 10});
  all.push_back({"B3",
                 "a reaction",
                 typed(flow({"a", "b", "c"}, {}, {{"a", "-a"}, {"b", "a-b^2"}, {"c", "b^2"}})),
                 {1, 0, 0},
                 20,
                 {2.061153488557776e-09, 5.257228022048349e-02, 9.474277177183630e-01},
                 14,
                 10});
  all.push_back({"B4",
                 "a curve on a torus",
                 typed(flow({"a", "b", "c"}, {},
                            {{"a", "-b-a*c/sqrt(a^2+b^2)"}, {"b", "a-b*c/sqrt(a^2+b^2)"}, {"c", "a/sqrt(a^2+b^2)"}})),
                 {3, 0, 0},
                 20,
                 {9.826950928005993e-01, 2.198447081694832e+00, 9.129452507276399e-01},
                 13,
                 9});
  all.push_back({"B5",
                 "a rigid body",
                 typed(flow({"a", "b", "c"}, {}, {{"a", "b*c"}, {"b", "-a*c"}, {"c", "-0.51*a*b"}})),
                 {0, 1, 1},
                 20,
                 {-9.396570798729192e-01, -3.421177754000779e-01, 7.414126596199957e-01},
                 13,
                 9});
}

/// diffusion() is ẏ = A y from (1, 0, …), with the tridiagonal matrix A of diagonals 1, −2, 1.
text::TypedScene diffusion(int n) {
  const std::string count = std::to_string(n);
  return typed(flow({"y[" + count + "]"}, {}, {{"y[i]", "at(i-1)-2*y[i]+at(i+1)"}}),
               {{"at(i)", "if(i < 1 or i > " + count + ", 0, y[i])"}});
}
std::vector<double> first_of(std::size_t n) {
  std::vector<double> start(n, 0);
  start[0] = 1;
  return start;
}

void add_moderate_systems(std::vector<Published>& all) {
  all.push_back({"C1",
                 "a chain of decays",
                 typed(flow({"y[10]"}, {}, {{"y[i]", "if(i > 1, y[i-1], 0) - if(i < 10, y[i], 0)"}})),
                 first_of(10),
                 20,
                 {2.061153622240064e-09, 4.122307244619555e-08, 4.122307244716968e-07, 2.748204829855288e-06,
                  1.374102414941961e-05, 5.496409659803266e-05, 1.832136553274552e-04, 5.234675866508716e-04,
                  1.308668966628220e-03, 9.979127409508656e-01},
                 14,
                 11});
  all.push_back({"C2",
                 "a chain of decays ever faster",
                 typed(flow({"y[10]"}, {}, {{"y[i]", "if(i > 1, (i-1)*y[i-1], 0) - if(i < 10, i*y[i], 0)"}})),
                 first_of(10),
                 20,
                 {2.061153577984930e-09, 2.061153573736588e-09, 2.061153569488245e-09, 2.061153565239902e-09,
                  2.061153560991560e-09, 2.061153556743217e-09, 2.061153552494874e-09, 2.061153548246532e-09,
                  2.061153543998189e-09, 9.999999814496180e-01},
                 14,
                 10});
  all.push_back({"C3",
                 "diffusion over 10 places",
                 diffusion(10),
                 first_of(10),
                 20,
                 {2.948119211022058e-03, 5.635380154844266e-03, 7.829072515926013e-03, 9.348257908594937e-03,
                  1.007943610301970e-02, 9.982674171429909e-03, 9.088693332766085e-03, 7.489115195185912e-03,
                  5.322964130953349e-03, 2.762434379029886e-03},
                 14,
                 11});
  all.push_back({"C4",
                 "diffusion over 51 places",
                 diffusion(51),
                 first_of(51),
                 20,
                 {3.124111453721466e-03, 6.015416842150318e-03, 8.470021834842650e-03, 1.033682931733337e-02,
                  1.153249572873923e-02, 1.204549525737964e-02, 1.192957068015293e-02, 1.128883207111195e-02,
                  1.025804501391024e-02, 8.982017581934167e-03},
                 14,
                 10});
  // Five outer planets relative to the Sun.
  text::TypedScene planets = typed(
      flow(
          {"x[5]", "y[5]", "z[5]", "u[5]", "v[5]", "w[5]"}, {{"k", 2.95912208286}, {"M", 1.00000597682}},
          {{"x[j]", "u[j]"},
           {"y[j]", "v[j]"},
           {"z[j]", "w[j]"},
           {"u[j]", "k*(sum(l=1..5, if(l != j, m[l]*((x[l]-x[j])/d(j,l)^3 - x[l]/r(l)^3), 0)) - (M+m[j])*x[j]/r(j)^3)"},
           {"v[j]", "k*(sum(l=1..5, if(l != j, m[l]*((y[l]-y[j])/d(j,l)^3 - y[l]/r(l)^3), 0)) - (M+m[j])*y[j]/r(j)^3)"},
           {"w[j]",
            "k*(sum(l=1..5, if(l != j, m[l]*((z[l]-z[j])/d(j,l)^3 - z[l]/r(l)^3), 0)) - (M+m[j])*z[j]/r(j)^3)"}}),
      {{"r(i)", "sqrt(x[i]^2+y[i]^2+z[i]^2)"}, {"d(i,j)", "sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+(z[i]-z[j])^2)"}});
  planets.lists = {
      {"m", {0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449, 0.00000277777777778}}};
  all.push_back(
      {"C5",
       "five outer planets",
       planets,
       {3.42947415189,    6.64145542550,   11.2630437207,  -30.1552268759,  -21.1238353380,  3.35386959711,
        5.97156957878,    14.6952576794,   1.65699966404,  28.4465098142,   1.35494901715,   2.18231499728,
        6.27960525067,    1.43785752721,   15.3882659679,  -0.557160570446, -0.415570776342, -0.325325669158,
        -0.0240476254170, -0.176860753121, 0.505696783289, 0.365682722812,  0.189706021964,  -0.287659532608,
        -0.216393453025,  0.230578543901,  0.169143213293, 0.0877265322780, -0.117219543175, -0.0148647893090},
       20,
       {-4.792730224323733e+00, -4.217310404035213e+00, 4.035559443262270e+00,  -2.998759326324844e+01,
        -2.442125302518482e+01, -2.420550725448973e+00, 7.356202947498970e+00,  1.719865528670555e+01,
        -4.107310937550929e+00, 2.381459045746554e+01,  -9.212509306014886e-01, 3.223785985421212e+00,
        7.478910794233703e+00,  -9.277008321754407e-01, 1.492096306951359e+01,  3.499208963063806e-01,
        -5.237040978903326e-01, -3.875289237334110e-01, 4.133856546712445e-02,  -1.511986457359206e-01},
       14,
       9});
}

void add_orbits(std::vector<Published>& all) {
  const std::vector<std::vector<double>> ends = {
      {2.198835352008397e-01, 9.427076846341813e-01, -9.787659841058176e-01, 3.287977990962036e-01},
      {-1.777027357140412e-01, 9.467784719905892e-01, -1.030294163192969e+00, 1.211074890053952e-01},
      {-5.780432953035361e-01, 8.633840009194193e-01, -9.595083730380727e-01, -6.504915126712089e-02},
      {-9.538990293416394e-01, 6.907409024219432e-01, -8.212674270877433e-01, -1.539574259125825e-01},
      {-1.295266250987574e+00, 4.003938963792321e-01, -6.775390924707566e-01, -1.270838154278686e-01}};
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const double e = 0.1 + 0.2 * static_cast<double>(k);
    all.push_back({"D" + std::to_string(k + 1),
                   "an orbit, e = 0." + std::to_string(1 + 2 * k),
                   typed(of(Kind::potential, {"x", "y"}, {}, "-1/sqrt(x^2+y^2)")),
                   {1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))},
                   20,
                   ends[k],
                   13,
                   9});
  }
}

void add_second_order(std::vector<Published>& all) {
  const auto oscillator = [](const char* force) { return typed(flow({"y", "v"}, {}, {{"y", "v"}, {"v", force}})); };
  all.push_back({"E1",
                 "a Bessel function",
                 oscillator("-(v/(t+1)+(1-0.25/(t+1)^2)*y)"),
                 {0.6713967071418030, 0.09540051444747446},
                 20,
                 {1.456723600728308e-01, -9.883500195574063e-02},
                 13,
                 9});
  all.push_back({"E2",
                 "van der Pol's equation",
                 oscillator("(1-y^2)*v-y"),
                 {2, 0},
                 20,
                 {2.008149762174948e+00, -4.250887527320057e-02},
                 14,
                 9});
  all.push_back({"E3",
                 "Duffing's equation",
                 oscillator("y^3/6-y+2*sin(2.78535*t)"),
                 {0, 0},
                 20,
                 {-1.004178858647128e-01, 2.411400132095954e-01},
                 13,
                 9});
  all.push_back({"E4",
                 "a fall through air",
                 oscillator("0.032-0.4*v^2"),
                 {30, 0},
                 20,
                 {3.395091444646555e+01, 2.767822659672869e-01},
                 14,
                 10});
  all.push_back({"E5",
                 "a pursuit",
                 oscillator("sqrt(1+v^2)/(25-t)"),
                 {0, 0},
                 20,
                 {1.411797390542629e+01, 2.400000000000002e+00},
                 13,
                 9});
}

void add_famous(std::vector<Published>& all) {
  text::TypedScene stars = typed(
      of(Kind::potential, {"x[7]", "y[7]"}, {}, "-sum(i=1..7, j=i+1..7, i*j/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2))"));
  stars.scene.masses = {{"x[i]", "i"}, {"y[i]", "i"}};
  std::vector<double> start{3, 3, -1, -3, 2, -2, 2, 3, -3, 2, 0, 0, -4, 4};
  start.resize(28, 0);
  start[19] = 1.75 * 6;
  start[20] = -1.5 * 7;
  start[24] = -1.25 * 4;
  start[25] = 1 * 5;
  all.push_back({"Pleiades",
                 "seven stars, close encounters",
                 stars,
                 start,
                 3,
                 {0.3706139143970502, 3.237284092057233, -3.222559032418324, 0.6597091455775310, 0.3425581707156584,
                  1.562172101400631, -0.7003092922212495},
                 12,
                 9});
  const double period = 17.0652165601579625588917206249;
  all.push_back({"Arenstorf",
                 "three bodies, a closed orbit, once",
                 typed(flow({"x", "y", "u", "v"}, {{"m", 0.012277471}},
                            {{"x", "u"},
                             {"y", "v"},
                             {"u", "x+2*v-(1-m)*(x+m)/((x+m)^2+y^2)^1.5-m*(x-1+m)/((x-1+m)^2+y^2)^1.5"},
                             {"v", "y-2*u-(1-m)*y/((x+m)^2+y^2)^1.5-m*y/((x-1+m)^2+y^2)^1.5"}})),
                 {0.994, 0, 0, -2.00158510637908252240537862224},
                 period,
                 {0.994, 0},
                 12,
                 12});
  const double v1 = 0.3471168881, v2 = 0.5327249454;
  all.push_back({"Figure eight",
                 "three bodies, a closed orbit, once",
                 typed(of(Kind::potential, {"x[3]", "y[3]"}, {},
                          "-sum(i=1..3, j=i+1..3, 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2))")),
                 {-1, 1, 0, 0, 0, 0, v1, v1, -2 * v1, v2, v2, -2 * v2},
                 6.3259139829,
                 {-1, 1, 0, 0, 0, 0},
                 10,
                 9});
  all.push_back({"van der Pol",
                 "relaxation, μ = 1000, to t = 2000",
                 typed(flow({"x", "v"}, {{"mu", 1000}}, {{"x", "v"}, {"v", "mu*(1-x^2)*v-x"}})),
                 {2, 0},
                 2000,
                 {1.706167732170483},
                 13,
                 11});
}

}  // namespace

std::vector<Published> all_published() {
  std::vector<Published> all;
  add_single_equations(all);
  add_small_systems(all);
  add_moderate_systems(all);
  add_orbits(all);
  add_second_order(all);
  add_famous(all);
  add_motions(all);
  return all;
}

namespace {

/// request_of() requests a run by `taylor` to the end, as accurately as it can.
Request request_of(const text::TypedScene& scene, const std::string& name, const std::vector<double>& start) {
  auto made = custom_mechanics(scene);
  if (const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made))
    throw std::invalid_argument(name + ": " + faults->front().fault.detail);
  Request request =
      texts::typed_as(runs::defaults("van_der_pol", "taylor"), std::get<std::shared_ptr<const Mechanics>>(made));
  texts::begin_at(request, start);
  runs::only_final(request);
  runs::set(request, "tolerance", 1e-15);
  return request;
}

double digits_of(const std::vector<double>& found, const std::vector<double>& known) {
  double size = 1, apart = 0;
  for (const double x : known) size = std::max(size, std::abs(x));
  for (std::size_t i = 0; i < known.size(); ++i) apart = std::max(apart, std::abs(found[i] - known[i]));
  return std::clamp(-std::log10(std::max(apart / size, 1e-17)), 0.0, 16.0);
}

}  // namespace

Agreement agreement_of(const Published& test, bool automatic) {
  Request request = request_of(test.scene, test.name, test.start);
  request.end = test.end;
  Agreement found;
  if (automatic) {
    const std::atomic<bool> never{false};
    const Advice advice = advise(request, {1e-9, 0, {}}, never);
    if (!advice.choice) return found;
    request.scheme = advice.choice->scheme;
    request.settings = advice.choice->settings;
  }
  found.scheme = schemes()[request.scheme].id;
  request.limits.seconds = 100;  // so that digits do not depend on a busy machine
  const auto outcome = runs::go(request).outcome;
  found.seconds = outcome.cost.seconds;
  if (outcome.stop.reason != ReturnCode::completed) return found;
  std::vector<double> last;
  const auto& variables = runs::card(request).variables;
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (!variables[i].hidden) last.push_back(outcome.final[i]);
  found.digits = digits_of(last, test.known);
  return found;
}

std::optional<double> agreement_of_reference(const Published& test) {
  const Request request = request_of(test.scene, test.name, test.start);
  constexpr double certain = 1e-12;
  const Truth truth = truth_along(*request.scene, {test.end}, Norm::absolute, [] { return true; });
  if (!truth.complete || !(truth.uncertainty < certain)) return std::nullopt;
  return digits_of(truth.states[0], test.known);
}

EnergyError energy_of(const EnergyRow& row) {
  const auto all = all_published();
  const auto& test = *std::ranges::find(all, "Outer planets", &Published::name);
  Request request = request_of(test.scene, test.name, test.start);
  request.scheme = find_scheme(row.scheme).value();
  request.settings = runs::defaults("kepler", row.scheme).settings;
  runs::set(request, schemes()[request.scheme].own_clock ? "tolerance" : "step", row.step);
  const bool turns = std::ranges::find(alternations::named, row.composition, &alternations::Named::name) !=
                     std::ranges::end(alternations::named);
  if (!row.composition.empty()) runs::set(request, turns ? "splitting" : "composition", row.composition);
  request.end = test.end;
  runs::ask(request, "energy");
  const Solution outcome = runs::go(request).outcome;
  const double start = runs::number(outcome.diagnostics, "energy/initial");
  return {runs::number(outcome.diagnostics, "energy/max_abs_error") / std::abs(start),
          std::abs(runs::number(outcome.diagnostics, "energy/final") / start - 1), outcome.cost.seconds,
          outcome.cost.force_evaluations};
}

}  // namespace torture

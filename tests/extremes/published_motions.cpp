// Published tests of many bodies, and of chaos.
#include <algorithm>

#include "tests/extremes/published.hpp"

namespace torture {
namespace {

using namespace least;
using Kind = text::Definition::Kind;

void add_outer_planets(std::vector<Published>& all) {
  text::TypedScene planets;
  planets.scene = texts::of(Kind::potential, {"x[6]", "y[6]", "z[6]"}, {{"G", 2.95912208286e-4}},
                            "-G*sum(i=1..6, j=i+1..6, m[i]*m[j]/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+(z[i]-z[j])^2))");
  planets.scene.masses = {{"x[i]", "m[i]"}, {"y[i]", "m[i]"}, {"z[i]", "m[i]"}};
  const std::vector<double> mass{1.00000597682,      0.000954786104043,  0.000285583733151,
                                 0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};
  planets.lists = {{"m", mass}};
  std::vector<double> start{0, -3.5023653, 9.0755314,  8.3101420,   11.4707666,  -15.5387357,
                            0, -3.8169847, -3.0458353, -16.2901086, -25.7294829, -25.2225594,
                            0, -1.5507963, -1.6483708, -7.2521278,  -10.8169456, -3.1902382};
  const std::vector<double> velocity{0, 0.00565429,  0.00168318, 0.00354178, 0.00288930, 0.00276725,
                                     0, -0.00412490, 0.00483525, 0.00137102, 0.00114527, -0.00170702,
                                     0, -0.00190589, 0.00192462, 0.00055029, 0.00039677, -0.00136504};
  for (std::size_t i = 0; i < velocity.size(); ++i) start.push_back(mass[i % 6] * velocity[i]);
  all.push_back({"Outer planets",
                 "the Sun and five planets, days",
                 planets,
                 start,
                 200'000,
                 {1.2358425423546087, 2.611079570112905, -7.669136247391204, -5.824743949847754, 20.663980247515035,
                  36.5669506988225, -0.4899438211442749, -5.079525496787974, -4.052052245488088, 15.337173753572518,
                  20.582956042459855, -13.767684401259773, -0.24610536181432127, -2.244720677853053,
                  -1.3311156697114945, 6.782463409917606, 7.894795414748197, -15.043469221823278},
                 12,
                 7});
}

void add_pythagorean_bodies(std::vector<Published>& all) {
  text::TypedScene bodies;
  bodies.scene = texts::of(Kind::potential, {"x[3]", "y[3]"}, {},
                           "-sum(i=1..3, j=i+1..3, (i+2)*(j+2)/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2))");
  bodies.scene.masses = {{"x[i]", "i+2"}, {"y[i]", "i+2"}};
  all.push_back({"Burrau",
                 "the Pythagorean three bodies",
                 bodies,
                 {1, -2, 1, 3, -1, -1},
                 70,
                 {6.933463599011887, -2.003006002605984, -2.557673357322345, 20.261804305951713, -6.872463435824545,
                  -6.659111834911393},
                 2,
                 1});
}

/// Differences grow by e^(0.9 t): at t = 40 round-off is as large as the motion.
void add_lorenz(std::vector<Published>& all) {
  struct Row {
    double end;
    std::vector<double> known;
    int digits, digits_of_auto;
  };
  const std::vector<Row> rows{{20, {13.793199595130381, 12.951803936192500, 34.901608681136812}, 11, 9},
                              {30, {7.3949854747590161, 2.0516425111435676, 31.761075023462821}, 6, 5},
                              {50, {9.8265832859946244, 14.499380305555456, 21.663435413044198}, 0, 0}};
  text::TypedScene scene;
  scene.scene =
      texts::flow({"x", "y", "z"}, {{"beta", 8 / 3.0}}, {{"x", "10*(y-x)"}, {"y", "28*x-y-x*z"}, {"z", "x*y-beta*z"}});
  for (const Row& row : rows)
    all.push_back({"Lorenz " + std::to_string(static_cast<int>(row.end)),
                   "chaos",
                   scene,
                   {1, 1, 1},
                   row.end,
                   row.known,
                   row.digits,
                   row.digits_of_auto});
}

}  // namespace

void add_motions(std::vector<Published>& all) {
  add_outer_planets(all);
  add_pythagorean_bodies(all);
  add_lorenz(all);
}

std::vector<EnergyRow> energy_rows() {
  return {{"explicit_euler", "", 10, 0.7},
          {"symplectic_euler", "", 100, 0.03},
          {"leapfrog", "", 200, 0.003},
          {"leapfrog", "suzuki_4", 200, 2e-5},
          {"leapfrog", "kahan_li_6", 200, 1e-6},
          {"leapfrog", "kahan_li_8", 200, 1e-9},
          {"ruth_3", "", 200, 2e-4},
          {"kepler_splitting", "", 100, 2e-6},
          {"kepler_splitting", "saba_2", 200, 2e-8},
          {"kepler_splitting", "aba_864", 300, 1e-10},
          {"kepler_splitting", "aba_1064", 500, 1e-10},
          {"explicit_midpoint", "", 100, 0.08},
          {"runge_kutta_4", "", 100, 6e-4},
          {"dormand_prince_5", "", 1e-6, 1e-4},
          {"fehlberg_78", "", 1e-9, 1e-8},
          {"bulirsch_stoer", "", 1e-9, 2e-6},
          {"taylor", "", 1e-12, 2e-11},
          {"taylor", "", 1e-15, 2e-14}};
}

}  // namespace torture

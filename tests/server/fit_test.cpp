// The example that fits a parameter to measurements, run as by a user where there is a python3; it needs nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <random>
#include <string>

#include "tests/server/fixture.hpp"
#include "tests/server/temporary_folder.hpp"

namespace least::server::test {
namespace {

std::string output_of(const std::string& command) {
  std::string text;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  for (int c; pipe && (c = std::fgetc(pipe.get())) != EOF;) text += static_cast<char>(c);
  return text;
}

class Fit : public Asking {};

TEST_F(Fit, FindsTheDampingOfAPendulumInNoise) {
  if (output_of("python3 -c 'print(1)' 2>/dev/null") != "1\n") GTEST_SKIP() << "no python3";
  constexpr double truth = .13, noise = .02;
  const Json problem = custom(R"~({"variables": ["a"], "potential": "-cos(a)", "damping": 0.13})~");
  const Json made = answer({{"problem", problem},
                            {"initial", {{"a", 2}}},
                            {"scheme", "taylor"},
                            {"until", 20},
                            {"record", {{"samples", 201}}}})["trajectory"];
  const TemporaryFolder folder;
  const std::string file = folder.path("seen.csv");
  {
    std::ofstream csv(file);
    csv.precision(17);
    std::mt19937 engine;
    for (std::size_t i = 1; i < made["t"].size(); ++i) {
      double sum = 0;  // nearly normal
      for (int k = 0; k < 12; ++k) sum += static_cast<double>(engine()) / 4294967296.0 - .5;
      csv << made["t"][i].get<double>() << ',' << made["a"][i].get<double>() + noise * sum << '\n';
    }
  }
  const std::string found =
      output_of("python3 " LEAST_SOURCE_DIR "/tests/server/fit_damping.py http://127.0.0.1:" + std::to_string(port()) +
                " '" + file + "'");
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(std::stod(found), truth, .002) << found;  // its standard error is noise/√Σ(∂a/∂c)², some 4e-4
  EXPECT_NE(std::stod(found), truth);
}

}  // namespace
}  // namespace least::server::test

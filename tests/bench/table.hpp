// Rows that are compared at the end of a run of the benchmark: each against its own baseline, measured in the same run,
// and against a goal.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace bench {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Progress says on the standard error that a row of a table is being measured, and at its end how long that took.
class Progress {
 public:
  explicit Progress(std::string title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

 private:
  std::string title_;
  Stopwatch watch_;
};
/// is_wanted() says whether --row asks for a row of this title.
bool is_wanted(std::string_view title);

/// heading() begins a chapter of the results, which go to the standard output as Markdown.
void heading(const char* title);

/// compare() adds a row: the time of `name` over that of `baseline`. It meets its goal up to `goal`; with `goal` 0 it
/// is shown, but not judged.
void compare(const std::string& what, const std::string& name, const std::string& baseline, double goal);

/// Prints the tables by which a scheme is chosen: accuracy at equal work, and how well every scene is solved.
void choice();

/// Prints what schemes with adaptive steps gain on an eccentric orbit, and where they gain nothing.
void hybrid();

/// Prints the errors of long runs of a weakly damped orbit, at equal work.
void drag();

/// Prints what ten thousand revolutions do to the energy, by a scheme that keeps structure and by one that keeps none.
void drift();

/// Prints what each accuracy costs on some scenes, by our fastest scheme and by those of other libraries.
void digits();

/// Prints what each accuracy costs on the scenes of the catalogue that are defined as text.
void scenes();

/// Prints what rotating frames and magnetic fields cost, by explicit maps that keep the form and by other schemes.
void lifts();

/// Prints what Wisdom and Holman's splitting costs on planets, against WHFast's numbers.
void planets();

/// Prints what derivatives of motions cost, in units of runs without them.
void derivatives();

/// Prints how often runs are wrong without a warning, and right with one.
void warnings();

/// Prints how long `auto` takes to choose a scheme for every scene at its start.
void advice();

}  // namespace bench

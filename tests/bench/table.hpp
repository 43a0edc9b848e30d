// Rows that are set side by side at the end of a run of the benchmark: each against its own baseline, measured in the
// same run, and against a goal.
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

/// Tells on the standard error that a row of a table is being measured, and at its end how long that took.
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
/// Whether --row asks for a row of this title.
bool is_wanted(std::string_view title);

/// A chapter of the results, which go to the standard output as Markdown.
void heading(const char* title);

/// `goal` 0: shown, not judged.
void compare(const std::string& what, const std::string& name, const std::string& baseline, double goal);

/// Prints the tables by which a scheme is chosen: accuracy at equal work, and how well every scene is solved.
void choice();

/// Prints what schemes with steps that follow the motion gain on an eccentric orbit, and where they gain nothing.
void hybrid();

/// Prints what long runs of a weakly damped orbit lose, at equal work.
void drag();

/// Prints what ten thousand revolutions do to the energy, by a scheme that keeps structure and by one that keeps none.
void drift();

/// Prints what each accuracy costs on some scenes, by our fastest scheme and by those of other libraries.
void digits();

/// Prints what each accuracy costs on the scenes of the catalogue that are data.
void scenes();

/// Prints what frames that turn and magnetic fields cost, by explicit maps that keep the form and by others.
void lifts();

/// Prints what Wisdom and Holman's splitting costs on planets, against WHFast's numbers.
void planets();

/// Prints what derivatives of motions cost, in runs.
void derivatives();

/// Prints how often runs are wrong without a word, and right with one.
void warnings();

/// Prints how long `auto` takes to choose on every scene as it begins.
void advice();

}  // namespace bench

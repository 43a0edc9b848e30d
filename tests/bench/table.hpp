// Rows that are set side by side at the end of a run of the benchmark: each against its own baseline, measured in the
// same run, and against a goal.
#pragma once

#include <string>

namespace bench {

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

/// Prints what each accuracy costs on some scenes, by our fastest scheme and by those of other libraries.
void digits();

/// Prints how often runs are wrong without a word, and right with one.
void warnings();

}  // namespace bench

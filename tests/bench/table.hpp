// Rows that are set side by side at the end of a run of the benchmark: each against its own baseline, measured in the
// same run, and against a goal.
#pragma once

#include <string>

namespace bench {

/// `goal` 0: shown, not judged.
void compare(const std::string& what, const std::string& name, const std::string& baseline, double goal);

/// Prints the table by which a scheme is chosen: accuracy at equal work.
void choice();

}  // namespace bench

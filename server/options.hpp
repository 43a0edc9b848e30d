// The command line and the environment.
#pragma once

#include <optional>
#include <string>

#include "server/service.hpp"
#include "server/shared/log.hpp"

namespace least::server {

enum class Command { serve, run, ensemble, merge, catalogue, health };

struct Options {
  Command command = Command::serve;
  Settings settings;
  std::string file;                ///< of `run` and `ensemble`; `-` is standard input
  std::string shard = "0/1";       ///< of `ensemble`: which blocks
  std::string output;              ///< of `ensemble`: the part that is written; empty: the answer, on standard output
  std::vector<std::string> parts;  ///< of `merge`
  std::string log_level = "info";
  LogFormat log_format = LogFormat::text;
  std::vector<std::string> warnings;  ///< on variables of the environment that have no effect
};

/// Reads the options; every one may also come from the environment (`--max-steps` from LEASTACTION_MAX_STEPS). Where
/// the program has nothing more to do (help, version, a mistake, which it has then told), the exit code instead.
Result<Options, int> parse_options(int argc, char** argv);

}  // namespace least::server

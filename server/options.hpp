// The command line and the environment.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/service.hpp"
#include "server/shared/log.hpp"

namespace least::server {

enum class Command { serve, run, ensemble, merge, catalogue, health };

/// The shard of an ensemble that is all of it.
inline constexpr std::string_view whole_ensemble = "0/1";

struct Options {
  Command command = Command::serve;
  Settings settings;
  std::string file;                   ///< of `run` and `ensemble`; `-` is standard input
  std::string shard{whole_ensemble};  ///< of `ensemble`: which blocks, as index/count
  std::string output;              ///< of `ensemble`: the part file to write; empty: the answer goes to standard output
  std::vector<std::string> parts;  ///< of `merge`
  std::string log_level = "info";
  LogFormat log_format = LogFormat::text;
  std::vector<std::string> warnings;  ///< about environment variables that have no effect
};

/// parse_options reads the options; each may also come from the environment (`--max-steps` from LEASTACTION_MAX_STEPS).
/// Returns the exit code instead where the program is done: after help, version, or a mistake, which has been reported.
Result<Options, int> parse_options(int argc, char** argv);

}  // namespace least::server

#include "server/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/wording.hpp"

namespace least::server {
namespace {

// --max-steps → LEASTACTION_MAX_STEPS
std::string environment_name(std::string option) {
  option.erase(0, 2);
  for (char& c : option) c = c == '-' ? '_' : static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return "LEASTACTION_" + option;
}

template <class T>
CLI::Option* add(CLI::App& app, const std::string& name, T& value, const std::string& doc) {
  return app.add_option(name, value, doc)->envname(environment_name(name))->capture_default_str();
}

// A range takes what is no number for a number within it.
const CLI::Validator finite(
    [](const std::string& text) {
      double x = 0;
      const bool good = CLI::detail::lexical_cast(text, x) && std::isfinite(x);
      return good ? std::string() : "`" + text + "` is no finite number";
    },
    "", "finite");

void add_common(CLI::App& app, Options& options) {
  Caps& caps = options.settings.caps;
  add(app, "--max-seconds", caps.seconds, "longest computing time a request may ask for")
      ->check(finite & CLI::Range(1e-3, 1e9));
  add(app, "--max-steps", caps.steps, "most steps a request may ask for")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 53));
  add(app, "--max-samples", caps.samples, "most numbers a request may keep, samples times columns")
      ->check(CLI::Range(std::int64_t{2}, std::int64_t{1'000'000'000}));
  add(app, "--max-body", options.settings.bounds.body, "largest request in bytes")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 30));
  add(app, "--log-level", options.log_level, "what is logged on standard error")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}));
}

void add_serve(CLI::App& app, Options& options) {
  Settings& settings = options.settings;
  const auto count = CLI::Range(1u, 100'000u);
  add(app, "--host", settings.host, "address to listen on");
  add(app, "--port", settings.port, "port to listen on, 0 picks a free one")->check(CLI::Range(0, 65535));
  add(app, "--threads", settings.threads, "runs that compute at once, 0 is one per core")->check(CLI::Range(0u, 4096u));
  add(app, "--queue", settings.queue, "runs that wait for their turn, beyond it the answer is 503")
      ->check(CLI::Range(0u, 100'000u));
  add(app, "--connections", settings.connections, "clients connected at once, beyond it those that idle make room")
      ->check(count);
  add(app, "--max-memory", settings.max_memory,
      "bytes held for requests and for answers that are computed or read, beyond it 503")
      ->check(CLI::Range(std::size_t{1} << 20, std::size_t{1} << 50));
  add(app, "--grace", settings.grace, "seconds that runs have left when the service ends")
      ->check(finite & CLI::Range(0.0, 3600.0));
  add(app, "--log-format", options.log_format, "how lines of the log are written: text or json")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LogFormat>{{"text", LogFormat::text}, {"json", LogFormat::json}}));
  add(app, "--allow-host", settings.allow_hosts, "further names clients may use for this service")->delimiter(',');
  add(app, "--allow-origin", settings.allow_origins, "origins of foreign pages that may use this service")
      ->delimiter(',');
}

/// Whether a command line names an option, alone or with its value.
bool names_option(std::span<const char* const> arguments, std::string_view option) {
  return std::any_of(arguments.begin(), arguments.end(),
                     [&](std::string_view argument) { return argument.substr(0, argument.find('=')) == option; });
}

/// A line on the first word that the program does not know: what may have been meant, or what there is; else nothing.
std::string meant(const CLI::App& app, std::span<const char* const> arguments) {
  const CLI::App* command = &app;
  std::vector<std::string> options;
  for (const std::string_view argument : arguments) {
    Names known;
    if (argument.starts_with("--")) {
      options.clear();
      for (const CLI::Option* option : command->get_options()) options.push_back(option->get_name());
      known.assign(options.begin(), options.end());
    } else if (command == &app) {
      for (const CLI::App* each : app.get_subcommands({})) known.push_back(each->get_name());
    }
    const auto word = argument.starts_with("--") ? argument.substr(0, argument.find('=')) : argument;
    if (!known.empty() && std::find(known.begin(), known.end(), word) == known.end()) {
      const auto close = closest(word, known);
      if (!close.empty()) return fmt::format("leastaction: no `{}`; did you mean `{}`?\n", word, close);
      if (command == &app) return fmt::format("leastaction: no `{}`; there are {}\n", word, listed(known));
      return {};
    }
    if (command == &app && !argument.starts_with("-")) command = app.get_subcommand(std::string(argument));
  }
  return {};
}

/// A message that begins with an option whose value came from the environment names the variable.
std::string with_its_source(std::string message, std::span<const char* const> arguments) {
  const std::string option = message.substr(0, message.find(':'));
  if (!option.starts_with("--") || names_option(arguments, option)) return message;
  const std::string variable = environment_name(option);
  return std::getenv(variable.c_str()) ? variable + message.substr(option.size()) : message;
}

/// CLI11 2.4 passes over variables of the environment whose values it would refuse: throws what it says of them.
void refuse_forgotten_environment(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands())
    for (CLI::Option* option : command->get_options()) {
      const char* value = option->get_envname().empty() ? nullptr : std::getenv(option->get_envname().c_str());
      if (value && *value && option->count() == 0) option->add_result(value)->run_callback();
    }
}

}  // namespace

Result<Options, int> parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("Mechanics from principles of least action: runs, served over HTTP or on the command line.",
               "leastaction");
  const std::string title = "leastaction " + std::string(version);
  app.require_subcommand(1);
  CLI::App* serve = app.add_subcommand("serve", "listen for requests, serve the page");
  CLI::App* run = app.add_subcommand("run", "answer one request: JSON in, JSON out");
  CLI::App* ensemble = app.add_subcommand("ensemble", "many runs of one scene: JSON in, JSON or a part out");
  CLI::App* merge = app.add_subcommand("merge", "the answer of an ensemble from all of its parts");
  CLI::App* catalogue = app.add_subcommand("catalogue", "print every problem and scheme as JSON");
  CLI::App* health = app.add_subcommand("health", "ask a service whether it lives: exit code 0 or 1");
  app.set_version_flag("--version", title);
  for (CLI::App* command : {serve, run, ensemble, merge, catalogue, health})
    command->set_version_flag("--version", title);
  add_serve(*serve, options);
  add_common(*serve, options);
  add_common(*run, options);
  for (CLI::App* command : {run, ensemble})
    command->add_option("file", options.file, "the request, - is standard input")->required();
  add_common(*ensemble, options);
  add(*ensemble, "--threads", options.settings.threads, "threads that compute, 0 is one per core")
      ->check(CLI::Range(0u, 4096u));
  add(*ensemble, "--shard", options.shard, "I/N: the blocks whose number leaves I when divided by N");
  add(*ensemble, "--output", options.output, "the part to write; needed where there are several shards");
  add_common(*merge, options);
  merge->add_option("parts", options.parts, "parts, in any order")->required();
  add(*health, "--host", options.settings.host, "address of the service");
  add(*health, "--port", options.settings.port, "its port")->check(CLI::Range(0, 65535));
  try {
    app.parse(argc, argv);
    refuse_forgotten_environment(app);
  } catch (const CLI::ParseError& e) {
    const std::span<const char* const> arguments(argv + 1, argv + std::max(argc, 1));
    if (e.get_exit_code() != 0) {
      const std::string help = meant(app, arguments);
      const std::string message =
          help.empty() ? fmt::format("leastaction: {}\n", with_its_source(e.what(), arguments)) : help;
      fmt::print(stderr, "{}Run with --help for more information.\n", message);
      return 1;
    }
    return app.exit(e);
  }
  options.command = serve->parsed()      ? Command::serve
                    : run->parsed()      ? Command::run
                    : ensemble->parsed() ? Command::ensemble
                    : merge->parsed()    ? Command::merge
                    : health->parsed()   ? Command::health
                                         : Command::catalogue;
  return options;
}

}  // namespace least::server

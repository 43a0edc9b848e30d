#include "server/options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <regex>
#include <span>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/wording.hpp"
#include "server/http/forwarded.hpp"

namespace least::server {
namespace {

constexpr std::string_view prefix = "LEASTACTION_";

// environment_name returns LEASTACTION_MAX_STEPS for --max-steps.
std::string environment_name(std::string option) {
  option.erase(0, 2);
  for (char& c : option) c = c == '-' ? '_' : static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return std::string(prefix) + option;
}

template <class T>
CLI::Option* add(CLI::App& app, const std::string& name, T& value, const std::string& doc) {
  return app.add_option(name, value, doc)->envname(environment_name(name))->capture_default_str();
}

// CLI::Range accepts NaN.
const CLI::Validator finite(
    [](const std::string& text) {
      double x = 0;
      const bool good = CLI::detail::lexical_cast(text, x) && std::isfinite(x);
      return good ? std::string() : "`" + text + "` is no finite number";
    },
    "", "finite");

// Accepts `100M` as a number of bytes, with powers of 1024 as container runtimes use.
const CLI::Validator size(
    [](std::string& text) {
      constexpr std::string_view units = "KMG";
      const auto unit = text.empty() ? units.npos : units.find(text.back());
      if (unit == units.npos) return std::string();
      std::uint64_t bytes = 0;
      const char* const end = text.data() + text.size() - 1;
      const auto [stop, error] = std::from_chars(text.data(), end, bytes);
      const unsigned shift = 10 * (static_cast<unsigned>(unit) + 1);
      if (error != std::errc() || stop != end || bytes > std::numeric_limits<std::uint64_t>::max() >> shift)
        return "`" + text + "` is no size: a number, or one with K, M or G behind it";
      text = std::to_string(bytes << shift);
      return std::string();
    },
    "", "size");

// An origin as browsers send it, RFC 6454: `https://example.org`, `http://[::1]:8000`. Anything else would match no
// page, and a text with a blank or a semicolon would add directives to the policy of the page.
const CLI::Validator origin(
    [](std::string& text) {
      static const std::regex form(R"([a-z][a-z0-9+.-]*://([a-z0-9._-]+|\[[0-9a-f:.]+\])(:[0-9]{1,5})?)");
      std::string lower = lowered(text);
      if (!std::regex_match(lower, form))
        return "`" + text + "` is no origin: a scheme, a host and maybe a port, as https://example.org";
      text = std::move(lower);
      return std::string();
    },
    "", "origin");
// Pages without an origin, such as files, send `null`.
const CLI::Validator origin_or_none([](std::string& text) { return text == "null" ? std::string() : origin(text); }, "",
                                    "origin");

void add_log_level(CLI::App& app, Options& options) {
  add(app, "--log-level", options.log_level, "what is logged on standard error")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}));
}

// add_limits adds the limits of what requests may ask for; `held` says what counts as memory.
void add_limits(CLI::App& app, Options& options, const std::string& held) {
  Caps& caps = options.settings.caps;
  add(app, "--max-seconds", caps.seconds, "longest computing time a request may ask for")
      ->check(finite & CLI::Range(1e-3, 1e9));
  add(app, "--max-steps", caps.steps, "most steps a request may ask for")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 53));
  add(app, "--max-samples", caps.samples, "most numbers a request may keep, samples times columns")
      ->check(CLI::Range(std::int64_t{2}, std::int64_t{1'000'000'000}));
  add(app, "--max-body", options.settings.bounds.body, "largest request in bytes, also as 64K or 1M")
      ->transform(size)
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 30));
  add(app, "--max-memory", options.settings.max_memory,
      held + ", also as 100M or 2G, beyond it 503; never less than the largest answer needs, see --max-samples")
      ->transform(size)
      ->check(CLI::Range(std::size_t{1} << 20, std::size_t{1} << 50));
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
  add(app, "--drain", settings.drain,
      "seconds that the port stays open when the service ends, while /readyz says 503; a second signal ends it")
      ->check(finite & CLI::Range(0.0, 3600.0));
  add(app, "--grace", settings.grace, "seconds that runs have left when the service ends")
      ->check(finite & CLI::Range(0.0, 3600.0));
  add(app, "--log-format", options.log_format, "how lines of the log are written: text or json")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LogFormat>{{"text", LogFormat::text}, {"json", LogFormat::json}}));
  add(app, "--allow-host", settings.allow_hosts, "further names clients may use for this service")->delimiter(',');
  add(app, "--trusted-proxy", settings.trusted_proxies, "addresses of proxies whose X-Forwarded-For is believed")
      ->delimiter(',')
      ->transform(CLI::Validator(
          [](std::string& text) {
            const std::string address = address_of(text);
            if (address.empty()) return "`" + text + "` is no address";
            text = address;  // in the notation that is used for connections
            return std::string();
          },
          "", "address"));
  add(app, "--metrics-port", settings.metrics_port,
      "port of this host where /metrics is then, 0 picks a free one; -1: it is at --port")
      ->check(CLI::Range(-1, 65535));
  add(app, "--allow-origin", settings.allow_origins, "origins of foreign pages that may use this service")
      ->delimiter(',')
      ->transform(origin_or_none);
  add(app, "--allow-frame", settings.allow_frames, "origins of foreign pages that may hold this page in a frame")
      ->delimiter(',')
      ->transform(origin);
}

/// names_option tells whether a command line has an option, alone or with its value.
bool names_option(std::span<const char* const> arguments, std::string_view option) {
  return std::any_of(arguments.begin(), arguments.end(),
                     [&](std::string_view argument) { return argument.substr(0, argument.find('=')) == option; });
}

/// meant returns a line about the first unknown word: what may have been meant, or what is available; empty where all
/// words are known.
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

/// taken_variables returns the program's environment variables and removes them, so that only with_variables uses them:
/// CLI11 would read them even where the command line has the option, or ignore mistakes in them.
std::map<std::string, std::string> taken_variables() {
  std::map<std::string, std::string> taken;
  for (char** entry = environ; entry && *entry; ++entry) {
    const std::string_view line(*entry);
    const auto equals = std::min(line.find('='), line.size() - 1);
    if (line.starts_with(prefix)) taken.emplace(line.substr(0, equals), line.substr(equals + 1));
  }
  for (const auto& [name, value] : taken) ::unsetenv(name.c_str());
  return taken;
}

/// command_of returns the command that the arguments name; null where there is none.
CLI::App* command_of(CLI::App& app, std::span<const char* const> arguments) {
  for (const char* argument : arguments)
    for (CLI::App* command : app.get_subcommands({}))
      if (command->get_name() == argument) return command;
  return nullptr;
}

/// with_variables returns the arguments, followed by the options of their command that only a variable sets.
std::vector<std::string> with_variables(CLI::App& app, std::span<const char* const> arguments,
                                        const std::map<std::string, std::string>& variables) {
  std::vector<std::string> all(arguments.begin(), arguments.end());
  if (CLI::App* command = command_of(app, arguments)) {
    for (const CLI::Option* option : command->get_options()) {
      const auto variable = variables.find(option->get_envname());
      if (variable == variables.end() || variable->second.empty()) continue;
      const std::string name = option->get_name();
      if (!names_option(arguments, name)) all.push_back(name + '=' + variable->second);
    }
  }
  return all;
}

/// said_of returns warnings about variables without effect: no option has that name, or the command line sets the
/// option.
std::vector<std::string> said_of(const CLI::App& app, std::span<const char* const> arguments,
                                 const std::map<std::string, std::string>& variables) {
  std::map<std::string, std::string> options;  // by variable
  for (const CLI::App* command : app.get_subcommands({}))
    for (const CLI::Option* option : command->get_options())
      if (!option->get_envname().empty()) options.emplace(option->get_envname(), option->get_name());
  Names known;
  for (const auto& [variable, option] : options) known.push_back(std::string_view(variable).substr(prefix.size()));
  std::vector<std::string> said;
  for (const auto& [variable, value] : variables) {
    if (const auto found = options.find(variable); found == options.end()) {
      const auto close = closest(std::string_view(variable).substr(prefix.size()), known);
      said.push_back(close.empty()
                         ? fmt::format("no option has the variable {}", variable)
                         : fmt::format("no option has the variable {}; did you mean {}{}?", variable, prefix, close));
    } else if (names_option(arguments, found->second)) {
      said.push_back(fmt::format("{} is overlooked: {} is given", variable, found->second));
    }
  }
  return said;
}

/// with_its_source replaces the option at the beginning of a message by the variable that set it.
std::string with_its_source(std::string message, std::span<const char* const> arguments,
                            const std::map<std::string, std::string>& variables) {
  const std::string option = message.substr(0, message.find(':'));
  if (!option.starts_with("--") || names_option(arguments, option)) return message;
  const std::string variable = environment_name(option);
  return variables.contains(variable) ? variable + message.substr(option.size()) : message;
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
  add_limits(*serve, options, "bytes held for requests and answers and in memory besides");
  for (CLI::App* command : {run, ensemble}) {
    command->add_option("file", options.file, "the request, - is standard input")->required();
    add_limits(*command, options, "bytes held for the request and its answer");
  }
  for (CLI::App* command : {serve, run, ensemble, merge}) add_log_level(*command, options);
  add(*ensemble, "--threads", options.settings.threads, "threads that compute, 0 is one per core")
      ->check(CLI::Range(0u, 4096u));
  add(*ensemble, "--shard", options.shard, "I/N: the blocks whose number leaves I when divided by N");
  add(*ensemble, "--output", options.output, "the part to write; needed where there are several shards");
  merge->add_option("parts", options.parts, "parts, in any order")->required();
  add(*health, "--host", options.settings.host, "address of the service");
  add(*health, "--port", options.settings.port, "its port")->check(CLI::Range(0, 65535));
  const std::span<const char* const> arguments(argv + std::min(argc, 1), argv + argc);
  const auto variables = taken_variables();
  try {
    std::vector<std::string> words = with_variables(app, arguments, variables);
    std::reverse(words.begin(), words.end());  // the order that CLI11 expects
    app.parse(words);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) {
      const std::string help = meant(app, arguments);
      const std::string message =
          help.empty() ? fmt::format("leastaction: {}\n", with_its_source(e.what(), arguments, variables)) : help;
      fmt::print(stderr, "{}Run with --help for more information.\n", message);
      return 1;
    }
    return app.exit(e);
  }
  options.warnings = said_of(app, arguments, variables);
  options.command = serve->parsed()      ? Command::serve
                    : run->parsed()      ? Command::run
                    : ensemble->parsed() ? Command::ensemble
                    : merge->parsed()    ? Command::merge
                    : health->parsed()   ? Command::health
                                         : Command::catalogue;
  return options;
}

}  // namespace least::server

// leastaction serve | run FILE|- | ensemble FILE|- | merge PART… | catalogue | health
#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <stdexcept>
#include <thread>

#include "least_version.hpp"
#include "server/encode/catalogue_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/ensemble.hpp"
#include "server/health.hpp"
#include "server/options.hpp"
#include "server/shards.hpp"
#include "server/shared/log.hpp"
#include "server/simulate.hpp"

namespace least::server {
namespace {

int print(std::string_view text, int code) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return code;
  std::perror("leastaction: cannot write");
  return 1;
}

// If a standard stream is closed, the next socket would get its number, and a client would receive the log.
void open_standard_streams() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) != descriptor) {
      throw std::runtime_error("cannot open /dev/null");
    }
  }
}

// One descriptor for each connection and some for the service: shells often set a limit below what is allowed.
void allow_descriptors(unsigned connections) {
  constexpr rlim_t own = 32;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= connections + own) return;
  limit.rlim_cur = std::min(connections + own, limit.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur >= connections + own) return;
  LogLine(spdlog::level::warn, "fewer descriptors than --connections needs: clients will make room for others")
      .with("allowed", static_cast<std::int64_t>(limit.rlim_cur))
      .with("needed", static_cast<std::int64_t>(connections + own));
}

// Limits the memory that malloc keeps: by default every thread has a heap of its own that keeps what its requests
// freed, and the size above which freed blocks return to the system at once grows with the largest block. Must be
// called before threads start.
void limit_heaps(unsigned threads) {
  constexpr unsigned threads_of_a_heap = 4;
  if (threads == 0) threads = std::thread::hardware_concurrency();
  ::mallopt(M_ARENA_MAX, static_cast<int>(std::max(2U, threads / threads_of_a_heap)));
  ::mallopt(M_MMAP_THRESHOLD, 256 * 1024);
  ::mallopt(M_TRIM_THRESHOLD, 1024 * 1024);
}

void warn_of(const Options& options) {
  for (const std::string& warning : options.warnings) LogLine(spdlog::level::warn, "environment").with("why", warning);
}

void tell_of_start(const Service& service, const Options& options) {
  const auto whole = [](auto number) { return static_cast<std::int64_t>(number); };
  const Caps& caps = options.settings.caps;
  if (const std::size_t asked = options.settings.max_memory; asked < service.max_memory())
    LogLine(spdlog::level::warn, "the largest answer needs more than --max-memory: a smaller --max-samples lowers that")
        .with("asked", whole(asked))
        .with("memory", whole(service.max_memory()));
  LogLine start(spdlog::level::info, "start");
  start.with("url", service.url());
  if (service.metrics_port() > 0) start.with("metrics_port", std::int64_t{service.metrics_port()});
  start.with("version", std::string(version))
      .with("pid", whole(::getpid()))
      .with("threads", whole(service.places()))
      .with("memory", whole(service.max_memory()))
      .with("queue", whole(options.settings.queue))
      .with("connections", whole(options.settings.connections))
      .with("max_seconds", caps.seconds)
      .with("max_steps", whole(caps.steps))
      .with("max_samples", whole(caps.samples));
}

// Signals are blocked before any thread starts and waited for here, so that none interrupts a run.
int serve(const Options& options) {
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  struct sigaction hang_up {};
  ::sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaddset(&ends, SIGHUP);  // the terminal closes; not under nohup
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  limit_heaps(options.settings.threads);
  const LogQueue log(STDERR_FILENO, options.log_level, options.log_format);
  allow_descriptors(options.settings.connections);
  Settings settings = options.settings;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers manage freed memory themselves
  settings.alone = true;
#endif
  Service service(settings, assets());
  if (const auto error = service.start()) {
    fmt::print(stderr, "leastaction: {}\n", *error);
    return 1;
  }
  // The log comes first: whoever reads the address finds its lines.
  warn_of(options);
  tell_of_start(service, options);
  print(fmt::format("listening on {}\n", service.url()), 0);
  while (sigwaitinfo(&ends, nullptr) < 0) {  // a debugger may interrupt it
  }
  LogLine(spdlog::level::info, "ending").with("why", "signal");
  {
    const timespec glance{0, 20'000'000};
    const std::jthread end([&] { service.stop(); });
    // A second signal: its sender does not want to wait for the drain time.
    while (service.running())
      if (sigtimedwait(&ends, nullptr, &glance) > 0) service.hurry();
  }
  return 0;
}

// opened returns an open file. A named pipe is waited for until somebody writes to it, for a limited time. Null: it
// cannot be read.
std::FILE* opened(const std::string& name) {
  constexpr int patience = 10'000;  // milliseconds
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  pollfd written{descriptor, POLLIN, 0};
  const bool good = descriptor >= 0 && ::fstat(descriptor, &status) == 0 &&
                    (!S_ISFIFO(status.st_mode) || ::poll(&written, 1, patience) == 1) &&
                    ::fcntl(descriptor, F_SETFL, O_RDONLY) == 0;
  if (good) return ::fdopen(descriptor, "rb");
  if (descriptor >= 0) ::close(descriptor);
  return nullptr;
}

// contents reads a file once, as pipes require, up to one byte beyond `most`. Nothing: it cannot be read.
std::optional<std::string> contents(const std::string& name, std::size_t most) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(name == "-" ? stdin : opened(name), std::fclose);
  if (!file) return std::nullopt;
  std::string text;
  char block[65536];
  for (std::size_t n; text.size() <= most && (n = std::fread(block, 1, sizeof block, file.get())) > 0;) {
    text.append(block, std::min(n, most + 1 - text.size()));
  }
  if (std::ferror(file.get())) return std::nullopt;
  return text;
}

// say prints the answer of a command. It returns 0 where HTTP would answer 200, and `failed` for an error that is no
// fault of the request.
template <class Compute>
int say(std::string_view id, Compute&& compute, int failed = 2) {
  Answer answer;
  try {
    answer = compute();
  } catch (const MemoryShortage&) {
    answer = problem_document(503, "the request needs more memory than --max-memory allows", id);
  } catch (const std::exception& e) {
    LogLine(spdlog::level::err, "failed").with("why", e.what());
    answer = problem_document(500, "", id);
  }
  if (answer.pieces) {
    std::string piece;
    for (bool more = true; more; piece.clear()) {
      more = answer.pieces(piece);
      if (print(piece, 0) != 0) return 1;
    }
    return 0;
  }
  if (!answer.stream) return print(answer.body, answer.status == 200 ? 0 : answer.status >= 500 ? failed : 2);
  const auto end = answer.stream([](std::string_view piece) { return print(piece, 0) == 0; });
  return end ? print(*end, 0) : 1;
}

// answer_file answers the request in the file that the options name, with so many threads at most.
template <class Compute>
int answer_file(const Options& options, std::string_view id, unsigned threads, Compute&& compute, int failed = 2) {
  const std::size_t most = options.settings.bounds.body;
  const auto body = contents(options.file, most);
  if (!body) return print(problem_document(400, "cannot read " + options.file, id).body, 2);
  if (body->size() > most) {
    const std::string why = fmt::format("the request is larger than {} bytes, see --max-body", most);
    return print(problem_document(413, why, id).body, 2);
  }
  const std::atomic<bool> cancelled{false};
  Admission admission(threads, 0);
  MemoryBudget memory(memory_for(options.settings));
  const HeldByThread held(&memory);
  const Context context{catalogue_cards(), options.settings.caps, admission, cancelled, memory};
  const HttpRequest request{*body, "", id};
  return say(
      id, [&] { return compute(context, request); }, failed);
}

int health(const Options& options) {
  const auto fault = health_fault(options.settings.host, options.settings.port);
  if (fault) fmt::print(stderr, "leastaction: {}\n", *fault);
  return fault ? 1 : 0;
}

int run(const Options& options) {
  return answer_file(options, "run", 1, [](const Context& context, const HttpRequest& request) {
    return answer_now(simulate, context, request);
  });
}

int ensemble(const Options& options) {
  const unsigned cores = std::max(std::thread::hardware_concurrency(), 1U);
  const unsigned threads = options.settings.threads > 0 ? options.settings.threads : cores;
  const bool part = !options.output.empty() || options.shard != whole_ensemble;
  const auto answer = [&](const Context& context, const HttpRequest& request) {
    return part ? write_part(context, request, options.shard, options.output, threads)
                : answer_now(run_ensemble_request, context, request);
  };
  constexpr int again = 1;  // a queue may try again, for example if a disk was full
  return answer_file(options, "ensemble", threads, answer, again);
}

int merge(const Options& options) {
  constexpr std::string_view id = "merge";
  return say(id, [&] { return merge_parts(catalogue_cards(), options.parts, id); });
}

int main(int argc, char** argv) {
  open_standard_streams();
  const auto options = parse_options(argc, argv);
  if (!options) return options.error();
  log_directly(options->log_level);
  if (options->command != Command::serve) warn_of(*options);
  switch (options->command) {
    case Command::serve:
      return serve(*options);
    case Command::run:
      return run(*options);
    case Command::ensemble:
      return ensemble(*options);
    case Command::merge:
      return merge(*options);
    case Command::catalogue:
      return print(describe(catalogue_cards()).all + '\n', 0);
    case Command::health:
      return health(*options);
  }
  return 1;
}

}  // namespace
}  // namespace least::server

int main(int argc, char** argv) {
  try {
    return least::server::main(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "leastaction: {}\n", e.what());
    return 1;
  }
}

// leastaction serve | run FILE|- | ensemble FILE|- | merge PART… | catalogue
#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <thread>

#include "server/encode/catalogue_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/ensemble.hpp"
#include "server/options.hpp"
#include "server/shards.hpp"
#include "server/simulate.hpp"

namespace least::server {
namespace {

int print(std::string_view text, int code) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return code;
  std::perror("leastaction: cannot write");
  return 1;
}

// Signals are blocked before any thread starts and waited for here, so that none interrupts a run.
int serve(const Options& options) {
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  std::signal(SIGPIPE, SIG_IGN);

  Service service(options.settings, assets());
  if (const auto error = service.start()) {
    fmt::print(stderr, "leastaction: {}\n", *error);
    return 1;
  }
  print(fmt::format("listening on {}\n", service.url()), 0);
  const timespec second{1, 0};
  int signal = -1;
  while (signal < 0 && service.running()) signal = sigtimedwait(&ends, nullptr, &second);
  const bool asked = signal > 0;
  spdlog::info(asked ? "ending" : "the listening socket failed, ending");
  service.stop();
  return asked ? 0 : 1;
}

// What a command says, and 0 where HTTP would say 200.
template <class Compute>
int answer_with(std::string_view id, Compute&& compute) {
  Answer answer;
  try {
    answer = compute();
  } catch (const std::exception& e) {
    spdlog::error("request id={} failed: {}", id, e.what());
    answer = problem_document(500, "", id);
  }
  return print(answer.body, answer.status == 200 ? 0 : 2);
}

// The text of the request, or why there is none.
Result<std::string, Answer> request_text(const Options& options, std::string_view id) {
  if (options.file == "-") return std::string(std::istreambuf_iterator<char>(std::cin), {});
  if (std::filesystem::is_directory(options.file) || !std::ifstream(options.file)) {
    return problem_document(400, "cannot read " + options.file, id);
  }
  std::ifstream file(options.file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

int run(const Options& options) {
  constexpr std::string_view id = "run";
  const std::atomic<bool> cancelled{false};
  Admission admission(1, 0);
  return answer_with(id, [&] {
    const auto body = request_text(options, id);
    if (!body) return body.error();
    return simulate({catalogue_cards(), options.settings.caps, admission, cancelled}, {*body, "", id});
  });
}

int ensemble(const Options& options) {
  constexpr std::string_view id = "ensemble";
  const std::atomic<bool> cancelled{false};
  const unsigned cores = std::max(std::thread::hardware_concurrency(), 1U);
  const unsigned threads = options.settings.threads > 0 ? options.settings.threads : cores;
  Admission admission(threads, 0);
  const bool part = !options.output.empty() || options.shard != Options{}.shard;
  return answer_with(id, [&] {
    const auto body = request_text(options, id);
    if (!body) return body.error();
    const Context context{catalogue_cards(), options.settings.caps, admission, cancelled};
    const HttpRequest request{*body, "", id};
    return part ? write_part(context, request, options.shard, options.output, threads)
                : run_ensemble_request(context, request);
  });
}

int merge(const Options& options) {
  constexpr std::string_view id = "merge";
  return answer_with(id, [&] { return merge_parts(catalogue_cards(), options.parts, id); });
}

int main(int argc, char** argv) {
  const auto options = parse_options(argc, argv);
  if (!options) return options.error();
  spdlog::set_default_logger(spdlog::stderr_logger_mt("leastaction"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %v");
  spdlog::set_level(spdlog::level::from_str(options->log_level));
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

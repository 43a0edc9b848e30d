// Clients with heavy requests: explosive scenes as text, sections with more points than may be kept, and lines that are
// read slowly. Each counts what it met.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/explosive.hpp"

namespace least::server::test {

// Overrun is the largest time in seconds by which the service computed for longer than asked, over all answers of a
// kind.
class Overrun {
 public:
  void add(const Reply& reply, double asked) {
    const std::string timing = reply.fields.contains("server-timing") ? reply.fields.at("server-timing") : "";
    constexpr std::string_view before = "compute;dur=";  // milliseconds, without the wait for a turn
    const std::lock_guard lock(mutex_);
    ++count_;
    if (timing.starts_with(before))
      longest_ = std::max(longest_, std::stod(timing.substr(before.size())) / 1e3 - asked);
  }
  double longest() const { return longest_; }
  long count() const { return count_; }

 private:
  std::mutex mutex_;
  double longest_ = 0;
  long count_ = 0;
};

class HeavyClients {
 public:
  HeavyClients(int port, const std::atomic<bool>& ending) : port_(port), ending_(ending) {}

  // Every scene in turn, with every question about it, each for a tenth of a second.
  void ask_for_explosive_scenes(int first) {
    const std::vector<Explosive> scenes = ExplosiveTexts::all();
    for (std::size_t i = static_cast<std::size_t>(first); !ending_; ++i) {
      // Each scene takes the next question, and after all scenes one more, so that each scene meets each question.
      const std::vector<Question> all = questions(scenes[i % scenes.size()], "0.1");
      const Question& question = all[(i + i / scenes.size()) % all.size()];
      const auto reply = answer_to(post(question.path, question.body));
      if (!reply) continue;
      explosive.add(*reply, 0.1);
      // 422: the scheme does not fit, or the derived formulas take too many operations.
      const bool known = reply->status == 200 || reply->status == 422 || reply->status == 503;
      if (!known || !nlohmann::json::accept(reply->body)) ++wrong;
    }
  }

  // Many members that cross a section many times, within a second; the last of these sections takes less, and megabytes
  // of it are kept and read.
  void ask_for_sections(int) {
    const std::string begin = R"({"problem":"harmonic_oscillator","scheme":{"id":"leapfrog","step":0.05},
        "keep":["section"],"columns":["q","p"],"limits":{"seconds":1,"samples":1000000},)",
                      members = R"("members":{"vary":{"/initial/q":{"uniform":[-1,1]}},"count":)";
    const std::string requests[] = {begin + members + R"(100000},"until":{"t":1000},"section":{"period":0.05}})",
                                    begin + members + R"(20000},"until":{"t":1000},"section":{"expression":"q"}})",
                                    begin + members + R"(200},"until":{"t":100},"section":{"period":0.05}})"};
    for (std::size_t i = 0; !ending_; ++i) {
      const auto reply = answer_to(post("/v1/ensemble", requests[i % std::size(requests)]));
      if (reply) {
        sections.add(*reply, 1);
        const bool known = reply->status == 200 || reply->status == 503;
        if (!known || !nlohmann::json::accept(reply->body)) ++wrong;
      }
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  }

  // 90 kB a second, half more than a client has to take: the run is over long before its lines are read.
  void read_slowly(int) {
    const std::string request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","record":{"every":1},
        "columns":["t","x"],"limits":{"seconds":60},"until":{"steps":80000}})",
                                     "Accept: application/x-ndjson\r\n");
    constexpr std::string_view end_of_chunks = "\r\n0\r\n\r\n";
    while (!ending_) {
      Client client(port_, "127.0.0.4", 16 * 1024);
      client.send(request);
      std::string bytes;
      auto next = std::chrono::steady_clock::now();
      for (std::optional<std::string> some; !bytes.ends_with(end_of_chunks) && (some = client.some(4500));) {
        bytes += *some;
        if (bytes.starts_with("HTTP/1.1 503")) break;
        std::this_thread::sleep_until(next += std::chrono::milliseconds(50));
      }
      if (ending_) return;
      if (bytes.starts_with("HTTP/1.1 503")) {
        ++told_to_come_again;
        std::this_thread::sleep_for(std::chrono::seconds(1));
      } else {
        judge(lines_in(bytes));
      }
    }
  }

  Overrun explosive, sections;
  std::atomic<long> wrong{0}, lost{0}, told_to_come_again{0};
  std::atomic<long> read_whole{0}, ended_early{0}, cut_off{0};  // of the answers that were read slowly

 private:
  std::optional<Reply> answer_to(const std::string& request) {
    Client client(port_);
    client.send(request);
    auto reply = client.receive();
    if (!reply && !ending_) ++lost;
    if (reply && reply->status == 503) ++told_to_come_again;
    return reply;
  }

  // lines_in() returns the body without its chunked coding, as far as it arrived.
  static std::string lines_in(std::string_view bytes) {
    std::string lines;
    auto at = bytes.find("\r\n\r\n");
    at = at == bytes.npos ? bytes.size() : at + 4;
    for (std::size_t line; (line = bytes.find("\r\n", at)) != bytes.npos;) {
      const std::size_t size = std::stoul("0" + std::string(bytes.substr(at, line - at)), nullptr, 16);
      lines += bytes.substr(line + 2, size);
      at = std::min(line + 2 + size + 2, bytes.size());
    }
    return lines;
  }

  // Every line is JSON, and the last one is the end: of the whole run, or of one that was ended because too many
  // clients were slow at once. Nothing else may end it.
  void judge(std::string_view lines) {
    nlohmann::json last;
    bool good = lines.ends_with('\n');
    while (good && !lines.empty()) {
      const std::size_t end = lines.find('\n');
      last = nlohmann::json::parse(lines.substr(0, end), nullptr, false);
      good = !last.is_discarded();
      lines.remove_prefix(end + 1);
    }
    good = good && last.is_object() && last.value("kind", "") == "end";
    if (good && last.value("status", "") == "completed") {
      ++read_whole;
    } else if (good && last["stop"].value("reason", "") == "cancelled") {
      ++ended_early;
    } else {
      ++cut_off;
    }
  }

  const int port_;
  const std::atomic<bool>& ending_;
};

}  // namespace least::server::test

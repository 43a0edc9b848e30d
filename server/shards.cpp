#include "server/shards.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <system_error>

#include "core/ensemble/lone_members.hpp"
#include "server/decode/ensemble_block.hpp"
#include "server/decode/ensemble_request.hpp"
#include "server/decode/field_reader.hpp"
#include "server/decode/wording.hpp"
#include "server/encode/ensemble_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/shared/log.hpp"

namespace least::server {
namespace {

constexpr std::int64_t most_shards = 1'000'000;

std::optional<Shard> parse_shard(const std::string& text) {
  Shard shard;
  char slash = 0, more = 0;
  if (text.find_first_not_of("0123456789/") != std::string::npos) return std::nullopt;
  if (std::sscanf(text.c_str(), "%ld%c%ld%c", &shard.index, &slash, &shard.of, &more) != 3) return std::nullopt;
  const bool good = slash == '/' && shard.index >= 0 && shard.index < shard.of && shard.of <= most_shards;
  return good ? std::optional(shard) : std::nullopt;
}

std::int64_t blocks_of(const EnsemblePlan& plan, const Shard& shard) {
  const std::int64_t first = first_block(plan, shard);
  return first < plan.end_block() ? (plan.end_block() - 1 - first) / shard.of + 1 : 0;
}
std::string shard_line(const Shard& shard) {
  return fmt::format("{{\"kind\":\"shard\",\"index\":{},\"of\":{}}}\n", shard.index, shard.of);
}
std::string last_line_begun(std::int64_t blocks) {
  return fmt::format("{{\"kind\":\"end\",\"blocks\":{},\"crc32\":", blocks);
}
std::string last_line(std::int64_t blocks, const boost::crc_32_type& sum) {
  return fmt::format("{}{}}}\n", last_line_begun(blocks), sum.checksum());
}

// Pipes and devices are not opened: a part is read more than once, and some of them never end.
bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && !error;
}

// Limits of a line of a part: of its first two lines, and of a block of the plan.
constexpr std::size_t most_of_head = std::size_t{16} << 20;
std::size_t most_of_block(const EnsemblePlan& plan) {
  constexpr std::size_t names = std::size_t{1} << 20, longest = longest_number + 1;
  std::size_t numbers = plan.request.columns.size() * 5;
  for (const HistogramAsked& asked : plan.histograms) numbers += static_cast<std::size_t>(asked.bins);
  if (plan.final) numbers += static_cast<std::size_t>(block_size) * (1 + plan.request.columns.size());
  if (plan.trajectories)
    numbers += static_cast<std::size_t>(block_size) * (1 + row_count(plan) * plan.request.columns.size());
  if (plan.request.section)
    numbers += static_cast<std::size_t>(plan.request.most_points()) * (3 + plan.request.columns.size());
  return names + longest * numbers;
}

// PartLines reads the lines of a part and checks that they are unchanged.
class PartLines {
 public:
  explicit PartLines(const std::string& path) {
    if (is_file(path)) file_.open(path, std::ios::binary);
  }
  bool opened() const { return file_.is_open(); }
  // next reads a whole line without its end, of at most so many bytes.
  bool next(std::string& line, std::size_t most) {
    line.clear();
    for (auto byte = bytes().sbumpc(); byte != end; byte = bytes().sbumpc()) {
      if (byte == '\n') {
        sum_.process_bytes(line.data(), line.size());
        sum_.process_byte('\n');
        return true;
      }
      if (line.size() == most) return false;
      line += static_cast<char>(byte);
      if (line.front() != '{') return false;
    }
    return false;
  }
  // ends tells whether the last line follows, after so many blocks.
  bool ends(std::int64_t blocks) {
    const std::string wanted = last_line(blocks, sum_);
    std::string line;
    return next(line, wanted.size()) && line + '\n' == wanted && bytes().sgetc() == end;
  }

 private:
  static constexpr auto end = std::ifstream::traits_type::eof();
  std::filebuf& bytes() { return *file_.rdbuf(); }

  std::ifstream file_;
  boost::crc_32_type sum_;
};
bool is_whole(const std::string& path, const std::string& head, std::int64_t blocks, std::size_t most) {
  PartLines lines(path);
  std::string line, begun;
  while (begun.size() < head.size() && lines.next(line, head.size())) begun += line + '\n';
  if (begun != head) return false;
  for (std::int64_t i = 0; i < blocks; ++i)
    if (!lines.next(line, most)) return false;
  return lines.ends(blocks);
}
// has_an_end tells whether the last line is that of a part, as far as that is possible without reading the others.
bool has_an_end(const std::string& path, std::int64_t blocks) {
  constexpr std::streamoff most = 64;
  std::ifstream file(path, std::ios::binary);
  file.seekg(0, std::ios::end);
  file.seekg(std::max<std::streamoff>(static_cast<std::streamoff>(file.tellg()) - most, 0));
  const std::string tail{std::istreambuf_iterator<char>(file), {}};
  const auto at = tail.find('\n' + last_line_begun(blocks));
  return at != std::string::npos && tail.find("}\n", at) == tail.size() - 2;
}

// may_be_replaced tells whether a part may overwrite a file: none, another part, or an incomplete one. An NDJSON answer
// begins like a part; its second line differs.
bool may_be_replaced(const std::string& path) {
  constexpr std::string_view head = "{\"kind\":\"head\"", shard = "{\"kind\":\"shard\"";
  std::error_code error;
  const auto status = std::filesystem::symlink_status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return true;
  PartLines lines(path);
  if (!lines.opened()) return false;
  std::string first, second;
  const bool whole = lines.next(first, most_of_head);
  if (whole) lines.next(second, most_of_head);
  const auto begun = [](std::string_view line, std::string_view with) {
    return line.starts_with(with) || with.starts_with(line);
  };
  return begun(first, head) && (!whole || begun(second, shard));
}

// PartialFile gets its own name only when it is complete. Until then it is hidden, so that remains after a power cut do
// not match `part.*`, and its name contains host and process, as processes of several containers may have the same
// number.
class PartialFile {
 public:
  explicit PartialFile(std::string path) : path_(std::move(path)) {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    const std::filesystem::path whole(path_);
    const auto hidden = fmt::format(".{}.{}.{}.partial", whole.filename().string(), host.data(), ::getpid());
    name_ = (whole.parent_path() / hidden).string();
    file_ = std::fopen(name_.c_str(), "wb");
  }
  ~PartialFile() {
    if (file_) std::fclose(file_);
    if (!kept_) std::remove(name_.c_str());
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  bool write(std::string_view text) { return file_ && std::fwrite(text.data(), 1, text.size(), file_) == text.size(); }
  bool keep() {
    if (!file_ || std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) return false;
    return kept_ = std::rename(name_.c_str(), path_.c_str()) == 0;
  }

 private:
  std::string path_, name_;
  std::FILE* file_ = nullptr;
  bool kept_ = false;
};

Answer refused(std::string pointer, std::string detail, std::string allowed, std::string_view id) {
  Faults faults;
  faults.add({std::move(pointer), std::move(detail), {}, std::move(allowed)});
  return problem_document(faults, id);
}

// Part is a part that is being read: its first two lines, then block after block.
struct Part {
  std::string path;
  std::string pointer;  // to it, in the list of the parts
  PartLines lines;
  std::string head;
  Shard shard;
  bool damaged = false;
};

Part open_part(const std::string& path, std::size_t place, Faults& faults) {
  errno = 0;
  Part part{path, fmt::format("/parts/{}", place), PartLines(path), {}, {}};
  const int why = errno;
  const auto fault = [&](std::string_view what) {
    faults.add({part.pointer, fmt::format("{} {}", path, what), {}, {}});
    part.shard.of = 0;
  };
  std::string line;
  if (!part.lines.opened()) {
    std::error_code error;
    const bool other = std::filesystem::exists(path, error) && !is_file(path);
    fault(other ? "is no file: a part is read more than once"
                : "cannot be read: " + std::generic_category().message(why));
  } else if (!part.lines.next(part.head, most_of_head) || !part.lines.next(line, most_of_head)) {
    const bool object = part.head.empty() || part.head.front() == '{';
    const bool longer = std::max(part.head.size(), line.size()) >= most_of_head;
    fault(!object  ? "is no part of an ensemble"
          : longer ? "is no part of an ensemble: its first two lines are longer than those of any"
                   : "is truncated: it has no head");
  } else {
    const Json shard = Json::parse(line, nullptr, false);
    const auto number = [&](const char* key) {
      const Json* json = find(shard, key);
      return json && json->is_number_integer() ? json->get<std::int64_t>() : -1;
    };
    part.shard = {number("index"), number("of")};
    const auto [index, of] = part.shard;
    if (of < 1 || of > most_shards || index < 0 || index >= of) fault("is no part of an ensemble");
  }
  return part;
}

Result<EnsemblePlan, Faults> plan_of(const Part& part, const Cards& cards) {
  constexpr Caps caps{1e9, greatest_count, 1'000'000'000};  // the limits were checked where the part was computed
  auto parsed = parse_json(part.head);
  Faults faults;
  faults.add({part.pointer, part.path + " is no part of an ensemble of this version", {}, {}});
  if (!parsed || !parsed->tree.is_object()) return faults;
  parsed->tree.erase("kind");
  parsed->tree.erase("version");
  auto plan = decode_ensemble(std::move(*parsed), cards, caps);
  if (!plan || encode_ensemble_head(*plan, cards) != part.head + '\n') return faults;
  return plan;
}

// one_of_most returns a part of the ensemble to which most of the parts belong.
const Part& one_of_most(const std::vector<Part>& parts) {
  std::map<std::pair<std::string_view, std::int64_t>, int> counts;
  const auto count = [&](const Part& part) -> int& { return counts[{part.head, part.shard.of}]; };
  for (const Part& part : parts) ++count(part);
  return *std::ranges::max_element(parts, {}, count);
}

// check_parts notes faults of the parts as a set; none: they are all there, once.
void check_parts(const std::vector<Part>& parts, const Part& model, const EnsemblePlan& plan, Faults& faults) {
  const std::int64_t of = model.shard.of;
  std::vector<const Part*> seen(static_cast<std::size_t>(of));
  for (const Part& part : parts) {
    const auto fault = [&](std::string_view what) {
      faults.add({part.pointer, fmt::format("{}{}", part.path, what), {}, {}});
    };
    if (part.head != model.head) {
      fault(" is a part of another ensemble than " + model.path);
      continue;
    }
    if (part.shard.of != of) {
      fault(fmt::format(" is one of {} shards of this ensemble, and {} one of {}", part.shard.of, model.path, of));
      continue;
    }
    const Part*& place = seen[static_cast<std::size_t>(part.shard.index)];
    if (place) fault(fmt::format(" is shard {}/{}, and so is {}", part.shard.index, of, place->path));
    place = &part;
    if (!has_an_end(part.path, blocks_of(plan, part.shard))) fault(" is truncated");
  }
  std::string missing;
  constexpr int most_named = 100;
  int named = 0;
  for (std::size_t i = 0; i < seen.size() && named <= most_named; ++i) {
    if (!seen[i]) missing += ++named > most_named ? ", …" : fmt::format("{}{}/{}", named > 1 ? ", " : "", i, of);
  }
  if (!missing.empty()) faults.add({"", "there is no part for the shards " + missing, {}, {}});
}

// Logs the cost of a merge, which alone is not distributed, and what it would be for very large ensembles.
void tell_of_merge(std::int64_t blocks, double seconds) {
  const double of_one = seconds / static_cast<double>(blocks), members = 1e12;
  LogLine(spdlog::level::info, "merged")
      .with("blocks", blocks)
      .with("seconds", seconds)
      .with("microseconds_a_block", of_one * 1e6)
      .with("hours_for_1e12_members", of_one * (members / static_cast<double>(block_size)) / 3600);
}

}  // namespace

Answer write_part(const Context& context, const HttpRequest& request, const std::string& shard_text,
                  const std::string& output, unsigned threads) {
  const auto shard = parse_shard(shard_text);
  if (!shard)
    return refused("--shard", "must be I/N, not " + shard_text, "0/N, …, (N - 1)/N, N up to 1000000", request.id);
  if (output.empty()) return refused("--output", "is needed for one of several shards", "a file name", request.id);
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  const auto plan = decode_ensemble(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), request.id);
  const std::string head = encode_ensemble_head(*plan, context.cards) + shard_line(*shard);
  const std::int64_t blocks = blocks_of(*plan, *shard);
  const auto done = [&](std::string_view what) {
    return Answer{200, "text/plain", fmt::format("{}: {}\n", output, what), {}};
  };
  if (is_whole(output, head, blocks, most_of_block(*plan))) return done("is whole, nothing was computed");
  if (!may_be_replaced(output))
    return refused("--output", output + " is there and is no part of an ensemble: it would be lost",
                   "another name, or that of a part", request.id);
  PartialFile draft(output);
  boost::crc_32_type sum;
  bool written = true;
  const auto write = [&](const std::string& text) {
    sum.process_bytes(text.data(), text.size());
    return draft.write(text);
  };
  const auto write_block = [&](const Block& block) {
    TextPieces pieces = pieces_of_block(*plan, block);
    std::string text;
    for (bool more = true; more && written; text.clear()) {
      more = pieces(text);
      written = write(text);
    }
    return written;
  };
  written = write(head);
  if (!written) return problem_document(500, "cannot write " + output, request.id);
  const ReturnCode reason = run_ensemble(*plan, *shard, threads, context.cancelled, write_block, {}, &context.memory);
  if (written && reason == ReturnCode::memory)
    return problem_document(503, "a block of members needs more memory than --max-memory allows", request.id);
  if (written && reason != ReturnCode::completed) {
    return refused("/limits/seconds", fmt::format("ended early ({}): no part was written", name(reason)),
                   "a longer time, or smaller shards", request.id);
  }
  if (!written || !draft.write(last_line(blocks, sum)) || !draft.keep())
    return problem_document(500, "cannot write " + output, request.id);
  return done(fmt::format("{} blocks", blocks));
}

Answer merge_parts(const Cards& cards, const std::vector<std::string>& paths, std::string_view id) {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0) {  // all parts are open at once, as blocks are read in order
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
  }
  const auto start = std::chrono::steady_clock::now();
  Faults faults;
  std::vector<Part> parts;
  parts.reserve(paths.size());
  for (const std::string& path : paths) parts.push_back(open_part(path, parts.size(), faults));
  std::erase_if(parts, [](const Part& part) { return part.shard.of == 0; });
  if (parts.empty()) return problem_document(faults, id);
  const Part& model = one_of_most(parts);
  const auto plan = plan_of(model, cards);
  if (!plan) return problem_document(faults.empty() ? plan.error() : faults, id);
  check_parts(parts, model, *plan, faults);
  if (!faults.empty()) return problem_document(faults, id);
  std::ranges::sort(parts, {}, [](const Part& part) { return part.shard.index; });

  Harvest all;
  std::string line;
  const std::size_t most = most_of_block(*plan);
  const auto damaged = [&](Part& part, const std::string& how) {
    faults.add({part.pointer, fmt::format("{} is damaged: {}", part.path, how), {}, {}});
    part.damaged = true;
  };
  for (std::int64_t b = plan->first_block(); b < plan->end_block(); ++b) {
    Part& part = parts[static_cast<std::size_t>(b) % parts.size()];
    if (part.damaged) continue;
    const auto block =
        part.lines.next(line, most) ? read_ensemble_block(*plan, Json::parse(line, nullptr, false)) : std::nullopt;
    if (!block || block->index != b) {
      damaged(part, fmt::format("block {} is not there", b));
    } else if (faults.empty()) {
      all.add(block->harvest, static_cast<std::size_t>(plan->request.most_points()));
    }
  }
  for (Part& part : parts)
    if (!part.damaged && !part.lines.ends(blocks_of(*plan, part.shard))) damaged(part, "it is not what was written");
  if (!faults.empty()) return problem_document(faults, id);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  tell_of_merge(plan->end_block() - plan->first_block(), seconds);
  const std::atomic<bool> never{false};
  // The parts do not say how long their members took, so that the cost has no time.
  const EnsembleEnd end{ReturnCode::completed, unknown, warnings_of_few(*plan, never)};
  return {200, "application/json", encode_ensemble(*plan, cards, all, end), {}};
}

}  // namespace least::server

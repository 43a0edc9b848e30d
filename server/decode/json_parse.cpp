#include "server/decode/json_parse.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "server/shared/json_writer.hpp"

namespace least::server {
namespace {

// block returns what the allocator takes for so many bytes.
constexpr std::size_t block(std::size_t bytes) { return std::max<std::size_t>(32, (bytes + 23) / 16 * 16); }
// beside returns what a string takes outside of its object.
std::size_t beside(const std::string& text) { return text.capacity() > 15 ? block(text.capacity() + 1) : 0; }

// more returns by how much a list of such elements grows.
template <class Element>
constexpr std::size_t more(std::size_t from, std::size_t to) {
  return block(to * sizeof(Element)) - (from > 0 ? block(from * sizeof(Element)) : 0);
}

// Builder builds the tree while the text is parsed, and checks every limit before the tree grows.
class Builder final : public nlohmann::json_sax<Json> {
 public:
  // With `builds` false it only checks, and keeps nothing but keys.
  Builder(const JsonBounds& bounds, Faults& faults, bool builds, MemoryBudget* memory)
      : held(memory), bounds_(bounds), faults_(faults), builds_(builds) {
    levels_.reserve(4);
  }

  bool null() override { return value(nullptr); }
  bool boolean(bool x) override { return value(x); }
  bool number_integer(number_integer_t x) override { return value(x); }
  bool number_unsigned(number_unsigned_t x) override { return value(x); }
  bool number_float(number_float_t x, const string_t&) override { return value(x); }
  bool string(string_t& x) override { return holds(block(sizeof x) + beside(x)) && value(std::move(x)); }
  bool binary(binary_t&) override { return false; }  // text has no binary values

  bool start_object(std::size_t) override { return open(Json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    auto& level = levels_.back();
    level.key = std::move(name);
    if (!holds(beside(level.key)) || !widen(level.node.get_ref<Json::object_t&>())) return false;
    if ((looks_ += level.node.size()) > bounds_.looks) return broken("objects of too many keys together");
    if (level.node.contains(level.key)) {
      faults_.add({pointer_here(), "the key stands twice", "", ""});
    } else if (level.node.size() >= bounds_.keys) {
      return broken("an object with more than " + std::to_string(bounds_.keys) + " keys");
    }
    return true;
  }

  bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception& e) override {
    error_at = position;
    error_token = token;
    overflow = e.id == 406;
    if (overflow) {
      if (!levels_.empty()) ++levels_.back().index;
      faults_.add({pointer_here(), "the number does not fit a double", "", "a finite number"});
    } else {
      // The message reads "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while …"; its
      // tail is what matters.
      const std::string_view what = e.what();
      const auto tail = what.find(": ");
      detail = clipped(tail == what.npos ? what : what.substr(tail + 2), 200);
    }
    return false;
  }

  Json tree;
  std::size_t error_at = 0;
  std::string error_token, detail;
  Held held;
  bool overflow = false, bound_broken = false, no_memory = false;

 private:
  // Level is a list or an object that is not closed yet.
  struct Level {
    Json node;
    std::size_t index = 0;  // in a list: elements so far, the current one included
    std::string key{};      // in an object: the current key
  };

  std::string pointer_here() const {
    std::string path;
    for (const Level& level : levels_) {
      path += level.node.is_object() ? pointer_step(level.key) : "/" + std::to_string(level.index - 1);
    }
    return path;
  }
  bool step() {
    if (!levels_.empty()) ++levels_.back().index;
    return ++values_ <= bounds_.values || broken("more than " + std::to_string(bounds_.values) + " values");
  }
  // holds charges so many bytes more, and tells whether there was memory.
  bool holds(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ > small_tree && !held.grow_to((bytes_ + small_tree - 1) / small_tree * small_tree)) no_memory = true;
    return !no_memory;
  }
  // widen makes room for one more member; growing by itself, an object would copy all of its content.
  bool widen(Json::object_t& object) {
    if (object.size() < object.capacity()) return true;
    using Container = Json::object_t::Container;
    const std::size_t room = std::max<std::size_t>(4, 2 * object.size());
    if (!holds(more<Container::value_type>(object.capacity(), room))) return false;
    Container wider;
    wider.reserve(room);
    for (auto& [name, value] : object) wider.emplace_back(name, std::move(value));
    static_cast<Container&>(object).swap(wider);
    return true;
  }
  bool widen(Json::array_t& list) {
    if (list.size() < list.capacity()) return true;
    const std::size_t room = std::max<std::size_t>(2, 2 * list.size());
    if (!holds(more<Json>(list.capacity(), room))) return false;
    list.reserve(room);
    return true;
  }
  bool put(Json&& json) {
    if (!builds_) json = nullptr;
    if (levels_.empty()) {
      tree = std::move(json);
    } else if (auto& [node, index, name] = levels_.back(); node.is_object()) {
      node[name] = std::move(json);
    } else if (builds_) {
      if (!widen(node.get_ref<Json::array_t&>())) return false;
      node.push_back(std::move(json));
    }
    return true;
  }
  bool value(Json&& json) { return step() && put(std::move(json)); }
  bool open(Json&& empty) {
    if (!step() || !holds(block(sizeof(Json::array_t)))) return false;
    if (static_cast<int>(levels_.size()) >= bounds_.depth) {
      return broken("nested deeper than " + std::to_string(bounds_.depth) + " levels");
    }
    levels_.push_back({std::move(empty)});
    return true;
  }
  bool close() {
    Json whole = std::move(levels_.back().node);
    levels_.pop_back();
    return put(std::move(whole));
  }
  bool broken(std::string what) {
    bound_broken = true;
    faults_.add({pointer_here(), std::move(what), "", ""});
    return false;
  }

  const JsonBounds& bounds_;
  Faults& faults_;
  const bool builds_;
  std::vector<Level> levels_;
  std::size_t values_ = 0, bytes_ = 0, looks_ = 0;
};

struct ForeignWord {
  std::string_view word, why;
};
// What other languages write, and why it is not JSON.
constexpr ForeignWord foreign[] = {
    {"NaN", "NaN is not JSON, whose numbers are finite"},
    {"nan", "nan is not JSON, whose numbers are finite"},
    {"Infinity", "Infinity is not JSON, whose numbers are finite"},
    {"-Infinity", "Infinity is not JSON, whose numbers are finite"},
    {"inf", "inf is not JSON, whose numbers are finite"},
    {"None", "None is not JSON, which says null"},
    {"True", "True is not JSON, which says true"},
    {"False", "False is not JSON, which says false"},
    {"'", "a string of JSON stands in double quotes"},
    {"//", "JSON has no comments"},
    {"/*", "JSON has no comments"},
};

std::string why_not_json(std::string_view text, std::size_t byte, std::string said) {
  constexpr std::string_view in_words = "\\_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  const auto in_word = [&](std::size_t at) { return at < text.size() && in_words.find(text[at]) != in_words.npos; };
  // The parser consumes a possible literal before it fails: `na` of `nan`, for null; a minus, for a number.
  for (std::size_t back = 0; back <= std::min<std::size_t>(byte, 2); ++back)
    for (const auto& [word, why] : foreign) {
      const std::size_t from = byte - back;
      if (back >= word.size() || !text.substr(from).starts_with(word) || (from > 0 && in_word(from - 1))) continue;
      if (word.back() < 'A' || !in_word(from + word.size())) return std::string(why);
    }
  return said;
}

}  // namespace

Result<ParsedJson, NotJson> parse_json(std::string_view text, const JsonBounds& bounds, MemoryBudget* memory) {
  // The parser takes a zero byte for the end of the text and would ignore what follows.
  if (const auto zero = text.find('\0'); zero != text.npos) return NotJson{zero, "a zero byte"};
  ParsedJson parsed;
  std::string patched;             // a copy in which overflowing numbers are replaced by 0, so that parsing can go on
  std::optional<Builder> builder;  // of one pass; destroyed before the next
  for (std::size_t overflows = 0;; ++overflows) {
    builder.emplace(bounds, parsed.faults, overflows == 0, memory);
    bool whole = Json::sax_parse(text, &*builder);
    if (whole && overflows > 0) {
      builder.emplace(bounds, parsed.faults, true, memory);
      whole = Json::sax_parse(text, &*builder);
    }
    if (builder->no_memory) return NotJson{0, "", true};
    if (whole) {
      parsed.tree = std::move(builder->tree);
      parsed.held = std::move(builder->held);
      return parsed;
    }
    if (builder->bound_broken) return parsed;
    const std::size_t length = builder->error_token.size();
    const std::size_t start = builder->error_at - std::min(builder->error_at, length);
    if (!builder->overflow) {
      const std::size_t byte = builder->error_at == 0 ? 0 : builder->error_at - 1;
      return NotJson{byte, why_not_json(text, std::min(byte, text.size()), builder->detail)};
    }
    // Each overflow costs a pass: stop where further faults would help nobody.
    if (overflows == 16 || text.substr(start, length) != builder->error_token) return parsed;
    if (patched.empty()) patched = text;
    patched.replace(start, length, std::string(length, ' ')).replace(start, 1, "0");
    text = patched;
  }
}

std::string pointer_step(std::string_view key) {
  std::string step = "/";
  const std::string_view kept = clipped(key, 80);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::size_t from = i;
    while (i < kept.size() && kept[i] != '~' && kept[i] != '/') ++i;
    step.append(kept, from, i - from);
    if (i < kept.size()) step += kept[i] == '~' ? "~0" : "~1";
  }
  if (kept.size() < key.size()) step += "…";
  return step;
}

std::string shown(const Json& value) {
  if (value.is_structured() || value.is_binary() || value.is_discarded()) return {};
  std::string out;
  if (value.is_number_float()) append_number(out, value.get<double>());
  if (!value.is_string()) return out.empty() ? value.dump() : out;
  const auto& text = value.get_ref<const std::string&>();
  const std::string_view kept = clipped(text, 80);
  append_string(out, kept.size() < text.size() ? std::string(kept) + "…" : std::string(kept));
  return out;
}

std::string_view clipped(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0) == 0x80) --bytes;
  return text.substr(0, bytes);
}

}  // namespace least::server

// Writes JSON directly into a string: without a tree, with the shortest numbers that read back to the same double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace least::server {

/// The most characters of a number.
inline constexpr std::size_t longest_number = 24;

/// write_number writes a number of at most longest_number bytes and returns its end; values that are not finite become
/// `null`. Minus zero is written `-0.0`, as readers take a bare `-0` for an integer.
char* write_number(char* at, double x);

/// append_number appends a number likewise, after a comma if wanted.
void append_number(std::string& out, double x, bool comma = false);
void append_number(std::string& out, std::int64_t n, bool comma = false);

/// append_string appends a quoted string. `ascii` also escapes everything beyond ASCII (for header fields).
void append_string(std::string& out, std::string_view text, bool ascii = false);
/// Separators are a comma before and a colon after a string.
struct Separators {
  bool comma = false, colon = false;
};
void append_string(std::string& out, std::string_view text, Separators around, bool ascii);

/// append_cbor_head appends the head of a CBOR item (RFC 8949, 3): its major type and argument.
void append_cbor_head(std::string& out, unsigned major, std::uint64_t number);
/// append_cbor appends a number as binary64; values that are not finite become null, as in JSON.
void append_cbor(std::string& out, double x);

/// Notation of the values: JSON, JSON in plain ASCII, or the same data in CBOR, with lists and maps of indefinite
/// length.
enum class Notation { json, ascii, cbor };

/// JsonWriter inserts separators itself: keys and values know whether they come first.
class JsonWriter {
 public:
  /// `first`: the open object or list is still empty.
  explicit JsonWriter(std::string& out, Notation notation = Notation::json, bool first = true)
      : out_(out), notation_(notation), first_(first) {}

  JsonWriter& open(char bracket) {
    comma();
    out_ += cbor() ? static_cast<char>(bracket == '{' ? 0xBF : 0x9F) : bracket;
    first_ = true;
    return *this;
  }
  JsonWriter& close(char bracket) {
    out_ += cbor() ? static_cast<char>(0xFF) : bracket;
    first_ = false;
    return *this;
  }
  JsonWriter& key(std::string_view name) {
    string(name, true);
    first_ = true;
    return *this;
  }
  JsonWriter& text(std::string_view value) { return string(value, false); }
  JsonWriter& number(double value) {
    const bool comma = comes_after();
    cbor() ? append_cbor(out_, value) : append_number(out_, value, comma);
    return *this;
  }
  JsonWriter& integer(std::int64_t value) {
    const bool comma = comes_after();
    if (cbor()) {
      append_cbor_head(out_, value < 0 ? 1 : 0, static_cast<std::uint64_t>(value < 0 ? -1 - value : value));
    } else {
      append_number(out_, value, comma);
    }
    return *this;
  }
  JsonWriter& boolean(bool value) { return cbor() ? byte(value ? 0xF5 : 0xF4) : raw(value ? "true" : "false"); }
  JsonWriter& null() { return cbor() ? byte(0xF6) : raw("null"); }
  /// raw writes JSON text that must be well-formed; not in CBOR.
  JsonWriter& raw(std::string_view json) {
    comma();
    out_ += json;
    return *this;
  }
  std::string& buffer() { return out_; }
  Notation notation() const { return notation_; }

 private:
  bool cbor() const { return notation_ == Notation::cbor; }
  JsonWriter& byte(unsigned char value) {
    out_ += static_cast<char>(value);
    first_ = false;
    return *this;
  }
  JsonWriter& string(std::string_view value, bool colon) {
    const bool comma = comes_after();
    if (cbor()) {
      append_cbor_head(out_, 3, value.size());
      out_ += value;
    } else {
      append_string(out_, value, {comma, colon}, notation_ == Notation::ascii);
    }
    return *this;
  }
  /// comes_after() tells whether the next item is not the first, and marks that one follows.
  bool comes_after() { return !std::exchange(first_, false); }
  void comma() {
    if (comes_after() && !cbor()) out_ += ',';
  }
  std::string& out_;
  Notation notation_;
  bool first_;
};

/// write_texts writes a list of texts.
template <class Texts>
void write_texts(JsonWriter& json, const Texts& texts) {
  json.open('[');
  for (const auto& text : texts) json.text(text);
  json.close(']');
}

}  // namespace least::server

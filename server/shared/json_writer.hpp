// JSON written straight into a string: no tree, shortest numbers that read back to the same double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace least::server {

/// No number is longer.
inline constexpr std::size_t longest_number = 24;

/// Writes a number into so many bytes and returns where it ends; what is not finite becomes `null`. Minus zero is
/// `-0.0`: a reader takes a bare `-0` for an integer.
char* write_number(char* at, double x);

/// Appends a number, the same way.
void append_number(std::string& out, double x, bool comma = false);
void append_number(std::string& out, std::int64_t n, bool comma = false);

/// Appends a quoted string. `ascii` escapes everything beyond ASCII too (for header fields).
void append_string(std::string& out, std::string_view text, bool ascii = false);
/// What stands before and after it.
struct Separators {
  bool comma = false, colon = false;
};
void append_string(std::string& out, std::string_view text, Separators around, bool ascii);

/// The head of an item of CBOR (RFC 8949, 3): its major type and its number.
void append_cbor_head(std::string& out, unsigned major, std::uint64_t number);
/// A number as binary64; what is not finite becomes null, as in JSON.
void append_cbor(std::string& out, double x);

/// What the values are written as: JSON, the same in plain ASCII, or the same data model in CBOR, its lists and maps of
/// indefinite length.
enum class Notation { json, ascii, cbor };

/// Separators are put by the writer: `key` and the values know whether they come first.
class JsonWriter {
 public:
  /// `first`: nothing stands yet in what is open.
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
  /// JSON text that is known to be well-formed; not in CBOR.
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
  /// Whether something stands before what comes now.
  bool comes_after() { return !std::exchange(first_, false); }
  void comma() {
    if (comes_after() && !cbor()) out_ += ',';
  }
  std::string& out_;
  Notation notation_;
  bool first_;
};

/// A list of texts.
template <class Texts>
void write_texts(JsonWriter& json, const Texts& texts) {
  json.open('[');
  for (const auto& text : texts) json.text(text);
  json.close(']');
}

}  // namespace least::server

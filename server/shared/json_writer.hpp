// JSON written straight into a string: no tree, shortest numbers that read back to the same double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace least::server {

/// No number is longer.
inline constexpr std::size_t longest_number = 24;

/// Writes a number and returns where it ends; what is not finite becomes `null`. Minus zero is `-0.0`: a reader takes a
/// bare `-0` for an integer.
char* write_number(char* at, double x);

/// Appends a number, the same way.
void append_number(std::string& out, double x);
void append_number(std::string& out, std::int64_t n);

/// Appends a quoted string. `ascii` escapes everything beyond ASCII too (for header fields).
void append_string(std::string& out, std::string_view text, bool ascii = false);

/// Separators are put by the writer: `key` and the values know whether they come first.
class JsonWriter {
 public:
  explicit JsonWriter(std::string& out, bool ascii = false) : out_(out), ascii_(ascii) {}

  JsonWriter& open(char bracket) {
    comma();
    out_ += bracket;
    first_ = true;
    return *this;
  }
  JsonWriter& close(char bracket) {
    out_ += bracket;
    first_ = false;
    return *this;
  }
  JsonWriter& key(std::string_view name) {
    comma();
    append_string(out_, name, ascii_);
    out_ += ':';
    first_ = true;
    return *this;
  }
  JsonWriter& text(std::string_view value) {
    comma();
    append_string(out_, value, ascii_);
    return *this;
  }
  JsonWriter& number(double value) {
    comma();
    append_number(out_, value);
    return *this;
  }
  JsonWriter& integer(std::int64_t value) {
    comma();
    append_number(out_, value);
    return *this;
  }
  JsonWriter& boolean(bool value) { return raw(value ? "true" : "false"); }
  JsonWriter& null() { return raw("null"); }
  /// JSON text that is known to be well-formed.
  JsonWriter& raw(std::string_view json) {
    comma();
    out_ += json;
    return *this;
  }
  std::string& buffer() { return out_; }

 private:
  void comma() {
    if (!first_) out_ += ',';
    first_ = false;
  }
  std::string& out_;
  bool ascii_;
  bool first_ = true;
};

}  // namespace least::server

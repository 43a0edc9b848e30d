#include "server/http/gzip.hpp"

#include <zlib.h>

#include <array>
#include <new>
#include <utility>

#include "server/http/accept.hpp"

namespace least::server {
namespace {

// The content is numbers: higher levels take many times as long and save a tenth.
constexpr int fast = 1;

class Deflater {
 public:
  explicit Deflater(int level) {
    constexpr int window = 15, as_gzip = 16, memory = 8;
    if (::deflateInit2(&stream_, level, Z_DEFLATED, window + as_gzip, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { ::deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  std::string add(std::string_view text, int flush) {
    std::string out;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream_.avail_in = static_cast<uInt>(text.size());
    do {
      std::array<char, 16 * 1024> block;
      stream_.next_out = reinterpret_cast<Bytef*>(block.data());
      stream_.avail_out = block.size();
      ::deflate(&stream_, flush);
      out.append(block.data(), block.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
    return out;
  }

 private:
  z_stream stream_{};
};

}  // namespace

bool takes_gzip(std::string_view accept_encoding) {
  constexpr std::array<std::string_view, 2> codings{"gzip", "identity"};
  return !accept_encoding.empty() && negotiate(accept_encoding, codings) == 0;
}

bool worth_gzip(std::string_view media_type, std::size_t bytes) {
  const bool packed = media_type.starts_with("image/png") || media_type.starts_with("font/");
  return bytes >= 1024 && !packed;
}

std::string gzipped(std::string_view text, int level) { return Deflater(level).add(text, Z_FINISH); }

void compress(Answer& answer) {
  if (answer.stream) {
    answer.begins = {};
    answer.stream = [whole = std::move(answer.stream)](const Write& write) {
      Deflater deflater(fast);
      auto end = whole([&](std::string_view text) { return text.empty() || write(deflater.add(text, Z_SYNC_FLUSH)); });
      if (end) end = deflater.add(*end, Z_FINISH);
      return end;
    };
  } else if (answer.pieces) {
    const auto deflater = std::make_shared<Deflater>(fast);
    answer.pieces = [deflater, text = std::string(), next = std::move(answer.pieces)](std::string& out) mutable {
      text.clear();
      const bool more = next(text);
      out += deflater->add(text, more ? Z_NO_FLUSH : Z_FINISH);
      return more;
    };
  } else if (worth_gzip(answer.type, answer.body.size())) {
    answer.body = gzipped(answer.body, fast);
  } else {
    return;
  }
  answer.headers.emplace_back("Content-Encoding", "gzip");
}

}  // namespace least::server

// One run from the text of a request to its answer; HTTP and the command line share it.
#pragma once

#include <atomic>
#include <span>
#include <string_view>

#include "server/decode.hpp"
#include "server/encode.hpp"
#include "server/gate.hpp"

namespace least::server {

/// A form of the answer. A further one is a further entry of `forms`.
struct Form {
  std::string_view type;  ///< media type
  Answer (*encode)(const Run&);
};

/// All forms, the default first.
std::span<const Form> forms();

/// What runs share.
struct Simulator {
  Cards cards;
  Caps caps;
  Gate& gate;
  const std::atomic<bool>& cancelled;

  /// 200, 400 (no JSON), 406, 422 or 503. Throws when memory is out or the core has a bug.
  Answer operator()(std::string_view body, std::string_view accept, std::string_view request_id) const;
};

/// The catalogue of the library.
Cards catalogue_cards();

}  // namespace least::server

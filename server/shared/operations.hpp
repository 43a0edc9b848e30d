// The operations of the service in one table, from which the index and the OpenAPI document are generated.
#pragma once

#include <span>
#include <string_view>

namespace least::server {

struct Operation {
  std::string_view method, path, title;
};

/// In the order of the document.
inline std::span<const Operation> operations() {
  static constexpr Operation all[] = {
      {"POST", "/v1/simulate", "one run"},
      {"POST", "/v1/work-precision", "what accuracy costs with each scheme, measured"},
      {"POST", "/v1/stability", "the largest stable step of schemes on a scene"},
      {"POST", "/v1/ensemble", "many runs of one scene: statistics, final states, sections"},
      {"POST", "/v1/periodic", "a closed orbit near a guess: its multipliers, its family, its manifolds"},
      {"POST", "/v1/problems", "the card of a scene given as text: its form, what it keeps, the schemes that apply"},
      {"GET", "/v1/catalogue", "every problem and every scheme, with all their parameters"},
      {"GET", "/v1/problems", "problems by id"},
      {"GET", "/v1/problems/{id}", "the card of a problem"},
      {"GET", "/v1/schemes", "schemes by id"},
      {"GET", "/v1/schemes/{id}", "the card of a scheme"},
      {"GET", "/v1/openapi.json", "this interface as OpenAPI 3.1"},
      {"GET", "/healthz", "whether the service lives"},
      {"GET", "/readyz", "whether it takes requests: not while it ends, nor with a full queue"},
      {"GET", "/metrics", "what it does, as text for Prometheus"},
  };
  return all;
}

}  // namespace least::server

#include "server/service.hpp"

#include "server/encode/catalogue_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/ensemble.hpp"
#include "server/simulate.hpp"
#include "server/study.hpp"

namespace least::server {
namespace {

struct ComputedRoute {
  std::string_view path;
  Endpoint answer;
};
constexpr ComputedRoute computed_routes[] = {{"/v1/simulate", simulate},
                                             {"/v1/work-precision", measure_work_precision},
                                             {"/v1/stability", measure_stability},
                                             {"/v1/ensemble", run_ensemble_request}};

void add_texts(Router& router, const Cards& cards) {
  constexpr std::string_view json = "application/json";
  CatalogueText text = describe(cards);
  router.add_text("/v1/catalogue", "/v1/catalogue", json, std::move(text.all) + '\n');
  for (auto& [id, body] : text.problems) {
    router.add_text("/v1/problems/" + id, "/v1/problems/{id}", json, std::move(body) + '\n');
  }
  for (auto& [id, body] : text.schemes) {
    router.add_text("/v1/schemes/" + id, "/v1/schemes/{id}", json, std::move(body) + '\n');
  }
  router.add_text("/healthz", "/healthz", json, "{\"status\":\"ok\"}\n");
}

}  // namespace

Service::Service(const Settings& settings, std::span<const Asset> assets)
    : http_(settings, problem_document),
      context_{catalogue_cards(), settings.caps, http_.admission(), http_.cancelled()} {
  Router& router = http_.router();
  for (const Asset& asset : assets) router.add_page(asset);
  add_texts(router, context_.cards);
  for (const ComputedRoute& route : computed_routes) {
    router.add_computed(
        route.path, [this, answer = route.answer](const HttpRequest& request) { return answer(context_, request); });
  }
}

}  // namespace least::server

#include "server/service.hpp"

#include <algorithm>
#include <utility>

#include "core/catalogue/catalogue.hpp"
#include "core/number/asked_by_thread.hpp"
#include "core/tape/tape.hpp"
#include "core/text/text_work.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/wording.hpp"
#include "server/encode/catalogue_json.hpp"
#include "server/encode/index_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/ensemble.hpp"
#include "server/openapi.hpp"
#include "server/periodic.hpp"
#include "server/problems.hpp"
#include "server/shared/log.hpp"
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
                                             {"/v1/ensemble", run_ensemble_request},
                                             {"/v1/periodic", close_orbit_request},
                                             {"/v1/problems", describe_scene}};

void add_texts(Router& router, const Cards& cards, const Caps& caps) {
  constexpr std::string_view json = "application/json";
  CatalogueText text = describe(cards);
  router.add_text("/v1/catalogue", "/v1/catalogue", json, std::move(text.all) + '\n');
  for (auto& [id, body] : text.problems) {
    router.add_text("/v1/problems/" + id, "/v1/problems/{id}", json, std::move(body) + '\n');
  }
  for (auto& [id, body] : text.schemes) {
    router.add_text("/v1/schemes/" + id, "/v1/schemes/{id}", json, std::move(body) + '\n');
  }
  router.add_text("/v1", "/v1", json, write_index());
  router.add_text("/v1/openapi.json", "/v1/openapi.json", json, write_openapi(cards, caps));
  router.add_text("/v1/problems", "/v1/problems", json, list_problems(cards));
  router.add_text("/v1/schemes", "/v1/schemes", json, list_schemes(cards));
}

// Scenes with too many operations are normally refused with a specific message. A case that was not foreseen is still a
// limit of the scene, not a fault of the service.
Answer too_many_operations(std::string_view request_id) {
  Faults faults;
  faults.add({"/problem", "what is asked takes more operations than may be derived from a scene", {}, {}});
  return problem_document(faults, request_id);
}
// Texts of a scene are written out while a request is read. That work has one bound for all of them, and ends where the
// client has gone or the service ends.
Prepared read_by(Endpoint endpoint, const Context& context, const HttpRequest& request) {
  const CancellationWatch watch(context.cancelled, request.gone, context.caps.seconds);
  const AskedByThread asked([&] { return !watch.cancelled(); });
  const text::TextWork work;
  Prepared made = endpoint(context, request);
  if (!watch.cancelled()) return made;
  return busy(context, request,
              watch.timed_out() ? "reading the request takes longer than a request may take" : "the service ends");
}
Prepared prepared(Endpoint endpoint, const Context& context, const HttpRequest& request) try {
  Prepared made = read_by(endpoint, context, request);
  auto* const job = std::get_if<Job>(&made);
  if (!job) return made;
  return Job([job = std::move(*job), id = std::string(request.id)](Admission::Pass pass) {
    try {
      return job(std::move(pass));
    } catch (const tape::TooManyOperations&) {
      return too_many_operations(id);
    }
  });
} catch (const tape::TooManyOperations&) {
  return too_many_operations(request.id);
}

// hint returns a path that may have been meant, or what to send there.
std::string hint(const Cards& cards, int status, std::string_view path) {
  if (status == 405) {
    const Json example = example_of(path, cards);
    return example.is_null() ? std::string() : "; POST it a request, like " + example.dump();
  }
  std::vector<std::string> known{"/v1/catalogue", "/v1/problems", "/v1/schemes", "/v1/openapi.json"};
  for (const ComputedRoute& route : computed_routes) known.emplace_back(route.path);
  const auto last = path.rfind('/');
  for (const auto& [folder, ids] : {std::pair{std::string("/v1/problems/"), names_of(cards.problems)},
                                    std::pair{std::string("/v1/schemes/"), names_of(cards.schemes)}}) {
    if (path.substr(0, last + 1) != folder) continue;
    const auto id = closest(path.substr(last + 1), ids);
    return id.empty() ? "; " + folder.substr(0, folder.size() - 1) + " lists what there is"
                      : "; did you mean \"" + folder + std::string(id) + "\"?";
  }
  return did_you_mean(path, Names(known.begin(), known.end()));
}

/// error_of answers an error that concerns a request as a whole.
Answer error_of(int status, std::string_view detail, std::string_view request_id) {
  if (status != 422) return problem_document(status, detail, request_id);
  Faults faults;
  faults.add({"", std::string(detail), {}, {}});
  return problem_document(faults, request_id);
}

}  // namespace

// The first block of an answer doubles as it grows, so that its memory exceeds its numbers a little; and a part is on
// its way as text.
std::size_t memory_for(const Settings& settings) {
  const std::size_t largest_answer =
      (static_cast<std::size_t>(settings.caps.samples) + (1 << 17)) * sizeof(double) + most_of_a_stream;
  return std::max(settings.max_memory, largest_answer);
}

Service::Service(const Settings& settings, std::span<const Asset> assets)
    : memory_(memory_for(settings)),
      http_(settings, error_of, &memory_),
      context_{catalogue_cards(), settings.caps, http_.admission(), http_.cancelled(), memory_} {
  Router& router = http_.router();
  for (const Asset& asset : assets) router.add_page(asset);
  add_texts(router, context_.cards, context_.caps);
  add_probes(router);
  router.add_glance(effort_of);
  router.add_hint([this](int status, std::string_view path) { return hint(context_.cards, status, path); });
  for (const ComputedRoute& route : computed_routes) {
    router.add_computed(route.path, [this, answer = route.answer](const HttpRequest& request) {
      return prepared(answer, context_, request);
    });
  }
}

void Service::add_probes(Router& router) {
  constexpr std::string_view json = "application/json";
  router.add_probe("/healthz", [=](std::string_view) {
    return Answer{200, std::string(json), "{\"status\":\"ok\"}\n", {}};
  });
  router.add_probe("/readyz", [=, this](std::string_view request_id) {
    if (http_.leaving()) return problem_document(503, "the service ends", request_id);
    if (http_.admission().load().full) return problem_document(503, "the queue is full", request_id);
    return Answer{200, std::string(json), "{\"status\":\"ready\"}\n", {}};
  });
  const auto metrics = [this](std::string_view) {
    const auto load = http_.admission().load();
    Gauges gauges{load.running, load.waiting, load.parked, http_.connections(), memory_.held()};
    gauges.most_running = http_.admission().places();
    gauges.most_waiting = http_.admission().queue();
    gauges.most_connections = http_.settings().connections;
    gauges.most_bytes = memory_.most();
    gauges.dropped_log_lines = dropped_log_lines();
    gauges.version = version;
    return Answer{200, "text/plain; version=0.0.4; charset=utf-8", http_.metrics().text(gauges), {}};
  };
  router.add_probe("/metrics", metrics, http_.settings().metrics_port >= 0);
}

}  // namespace least::server

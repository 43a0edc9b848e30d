#include "server/ensemble.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "server/decode/ensemble_request.hpp"
#include "server/encode/ensemble_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

using Passes = std::vector<Admission::Pass>;

// One place was waited for, as for a run; of those that are free besides, up to half of all are taken, too.
Passes places(const Context& context, const HttpRequest& request, Admission::Pass&& first) {
  Passes passes;
  passes.push_back(std::move(first));
  while (auto more = context.admission.enter_besides(request.client)) passes.push_back(std::move(*more));
  return passes;
}

std::size_t bytes_of(const Harvest& all) {
  const SectionPoints& points = all.section;
  return sizeof(double) * (all.final.size() + all.final_member.size() + points.values.size() + 3 * points.t.size());
}

// The whole of it; `seen` takes the blocks in their order, false ends it.
template <class Seen>
std::pair<Harvest, EnsembleEnd> compute(const EnsemblePlan& plan, const Context& context,
                                        const std::function<bool()>& gone, unsigned threads, Seen&& seen) {
  std::pair<Harvest, EnsembleEnd> result;
  const auto start = std::chrono::steady_clock::now();
  const CancellationWatch watch(context.cancelled, gone);
  result.second.reason = run_ensemble(plan, {}, threads, watch.cancelled(), [&](const Block& block) {
    result.first.add(block.harvest, static_cast<std::size_t>(plan.request.limits.samples));
    return seen(result.first, block);
  });
  result.second.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

// Nothing but sums is kept: each block leaves as it comes.
struct EnsembleStream {
  const Context& context;
  EnsemblePlan plan;
  std::function<bool()> gone;
  Passes passes;

  std::optional<std::string> operator()(const Write& write) {
    bool taken = write(encode_ensemble_head(plan, context.cards));
    if (!taken) return std::nullopt;
    std::int64_t points = 0;
    const auto [all, end] =
        compute(plan, context, gone, static_cast<unsigned>(passes.size()), [&](Harvest& sums, const Block& block) {
          Block shown = block;
          SectionPoints first;  // those that still may be kept
          const auto most = plan.request.limits.samples - points;
          first.append(block.harvest.section, static_cast<std::size_t>(most), plan.request.columns.size());
          points += static_cast<std::int64_t>(first.t.size());
          shown.harvest.section = std::move(first);
          sums.truncated = sums.truncated || shown.harvest.section.t.size() < block.harvest.section.t.size();
          sums.section = {};
          sums.final = {};
          sums.final_member = {};
          return taken = write(encode_ensemble_block(plan, shown));
        });
    passes.clear();
    return taken ? std::optional(encode_ensemble_end(plan, all, end)) : std::nullopt;
  }
};

constexpr std::string_view in_lines = "application/x-ndjson", in_cbor = "application/cbor";

Answer answer_ensemble(const Context& context, const HttpRequest& request, EnsemblePlan&& plan, std::string_view form,
                       Passes&& passes) {
  if (form == in_lines) {
    Answer answer;
    answer.type = in_lines;
    answer.begins = "{";
    const auto stream =
        std::make_shared<EnsembleStream>(EnsembleStream{context, std::move(plan), request.gone, std::move(passes)});
    answer.stream = [stream](const Write& write) { return (*stream)(write); };
    return answer;
  }
  Held held(&context.memory);
  bool fits = true;
  const auto [all, end] =
      compute(plan, context, request.gone, static_cast<unsigned>(passes.size()),
              [&](const Harvest& sums, const Block&) { return fits = held.grow_to(bytes_of(sums)); });
  if (!fits) return busy(context, request, "answers that others read fill the memory");
  const Notation notation = form == in_cbor ? Notation::cbor : Notation::json;
  return {200, std::string(form), encode_ensemble(plan, context.cards, all, end, notation), {}};
}

}  // namespace

Prepared run_ensemble_request(const Context& context, const HttpRequest& request) {
  const Names forms{"application/json", in_lines, in_cbor};
  auto form = form_for(request, forms);
  if (!form) return form.error();
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  auto plan = decode_ensemble(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), request.id);
  return Job([&context, request, form = forms[*form],
              shared = std::make_shared<EnsemblePlan>(std::move(*plan))](Admission::Pass pass) {
    return answer_ensemble(context, request, std::move(*shared), form, places(context, request, std::move(pass)));
  });
}

}  // namespace least::server

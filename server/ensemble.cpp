#include "server/ensemble.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "core/ensemble/lone_members.hpp"
#include "server/decode/ensemble_request.hpp"
#include "server/encode/ensemble_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

// One place was waited for, as for a run; those that are free besides are taken, too, as long as nobody needs them. A
// thread whose place is given back ends with its block.
class Places {
 public:
  Places(const Context& context, const HttpRequest& request, Admission::Pass&& first)
      : admission_(context.admission), client_(request.client) {
    passes_.reserve(admission_.places());
    passes_.push_back(std::move(first));
    look();
  }
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  // To be called now and then, by one thread.
  void look() {
    if (passes_.front().parked() || admission_.gives_way(client_)) {
      while (passes_.size() > 1) passes_.pop_back();
    } else {
      while (auto more = admission_.enter_besides(client_)) passes_.push_back(std::move(*more));
    }
    count_ = static_cast<unsigned>(passes_.size());
  }
  void leave() { passes_.clear(); }
  unsigned count() const { return count_; }
  unsigned most() const { return admission_.places(); }

 private:
  Admission& admission_;
  std::string client_;
  std::vector<Admission::Pass> passes_;
  std::atomic<unsigned> count_{1};
};

std::size_t bytes_of(const Harvest& all) {
  const SectionPoints& points = all.section;
  return sizeof(double) * (all.final.size() + all.final_member.size() + points.values.size() + 3 * points.t.size());
}

// The whole of it; `seen` takes the blocks in their order, false ends it.
template <class Seen>
std::pair<Harvest, EnsembleEnd> compute(const EnsemblePlan& plan, const Context& context,
                                        const std::function<bool()>& gone, Places& places, Seen&& seen) {
  std::pair<Harvest, EnsembleEnd> result;
  const auto start = std::chrono::steady_clock::now();
  const CancellationWatch watch(context.cancelled, [&] {
    places.look();
    return gone && gone();
  });
  const auto take = [&](const Block& block) {
    result.first.add(block.harvest, static_cast<std::size_t>(plan.request.limits.samples));
    return seen(result.first, block);
  };
  result.second.reason =
      run_ensemble(plan, {}, places.most(), watch.cancelled(), take, [&places] { return places.count(); });
  result.second.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (result.second.reason == ReturnCode::completed) {
    result.second.warnings = warnings_of_few(plan, watch.cancelled());
    if (watch.cancelled()) result.second.reason = ReturnCode::cancelled;
  }
  return result;
}

// Nothing but sums is kept: each block leaves as it comes.
struct EnsembleStream {
  const Context& context;
  EnsemblePlan plan;
  std::function<bool()> gone;
  std::shared_ptr<Places> places;

  std::optional<std::string> operator()(const Write& write) {
    bool taken = write(encode_ensemble_head(plan, context.cards));
    if (!taken) return std::nullopt;
    std::int64_t points = 0;
    const auto [all, end] = compute(plan, context, gone, *places, [&](Harvest& sums, const Block& block) {
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
    places->leave();
    return encode_ensemble_end(plan, all, end);  // of one that was cut off, too: `cancelled`
  }
};

constexpr std::string_view in_lines = "application/x-ndjson", in_cbor = "application/cbor";

Answer answer_ensemble(const Context& context, const HttpRequest& request, EnsemblePlan&& plan, std::string_view form,
                       std::shared_ptr<Places> places) {
  const std::string scheme(context.cards.schemes[plan.request.scheme].id);
  if (form == in_lines) {
    Answer answer;
    answer.type = in_lines;
    answer.begins = "{";
    answer.note("scheme", scheme);
    const auto stream =
        std::make_shared<EnsembleStream>(EnsembleStream{context, std::move(plan), request.gone, std::move(places)});
    answer.stream = [stream](const Write& write) { return (*stream)(write); };
    return answer;
  }
  Held held(&context.memory);
  bool fits = true;
  const auto [all, end] = compute(plan, context, request.gone, *places, [&](const Harvest& sums, const Block&) {
    return fits = held.grow_to(bytes_of(sums));
  });
  if (!fits) return busy(context, request, "answers that others read fill the memory");
  places->leave();
  const Notation notation = form == in_cbor ? Notation::cbor : Notation::json;
  Answer answer{200, std::string(form), encode_ensemble(plan, context.cards, all, end, notation), {}};
  answer.note("scheme", scheme);
  return answer;
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
    pass.may_take(shared->request.limits.seconds);
    return answer_ensemble(context, request, std::move(*shared), form,
                           std::make_shared<Places>(context, request, std::move(pass)));
  });
}

}  // namespace least::server

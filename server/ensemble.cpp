#include "server/ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
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
#include "server/http/request_reader.hpp"

namespace least::server {
namespace {

// Places are the places of one ensemble: it has waited for one, as a run does, and takes further free ones while nobody
// else needs them. When a place is given back, its thread ends after its block.
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

  // look() is to be called regularly, by one thread.
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

// Computed is the result of an ensemble, with the memory it holds.
struct Computed {
  Harvest all;
  EnsembleEnd end;
  Held held;
};

// compute runs the whole ensemble; take(computed, block) adds the blocks in order, false ends it.
Computed compute(const EnsemblePlan& plan, const Context& context, const std::function<bool()>& gone, Places& places,
                 const std::function<bool(Computed&, Block&)>& take) {
  constexpr double beyond = 0.05;  // seconds beyond the limit, for the warnings of some members
  Computed result{{}, {}, Held(&context.memory)};
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  ReturnCode& reason = result.end.reason;
  {
    const CancellationWatch watch(context.cancelled, [&] {
      places.look();
      return gone && gone();
    });
    bool room = true;
    const auto add = [&](Block& block) {
      try {
        return take(result, block);
      } catch (const MemoryShortage&) {
        return room = false;
      }
    };
    const auto share = [&places] { return places.count(); };
    reason = run_ensemble(plan, {}, places.most(), watch.cancelled(), add, share, &context.memory);
    if (!room) reason = ReturnCode::memory;
    result.end.seconds = passed();
  }
  if (reason == ReturnCode::completed) {
    const CancellationWatch watch(context.cancelled, gone, plan.request.limits.seconds - passed() + beyond);
    result.end.warnings = warnings_of_few(plan, watch.cancelled());
    if (end_of(watch) == ReturnCode::cancelled) reason = ReturnCode::cancelled;
  }
  return result;
}

// EnsembleStream keeps only sums: each block is sent as it comes.
struct EnsembleStream {
  const Context& context;
  EnsemblePlan plan;
  std::function<bool()> gone;
  std::shared_ptr<Places> places;

  std::optional<std::string> operator()(const Write& write) {
    bool taken = write(encode_ensemble_head(plan, context.cards));
    if (!taken) return std::nullopt;
    std::size_t points = 0;
    const auto computed = compute(plan, context, gone, *places, [&](Computed& sums, Block& block) {
      SectionPoints& section = block.harvest.section;
      const std::size_t before = section.t.size(), most = static_cast<std::size_t>(plan.request.most_points());
      section.cut(most - points, plan.request.columns.size());  // drops those beyond the limit
      points += section.t.size();
      TextPieces pieces = pieces_of_block(plan, block);
      std::string text;
      for (bool more = true; more && taken; text.clear()) {
        more = pieces(text);
        taken = write(text);
      }
      sums.all.truncated = sums.all.truncated || section.t.size() < before;
      block.harvest.final_member = {};
      block.harvest.final = {};
      block.harvest.trajectories = {};
      section = {};
      sums.all.add(block.harvest, most, sums.held);
      return taken;
    });
    places->leave();
    return encode_ensemble_end(plan, computed.all, computed.end);  // also of one that was cut off: `cancelled`
  }
};

constexpr std::string_view in_lines = "application/x-ndjson", in_cbor = "application/cbor";

bool is_empty(const Harvest& all) {
  return std::ranges::all_of(all.ended, [](std::int64_t count) { return count == 0; });
}

// keep adds a block to the others; the first one is moved.
bool keep(const EnsemblePlan& plan, Computed& sums, Block& block) {
  if (is_empty(sums.all)) {
    sums.all = std::move(block.harvest);
    sums.held = std::move(block.held);
  } else {
    sums.all.add(block.harvest, static_cast<std::size_t>(plan.request.most_points()), sums.held);
  }
  return true;
}

// WholeEnsemble is the whole answer, written while it is sent.
struct WholeEnsemble {
  EnsemblePlan plan;
  Computed computed;
  TextPieces pieces;

  WholeEnsemble(EnsemblePlan&& of, const Cards& cards, Computed&& with, Notation notation)
      : plan(std::move(of)),
        computed(std::move(with)),
        pieces(pieces_of_ensemble(plan, cards, computed.all, computed.end, notation)) {}
};

// place_of_rows returns the field that asks for the most rows of each member.
std::string_view place_of_rows(const EnsemblePlan& plan) {
  if (plan.request.section && section_count(plan) >= row_count(plan)) return "/section";
  return plan.trajectories ? "/record" : "/members/count";
}

Answer answer_ensemble(const Context& context, const HttpRequest& request, EnsemblePlan&& plan, std::string_view form,
                       std::shared_ptr<Places> places) {
  const std::string scheme(context.cards.schemes[plan.request.scheme].id);
  Answer answer;
  answer.type = form;
  answer.note("scheme", scheme);
  if (form == in_lines) {
    const auto stream =
        std::make_shared<EnsembleStream>(EnsembleStream{context, std::move(plan), request.gone, std::move(places)});
    answer.stream = [stream](const Write& write) { return (*stream)(write); };
    return answer;
  }
  constexpr std::size_t large = 32 * 1024;  // numbers, about 20 bytes each as text
  Computed computed = compute(plan, context, request.gone, *places,
                              [&plan](Computed& sums, Block& block) { return keep(plan, sums, block); });
  if (computed.end.reason == ReturnCode::memory && is_empty(computed.all))
    return no_room(context, request, place_of_rows(plan), "a block of members and its points", computed.held.bytes(),
                   bytes_of_block(plan));
  places->leave();
  const Harvest& all = computed.all;
  const std::size_t numbers =
      all.final.size() + all.trajectories.values.size() + all.section.values.size() + 3 * all.section.t.size();
  const auto whole = std::make_shared<WholeEnsemble>(std::move(plan), context.cards, std::move(computed),
                                                     form == in_cbor ? Notation::cbor : Notation::json);
  if (numbers <= large) {
    answer.body = whole->pieces.whole();
  } else {
    answer.pieces = [whole](std::string& out) { return whole->pieces(out); };
  }
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
  if (const std::size_t need = bytes_of_block(*plan); need > context.memory.most())
    return no_room(context, request, place_of_rows(*plan), "the points and rows of a block of members", 0, need);
  return Job([&context, request, form = forms[*form],
              shared = std::make_shared<EnsemblePlan>(std::move(*plan))](Admission::Pass pass) {
    pass.may_take(shared->request.limits.seconds);
    return answer_ensemble(context, request, std::move(*shared), form,
                           std::make_shared<Places>(context, request, std::move(pass)));
  });
}

}  // namespace least::server

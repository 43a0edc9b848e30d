#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/ensemble.hpp"
#include "server/periodic.hpp"
#include "server/problems.hpp"
#include "server/simulate.hpp"
#include "server/study.hpp"
#include "tests/fuzz/targets.hpp"

namespace least::fuzz {
namespace {

using namespace least::server;

struct Base {
  Endpoint endpoint;
  std::string_view request;
};

// Requests that are good as they stand: every endpoint, every kind of scheme, scenes as text of every kind.
constexpr std::array bases{
    Base{simulate, R"js({"problem":{"id":"kepler","mu":1},"initial":{"x":0,"y":-4,"px":-0.1,"py":-0.1},
        "scheme":{"id":"leapfrog","step":0.1,"composition":"kahan_li_6"},"until":{"t":10},"record":{"samples":5},
        "columns":["t","x","y","energy","error"],"diagnostics":["energy","momenta","structure","error","orbit"],
        "limits":{"seconds":0.02,"steps":200,"samples":1000},"norm":"relative"})js"},
    Base{simulate, R"js({"problem":"kepler","initial":{"x":1,"y":0,"px":0,"py":1},
        "scheme":{"id":"taylor","tolerance":1e-10,"order":0},"until":{"t":7},"record":{"curve":20},
        "columns":["t",{"name":"r","expression":"sqrt(x^2+y^2)"},"step_size"],"diagnostics":["lyapunov","error"],
        "events":[{"name":"apsis","expression":"x*px+y*py","direction":"up","stop":false}]})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"jacobi_maupertuis","step":0.05,"theta":0.1},
        "until":{"steps":100},"record":{"every":3},"columns":["t","x","mode","parameter"],
        "diagnostics":["energy","orbit"]})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"time_transformed","sigma":0.05,"kappa":1,
        "composition":"kahan_li_8"},"until":{"t":12},"record":{"times":[1,2.5,8]}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"adaptive_verlet","step":0.01},"until":{"t":3},
        "record":{"every":0},"limits":{"steps":150}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"variational_midpoint","step":0.05},"until":{"t":3},
        "initial":{"x":1,"y":0,"px":0,"py":1.2,"t":1},"columns":["t","x","discrete_energy"]})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"galerkin_4","step":0.05},"until":{"steps":30}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"dormand_prince_5","tolerance":1e-8},"until":{"t":5},
        "record":{"samples":30}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-4,"keep":["energy"]},"until":{"t":3},
        "limits":{"seconds":0.02}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"leapfrog","step":0.05,
        "composition":{"weights":[1.3,-1.6,1.3]}},"until":{"t":2}})js"},
    Base{simulate, R"js({"problem":{"id":"damped_oscillator"},"initial":{"q":1,"p":0.5},
        "scheme":{"id":"contact_splitting","step":0.1,"composition":"kahan_li_8","splitting":"plain"},
        "until":{"steps":50},"diagnostics":["energy","decay","structure"],"columns":["t","q","s"]})js"},
    Base{simulate, R"js({"problem":"damped_oscillator","scheme":{"id":"contact_gauss","step":0.1,"stages":3},
        "until":{"t":5},"record":{"every":2}})js"},
    Base{simulate, R"js({"problem":"damped_oscillator","scheme":{"id":"contact_leapfrog","step":0.1,
        "composition":"none"},"until":{"t":5},"events":[{"name":"zero","expression":"q-s/2","direction":"both",
        "stop":true}]})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x"],"parameters":{"alpha":0.1},
        "lagrangian":"vx^2/2 + x^2/2 - x^4/4 - alpha*s"},"initial":{"x":2,"vx":0.5},
        "scheme":{"id":"contact_splitting","composition":"kahan_li_8","step":0.05},"until":{"t":4}})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x","y"],"hamiltonian":"(px^2+py^2)/2+x^2*y-y^3/3",
        "invariants":{"H":"(px^2+py^2)/2+x^2*y-y^3/3"}},"initial":{"x":0.1,"y":0.2,"px":"1/3"},
        "scheme":{"id":"leapfrog","step":0.1},"until":{"t":"4*pi"},"diagnostics":["momenta"]})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x[n]"],"parameters":{"n":2,"m":[1,2]},
        "definitions":{"at(i)":"if(i == 0 or i > n, 0, x[i])","spring(i)":"at(i+1)-at(i)"},
        "potential":"sum(i=0..n, spring(i)^2/2 + spring(i)^3/12)","masses":{"x":"m"}},"initial":{"x":[0.5,0]},
        "scheme":{"id":"leapfrog","step":0.1},"until":{"t":3},"columns":["t","x[*]"]})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x","y"],"parameters":{"a":1},
        "equations":{"x":"y","y":"-a*sin(x)"}},"initial":{"x":1},"scheme":{"id":"runge_kutta_4","step":0.1},
        "until":{"t":3},"events":[{"name":"e","expression":"x","direction":"up","stop":true}]})js"},
    Base{run_ensemble_request, R"js({"problem":"kepler","initial":{"x":1,"y":0,"px":0,"py":1},
        "scheme":{"id":"leapfrog","step":0.05},"until":{"t":3},"members":{"count":50,"seed":7,
        "vary":{"/initial/x":{"uniform":[0.8,1.2]},"/initial/px":{"normal":[0,0.05]}}},"range":[0,50],
        "columns":["x","y","energy",{"name":"r","expression":"sqrt(x^2+y^2)"}],
        "keep":["statistics","final","section"],"section":{"period":1.5,"phase":0},
        "histograms":{"x":{"range":[-2,2],"bins":8},"r":{"range":[0,2],"bins":4}},
        "limits":{"seconds":0.02,"steps":200,"samples":1000}})js"},
    Base{run_ensemble_request, R"js({"problem":{"id":"damped_oscillator"},"scheme":{"id":"contact_splitting",
        "step":0.1},"until":{"t":4},"members":{"vary":{"/initial/q":{"grid":[0,1,5]},
        "/initial/p":{"values":[1,2,3]}}},"keep":["section"],"section":{"expression":"q","direction":"down"}})js"},
    Base{run_ensemble_request, R"js({"problem":{"id":"custom","variables":["x","y"],"potential":"x^2/2+y^4/4"},
        "scheme":{"id":"runge_kutta_4","step":0.1},"until":{"t":2},"members":{"count":20,"seed":1,
        "vary":{"/initial/x":{"uniform":[-1,1]}}},"columns":["x","energy"]})js"},
    Base{measure_work_precision, R"js({"problem":"kepler","initial":{"x":0.4,"y":0,"px":0,"py":2},"until":{"t":3},
        "schemes":["leapfrog",{"id":"leapfrog","composition":"kahan_li_8"},"time_transformed"],"error":"max",
        "budget_seconds":0.02})js"},
    Base{measure_work_precision, R"js({"problem":"damped_oscillator","until":{"t":3},"schemes":"all",
        "norm":"relative","budget_seconds":0.02})js"},
    Base{measure_stability, R"js({"problem":"damped_oscillator","initial":{"q":1},
        "schemes":["contact_splitting",{"id":"contact_gauss","stages":2}],"budget_seconds":0.02})js"},
    Base{measure_stability, R"js({"problem":{"id":"custom","variables":["x"],"hamiltonian":"px^2/2+x^4/4"},
        "initial":{"x":1},"schemes":["leapfrog","runge_kutta_4"],"budget_seconds":0.02})js"},
    Base{describe_scene, R"js({"problem":{"id":"custom","variables":["x"],"parameters":{"g":0.2},
        "potential":"x^4/4","masses":{"x":2},"damping":"g*t"},"initial":{"x":1}})js"},
    Base{simulate, R"js({"problem":{"id":"kepler","mu":1},"initial":{"x":1,"y":0,"px":0,"py":1.1},
        "scheme":{"id":"taylor","tolerance":1e-9},"until":{"t":2},"record":{"samples":4},
        "sensitivities":{"by":["/initial/x","/problem/mu"],"at":"samples"}})js"},
    Base{simulate, R"js({"problem":"kepler","initial":{"x":1,"y":0,"px":0,"py":1.1},"until":{"t":2},
        "scheme":{"id":"runge_kutta_4","step":0.1},
        "sensitivities":{"by":["/initial/x","/initial/px"],"of":"motion","order":2}})js"},
    Base{simulate, R"js({"problem":"damped_oscillator","scheme":{"id":"contact_leapfrog","step":0.1},"until":{"t":2},
        "sensitivities":{"by":"initial","of":"scheme"}})js"},
    Base{simulate, R"js({"problem":"kepler","scheme":{"id":"leapfrog","step":0.1},"until":{"t":9},"record":{"every":0},
        "columns":["x","px"],"section":{"expression":"y","direction":"up"}})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x"],"parameters":{"g":9.81,"k":0.8},
        "potential":"g*x"},"initial":{"x":1},"scheme":{"id":"taylor","tolerance":1e-9},"until":{"t":3},
        "events":[{"name":"floor","expression":"x","direction":"down","set":{"vx":"-k*vx"},"most":5}]})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x","y"],"parameters":{"c":0.1},
        "potential":"x^2/2+y^2","forces":{"x":"-c*vx*abs(vx)"},"dissipation":"c*(vy-vx)^2/2"},
        "initial":{"x":1,"vy":0.5},"scheme":{"id":"leapfrog","step":0.1},"until":{"t":3}})js"},
    Base{simulate, R"js({"problem":{"id":"custom","variables":["x","y"],"parameters":{"b":2},
        "hamiltonian":"(px^2+py^2)/2+b*(x*py-y*px)+b^2*(x^2+y^2)/2"},"initial":{"x":1,"py":0.5},
        "scheme":{"id":"lifted_splitting","step":0.1,"composition":"kahan_li_6"},"until":{"t":5},
        "diagnostics":["energy","structure"]})js"},
    Base{close_orbit_request, R"js({"problem":{"id":"custom","variables":["a"],"parameters":{"g":1},
        "potential":"-g*cos(a)"},"initial":{"a":0.5},"period":6.4,"fixed":["pa"],"symmetric":false,
        "limits":{"seconds":0.02}})js"},
    Base{close_orbit_request, R"js({"problem":{"id":"custom","variables":["a"],"potential":"-cos(a)"},
        "initial":{"a":0.5},"period":6.4,"symmetric":true,"family":{"by":"/initial/a","to":2,"count":3},
        "limits":{"seconds":0.02}})js"},
    Base{close_orbit_request, R"js({"problem":{"id":"custom","variables":["x","y"],"potential":"x^2/2+y^2/2-x^2*y"},
        "initial":{"y":0.3,"x":0.1},"period":6.3,"manifolds":{"count":2,"until":3},"limits":{"seconds":0.02}})js"},
    Base{run_ensemble_request, R"js({"problem":"kepler","initial":{"x":1,"y":0,"px":0,"py":1},
        "scheme":{"id":"leapfrog","step":0.1},"until":{"t":2},"record":{"samples":3},"keep":["trajectories"],
        "members":{"vary":{"/problem/mu":{"values":[0.9,1,1.1]}}},"columns":["t","x","energy"]})js"},
};

// Choices takes bytes as choices; when there are no more bytes it makes the first choice.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : bytes_(bytes) {}
  std::size_t below(std::size_t count) {
    if (bytes_.empty() || count == 0) return 0;
    const auto byte = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte % count;
  }
  template <class Range>
  const auto& of(const Range& all) {
    return all[below(std::size(all))];
  }

 private:
  std::string_view bytes_;
};

void collect(Json& node, std::vector<Json*>& all) {
  all.push_back(&node);
  if (node.is_structured())
    for (Json& child : node) collect(child, all);
}

// number() mostly returns values that somebody might mean.
Json number(const Json& was, Choices& choices) {
  constexpr double modest[] = {1, 2, 3, 0.5, 0.1, 0.01, 1e-3, 7, 100, 0},
                   extreme[] = {-1,    1e308,  -1e308, 1e-308, 5e-324, 1e15, -0.0,
                                1e-15, 1e-300, 1e100,  2.5,    2e9,    -7,   9007199254740992};
  constexpr int whole[] = {1, 2, 3, 4, 5, 7, 20, 100, 0};
  constexpr std::string_view texts[] = {"2*pi", "0/0", "nan", "1e999", "-1/3", "sqrt(2)", "", "1/0"};
  const bool is_whole = was.is_number_integer();
  switch (choices.below(12)) {
    case 0:
      return choices.of(extreme);
    case 1:
      return choices.of(texts);
    case 2:
      return -was.get<double>();
    case 3:
    case 4:
      return is_whole ? Json(was.get<std::int64_t>() / 2) : Json(was.get<double>() / 2);
    case 5:
    case 6:
      return is_whole ? Json(static_cast<int>(choices.below(256))) : Json(was.get<double>() * 2);
    default:
      return is_whole ? Json(choices.of(whole)) : Json(choices.of(modest));
  }
}

using Names = std::vector<std::string_view>;

// Names that may replace each other; the last group are expressions.
const std::vector<Names>& kinds_of_names() {
  static const std::vector<Names> kinds{
      {"leapfrog", "variational_midpoint", "galerkin_4", "contact_leapfrog"},
      {"runge_kutta_4", "explicit_euler", "explicit_midpoint", "ruth_3", "symplectic_euler", "adaptive_verlet"},
      {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer", "taylor"},
      {"contact_splitting", "contact_leapfrog", "contact_variational_midpoint"},
      {"contact_gauss", "contact_galerkin_4", "contact_symplectic_euler", "energy_momentum"},
      {"x", "y", "px", "py", "energy", "error", "t", "step_size", "mode", "discrete_energy"},
      {"q", "p", "s", "t", "energy", "error"},
      {"none", "yoshida_4", "kahan_li_6", "kahan_li_8", "suzuki_4"},
      {"up", "down", "both"},
      {"max", "final"},
      {"absolute", "relative"},
      {"statistics", "final", "section", "trajectories"},
      {"energy", "momenta", "structure", "orbit", "error", "decay", "lyapunov"},
      {"kepler", "damped_oscillator"},
      {"motion", "scheme"},
      {"/initial/x", "/initial/px", "/initial/t", "/problem/mu", "/initial/a", "period", "energy"},
      {"lifted_splitting", "boris", "adaptive_boris", "harmonic_splitting", "kepler_splitting"},
      {"custom", "all", "auto", "jacobi_maupertuis", "time_transformed", "vx", "mu", "x[1]", "x[*]", "alpha", "aba_864",
       "0", ""},
      {"x^2", "1/x", "sqrt(x-1)", "exp(x^2)", "x*px+y*py", "abs(x)", "if(x < 1, x, 2-x)", "sin(1e9*x)", "t", "q-1",
       "x+", "vx^2/2-x^2/2", "px^2/2+x^2/2-1e308*x", "x^4/4+y^2", "-x", "y-x^3", "s/2-q", "0"}};
  return kinds;
}

// text() replaces a name by one of its kind, rarely by another.
Json text(const std::string& was, Choices& choices) {
  const auto& kinds = kinds_of_names();
  auto kind = std::ranges::find_if(kinds, [&](const Names& names) { return std::ranges::count(names, was) > 0; });
  if (kind == kinds.end()) kind = std::prev(kind);
  if (choices.below(16) == 15) return choices.of(choices.of(kinds));
  return choices.of(*kind);
}

// change_length() removes an element of a list, or repeats it.
void change_length(Json& list, Choices& choices) {
  if (list.empty()) return;
  constexpr std::size_t more[] = {0, 1, 40};
  const std::size_t at = choices.below(list.size()), times = choices.of(more);
  const Json element = list[at];
  if (times == 0) list.erase(at);
  for (std::size_t i = 0; i < times; ++i) list.push_back(element);
}

// change_members() removes a member, or copies it to the name of another one or to an unknown one.
void change_members(Json& object, Choices& choices) {
  if (object.size() < 2) return;
  auto member = object.begin();
  std::advance(member, static_cast<std::ptrdiff_t>(choices.below(object.size())));
  if (choices.below(3) < 2) {
    object.erase(member);
    return;
  }
  const Json value = member.value();
  object[text(member.key(), choices).get<std::string>()] = value;
}

void mutate(Json& request, Choices& choices) {
  std::vector<Json*> all;
  collect(request, all);
  // Numbers are chosen more often than the rest, because most replacements of numbers are accepted.
  for (std::size_t i = 0, count = all.size(); i < count; ++i)
    if (all[i]->is_number()) all.insert(all.end(), 4, all[i]);
  Json& node = *all[choices.below(all.size())];
  if (node.is_number()) {
    node = number(node, choices);
  } else if (node.is_string()) {
    node = text(node.get<std::string>(), choices);
  } else if (node.is_boolean()) {
    node = !node.get<bool>();
  } else if (node.is_array()) {
    change_length(node, choices);
  } else if (node.is_object()) {
    change_members(node, choices);
  }
}

// body_of() returns the whole body, as a client gets it that reads everything.
std::string body_of(Answer& answer) {
  std::string body = std::move(answer.body);
  if (answer.stream) {
    const auto end = answer.stream([&body](std::string_view piece) {
      body += piece;
      return true;
    });
    ensure(end.has_value(), "lines without an end");
    body += *end;
  }
  while (answer.pieces && answer.pieces(body)) {
  }
  return body;
}

void check(const Answer& answer, const std::string& body) {
  const int status = answer.status;
  ensure(status == 200 || status == 422 || status == 503,
         "status " + std::to_string(status) + ": " + body.substr(0, 500));
  if (answer.type.starts_with("application/x-ndjson")) {
    std::istringstream lines(body);
    Json last;
    for (std::string line; std::getline(lines, line);) last = Json::parse(line);
    ensure(last.is_object() && last.contains("status"), "the last line is no end: " + last.dump());
  } else if (answer.type.starts_with("application/cbor")) {
    ensure(!Json::from_cbor(body, true, true, Json::cbor_tag_handler_t::store).empty(), "an empty answer");
  } else if (answer.type.starts_with("text/csv")) {
    ensure(!body.empty() && body.back() == '\n', "rows that do not end");
  } else {
    const Json whole = Json::parse(body);
    ensure(status == 200 || status == 503 || !whole["errors"].empty(), "a refusal without a fault: " + body);
  }
}

}  // namespace

int status_of_values(std::string_view bytes) {
  constexpr std::string_view forms[] = {"application/json", "application/x-ndjson, application/json;q=0.5",
                                        "application/cbor, application/json;q=0.5", "text/csv, application/json;q=0.5"};
  static const Cards cards = catalogue_cards();
  Choices choices(bytes);
  const Base& base = choices.of(bases);
  const std::string_view accept = choices.of(forms);
  Json request = Json::parse(base.request);
  constexpr std::size_t counts[] = {0, 1, 1, 1, 2, 3};
  for (std::size_t left = choices.of(counts); left > 0; --left) mutate(request, choices);
  const std::string text = request.dump();
  Admission admission(1, 0);
  const std::atomic<bool> cancelled{false};
  MemoryBudget memory(std::size_t{64} << 20);
  const Context context{cards, {.seconds = 0.05, .steps = 200, .samples = 100'000}, admission, cancelled, memory};
  try {
    Answer answer = answer_now(base.endpoint, context, {text, accept, "id"});
    check(answer, body_of(answer));
    return answer.status;
  } catch (const MemoryShortage&) {
    return 503;  // as the server says of it
  } catch (const std::exception& e) {
    if (std::string_view(e.what()).starts_with("this build leaves out")) return 0;
    throw std::logic_error(std::string(e.what()) + " — of " + text);
  }
}

void values(std::string_view bytes) { status_of_values(bytes); }

}  // namespace least::fuzz

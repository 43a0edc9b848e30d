#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "server/decode/simulate_request.hpp"
#include "server/encode/run_answer.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/server/cards.hpp"

namespace least::fuzz {
namespace {

using namespace least::server;

std::vector<double> numbers_of(std::string_view bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  return numbers;
}

// Columns of numbers are typed arrays, in which NaN stands for a missing value; JSON has null for all that is not
// finite.
Json of_binary(const std::string& body) {
  Json answer = Json::from_cbor(body, true, true, Json::cbor_tag_handler_t::store);
  for (auto& column : answer["trajectory"]) {
    if (!column.is_binary()) continue;
    ensure(column.get_binary().subtype() == 86, "a typed array of something else");
    const std::string bytes(column.get_binary().begin(), column.get_binary().end());
    column = Json::array();
    for (const double x : numbers_of(bytes)) column.push_back(std::isfinite(x) ? Json(x) : Json());
  }
  return answer;
}

Json of_lines(const FinishedRun& run, std::span<const double> rows, std::size_t at_once) {
  Json answer = Json::parse(run_head_line(run));
  for (const std::size_t column : run.request.columns)
    answer["trajectory"][run.request.column(column).name] = Json::array();
  for (std::size_t from = 0; from < rows.size(); from += at_once) {
    const Json line = Json::parse(run_samples_line(run, rows.subspan(from, std::min(at_once, rows.size() - from))));
    for (const auto& [name, values] : line["trajectory"].items())
      for (const Json& value : values) answer["trajectory"][name].push_back(value);
  }
  const Json end = Json::parse(run_end_line(run, run.outcome));
  for (const auto& [key, value] : end.items()) answer[key] = value;
  answer.erase("kind");
  return answer;
}

// Independent of the order of members, and of whether a number was written as a whole number.
void ensure_same(const Json& a, const Json& b, const std::string& what) {
  ensure(nlohmann::json(a) == nlohmann::json(b), what);
}

}  // namespace

void forms(std::string_view bytes) {
  static const Request asked = [] {
    auto parsed = parse_json(R"({"problem":"swing","scheme":"leapfrog","columns":["t","energy","mode"]})");
    return decode(std::move(*parsed), server::test::cards(), {})->run;
  }();
  const auto middle = std::min(bytes.find('|'), bytes.size());
  // A valid text: bytes that are not UTF-8 are replaced.
  const Json text =
      Json::parse(Json(std::string(bytes.substr(0, middle))).dump(-1, ' ', false, Json::error_handler_t::replace));
  std::vector<double> numbers = numbers_of(bytes.substr(std::min(middle + 1, bytes.size())));
  numbers.resize(numbers.size() - numbers.size() % asked.columns.size());
  // Codes are small whole numbers or nothing, as the core gives them.
  for (std::size_t i = 2; i < numbers.size(); i += 3)
    numbers[i] = std::isfinite(numbers[i]) ? std::floor(std::remainder(numbers[i], 3)) : std::nan("");
  KeptRows rows(asked.columns.size());
  rows.append(numbers);
  Solution outcome;
  outcome.t = numbers.empty() ? 0 : numbers.back();
  outcome.final = {numbers.empty() ? -0.0 : numbers.front(), 1};
  outcome.warnings = {{"code", text.get<std::string>()}};
  outcome.diagnostics = {{"energy", std::vector<Report>{{"kind", text.get<std::string>()}}}};
  const FinishedRun run({asked, asked.scene->card(), server::test::cards().schemes[asked.scheme]}, outcome, rows);
  const Json whole = Json::parse(whole_answer(server::forms()[0], run).body);
  ensure(whole["warnings"][0]["detail"] == text, "another text");
  std::size_t row = 0;
  for (const Json& value : whole["trajectory"]["energy"]) {
    const double x = numbers[3 * row++ + 1];
    ensure(std::isfinite(x) ? value.get<double>() == x && std::signbit(value.get<double>()) == std::signbit(x)
                            : value.is_null(),
           "another number");
  }
  ensure(row == rows.rows(), "numbers that are missing");
  ensure_same(of_binary(whole_answer(server::forms()[2], run).body), whole, "CBOR says something else");
  ensure_same(of_lines(run, numbers, 3 * (1 + bytes.size() % 4)), whole, "lines say something else");
  whole_answer(server::csv_form, run);
}

}  // namespace least::fuzz

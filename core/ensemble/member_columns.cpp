#include "core/ensemble/member_columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/ensemble/lane_members.hpp"
#include "core/text/written_out.hpp"

namespace least {
namespace {

/// TapeTracer records a tape as a trace. A power with a varying exponent is recorded as that of lanes, so that x^2 with
/// a varied exponent 2 has a value for x < 0, too.
class TapeTracer {
 public:
  TapeTracer(const tape::Tape& tape, Trace& trace, std::map<std::size_t, Traced>& variables)
      : tape_(tape), trace_(trace), variables_(variables), values_(static_cast<std::size_t>(tape.size())) {}

  void trace(const std::vector<bool>& wanted) {
    for (tape::Index i = 0; i < tape_.size(); ++i)
      if (wanted[static_cast<std::size_t>(i)]) values_[static_cast<std::size_t>(i)] = value(tape_[i]);
  }
  const Traced& at(tape::Index i) const { return values_[static_cast<std::size_t>(i)]; }

 private:
  Traced value(const tape::Node& node) {
    using tape::Op;
    const auto a = [&]() -> const Traced& { return at(node.a); };
    const auto b = [&]() -> const Traced& { return at(node.b); };
    switch (node.op) {
      case Op::constant:
        return node.value;
      case Op::time:
        return Traced::time(trace_);
      case Op::variable:
        return variables_.at(static_cast<std::size_t>(node.value));
      case Op::add:
        return a() + b();
      case Op::subtract:
        return a() - b();
      case Op::multiply:
        return a() * b();
      case Op::divide:
        return a() / b();
      case Op::power:
        return whole_or_half(a(), node.value);
      case Op::raise:
        return raise(a(), b());
      case Op::sqrt:
        return sqrt(a());
      case Op::exp:
        return exp(a());
      case Op::log:
        return log(a());
      case Op::sin:
        return sin(a());
      case Op::cos:
        return cos(a());
      case Op::tan:
        return tan(a());
      case Op::sinh:
        return sinh(a());
      case Op::cosh:
        return cosh(a());
      case Op::tanh:
        return tanh(a());
      case Op::atan:
        return atan(a());
      case Op::asin:
        return asin(a());
      case Op::acos:
        return acos(a());
      case Op::select:
        return select(a() < Traced(0), b(), at(node.c));
      case Op::total:  // kept sums do not occur in columns
        break;
    }
    return unknown;
  }
  /// whole_or_half expands small whole and half exponents into products and a root, as core/tape/formula.cpp does.
  static Traced whole_or_half(const Traced& x, double exponent) {
    const double halves = std::abs(2 * exponent);
    if (!(halves <= 32 && halves == std::floor(halves))) return pow(x, exponent);
    Traced result = std::fmod(halves, 2) != 0 ? sqrt(x) : Traced(1), square = x;
    for (int n = static_cast<int>(halves) / 2; n > 0; n /= 2) {
      if (n % 2) result = square * result;
      if (n > 1) square = square * square;
    }
    return exponent < 0 ? 1 / result : result;
  }

  const tape::Tape& tape_;
  Trace& trace_;
  std::map<std::size_t, Traced>& variables_;
  std::vector<Traced> values_;
};

}  // namespace

MemberReader::MemberReader(const Scene& scene, std::span<const Variation> vary)
    : card_(scene.card()), text_(scene.mechanics->text()) {
  const auto know = [&](std::string_view name, const Symbol& meaning) { words_.add({name, meaning, {}}); };
  const auto column = [&](std::string_view name) {
    const auto found = std::ranges::find(card_.columns, name, &ColumnCard::name);
    if (found != card_.columns.end())
      know(name, Symbol::variable(tape_, static_cast<std::size_t>(found - card_.columns.begin())));
  };
  for (const VariableCard& variable : card_.variables)
    if (!variable.hidden) column(variable.name);
  know("t", Symbol::time(tape_));
  column("energy");
  std::size_t next = card_.columns.size();
  for (const Variation& varied : vary)
    if (varied.is_parameter()) know(card_.parameters[varied.index].name, Symbol::variable(tape_, next++));
  for (std::size_t i = 0; i < card_.parameters.size() && i < scene.parameters.size(); ++i) {
    const ParameterCard& parameter = card_.parameters[i];
    const bool number = parameter.kind == Kind::number || parameter.kind == Kind::integer;
    if (number && !words_.find(parameter.name) && std::isfinite(scene.parameters[i]))
      know(parameter.name, scene.parameters[i]);
  }
}

std::optional<text::Fault> MemberReader::read(std::string name, std::string text) {
  auto parsed = text::parse_in_words_of(text_, std::move(text));
  if (auto* fault = std::get_if<text::Fault>(&parsed)) return std::move(*fault);
  const auto& expression = std::get<text::Expression>(parsed);
  auto recorded = expression.record(tape_, words_, text::operations_beside(text_));
  if (auto* fault = std::get_if<text::Fault>(&recorded)) return std::move(*fault);
  measures_.list.push_back({{std::move(name), false, false, true, {}}, expression.text()});
  outputs_.push_back(std::get<Symbol>(recorded).on(tape_));
  return std::nullopt;
}

std::vector<std::string_view> MemberReader::names() const {
  std::vector<std::string_view> all;
  for (const text::Word& word : words_.all()) all.push_back(word.name);
  return all;
}

MemberColumns::MemberColumns(const Request& request, std::span<const Variation> vary) {
  const std::size_t known = request.scene->card().columns.size();
  for (const std::size_t column : request.columns)
    if (column < known) needed_.push_back(column);
  MemberReader reader(*request.scene, vary);
  for (const Measure& measure : request.measures.list) reader.read(measure.card.name, measure.text);
  own_ = reader.outputs_.size();
  if (own_ > 0) compile(reader);
  if (needed_.empty()) needed_.push_back(0);
  for (const std::size_t column : request.columns)
    columns_.push_back(column < known ? static_cast<std::size_t>(std::ranges::find(needed_, column) - needed_.begin())
                                      : needed_.size() + column - known);
}

void MemberColumns::compile(const MemberReader& reader) {
  const tape::Tape& tape = reader.tape_;
  std::vector<bool> wanted(static_cast<std::size_t>(tape.size()), false);
  for (const tape::Index i : reader.outputs_) wanted[static_cast<std::size_t>(i)] = true;
  for (tape::Index i = tape.size(); i-- > 0;)
    if (wanted[static_cast<std::size_t>(i)])
      for (const tape::Index part : {tape[i].a, tape[i].b, tape[i].c})
        if (part != tape::none) wanted[static_cast<std::size_t>(part)] = true;

  const std::size_t known = reader.card_.columns.size();
  std::vector<std::size_t> read;  // by variable of the tape
  for (tape::Index i = 0; i < tape.size(); ++i) {
    if (!wanted[static_cast<std::size_t>(i)] || tape[i].op != tape::Op::variable) continue;
    read.push_back(static_cast<std::size_t>(tape[i].value));
    if (read.back() < known && std::ranges::find(needed_, read.back()) == needed_.end()) needed_.push_back(read.back());
  }
  if (needed_.empty()) needed_.push_back(0);

  Trace trace;
  LaneSource source;
  std::map<std::size_t, Traced> variables;
  for (const std::size_t i : read) {
    variables.emplace(i, Traced::variable(trace, source.rows.size()));
    const auto place = i < known ? static_cast<std::size_t>(std::ranges::find(needed_, i) - needed_.begin())
                                 : needed_.size() + i - known;
    source.rows.push_back(static_cast<std::uint32_t>(place));
  }
  TapeTracer tracer(tape, trace, variables);
  tracer.trace(wanted);
  for (const tape::Index i : reader.outputs_) source.outputs.push_back(tracer.at(i).on(trace));
  source.trace = &trace;
  source.own.assign(trace.constants().size(), false);
  source.end = trace.size();
  source.steps = false;
  lanes_ = std::make_shared<const CompiledLanes>(source);
}

void MemberColumns::fill(const double* needed, double t, std::span<const double> varied, double* out) const {
  std::vector<double> values(needed, needed + needed_.size());
  values.insert(values.end(), varied.begin(), varied.end());
  if (lanes_) {
    std::vector<double> own(own_);
    evaluate_in_lanes(lanes_->program(), {t, 0, values.data(), nullptr}, own.data());
    for (double& value : own)
      if (!std::isfinite(value)) value = unknown;
    values.resize(needed_.size());
    values.insert(values.end(), own.begin(), own.end());
  }
  for (std::size_t k = 0; k < columns_.size(); ++k) out[k] = values[columns_[k]];
}

}  // namespace least

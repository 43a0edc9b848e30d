// Laws of a run through the catalogue, as a client reaches it.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>

#include "core/catalogue/catalogue.hpp"
#include "tests/laws/scene.hpp"
#include "tests/support/runs.hpp"

namespace laws {

/// The card is consistent with itself and with the mechanics.
template <template <class> class P>
void card_is_consistent(std::string_view id) {
  const ProblemCard written = About<P>::card();
  EXPECT_EQ(written.id, id) << "the id is the file's stem";
  const ProblemCard& card = runs::problem_card(id);
  EXPECT_GT(card.span, 0);
  EXPECT_FALSE(card.title.empty() || card.summary.empty() || card.formula.empty() || card.references.empty());
  for (const auto& parameter : card.parameters) {
    EXPECT_TRUE(parameter.range.contains(parameter.value)) << parameter.name;
    EXPECT_FALSE(parameter.doc.empty()) << parameter.name;
    EXPECT_TRUE(parameter.kind == Kind::choice || !(parameter.symbol.empty() || parameter.unit.empty()))
        << parameter.name;
  }
  ASSERT_FALSE(card.suggested.empty());
  EXPECT_EQ(card.suggested.front().first, "step");
  for (const auto& preset : card.presets) {
    EXPECT_FALSE(preset.name.empty() || preset.doc.empty());
    for (const auto& [name, value] : preset.parameters) {
      const auto found = std::ranges::find(card.parameters, name, &ParameterCard::name);
      ASSERT_NE(found, card.parameters.end()) << preset.name << ": " << name;
      EXPECT_TRUE(found->range.contains(value)) << preset.name << ": " << name;
    }
    for (const auto& [name, value] : preset.initial)
      EXPECT_TRUE(name == "t" || std::ranges::count(card.variables, name, &VariableCard::name) == 1) << name;
  }
  EXPECT_GE(card.schemes.size(), 4U);
}

/// text() writes every number of a list of reports as text, exact to the bit, so that reports can be compared.
inline std::string text(const std::vector<Report>& reports) {
  std::string all;
  for (const auto& report : reports) {
    all += std::string(report.key) + ' ';
    if (const auto* number = std::get_if<double>(&report.value)) {
      char hex[40];
      std::snprintf(hex, sizeof hex, "%a ", *number);
      all += hex;
    }
    if (const auto* inner = std::get_if<std::vector<Report>>(&report.value)) all += text(*inner);
  }
  return all;
}

/// Neither the recording nor the diagnostics change the bits of a run.
template <template <class> class P>
void recording_never_changes_the_run(std::string_view id) {
  for (std::size_t i = 0; i < schemes().size(); ++i) {
    const ProblemCard& problem = runs::problem_card(id);
    if (!runs::fits(problem, i)) continue;
    Request request = runs::defaults(id, schemes()[i].id);
    request.end = runs::scene(request).start + 150.5 * request.settings[0];  // half a step is left over
    if (schemes()[i].own_clock) request.end = runs::scene(request).start + problem.span / 20;
    request.diagnostics = {};
    request.record.count = 0;
    auto plain = runs::go(request);
    runs::drop_unknown(plain.outcome.final);
    ASSERT_EQ(plain.outcome.stop.reason, ReturnCode::completed) << schemes()[i].id << plain.outcome.stop.detail;
    if (!schemes()[i].own_clock) {
      EXPECT_EQ(plain.outcome.cost.steps, 151);
    }
    EXPECT_TRUE(plain.rows.empty());

    std::string reports;
    std::vector<std::vector<double>> all_rows;
    std::vector<Record> records;
    for (const std::int64_t every : {1, 7, 150}) records.push_back({Record::Mode::every, every, {}});
    for (const std::int64_t samples : {2, 61, 1000}) records.push_back({Record::Mode::samples, samples, {}});
    for (const std::int64_t curve : {2, 61}) records.push_back({Record::Mode::curve, curve, {}});
    records.push_back(
        {Record::Mode::times,
         0,
         {runs::scene(request).start, runs::scene(request).start + 1e-9, request.end * 0.77, request.end}});
    for (const auto& record : records) {
      request.record = record;
      // Diagnostics take most of the time: ask for them with one record of each common kind.
      const bool often = record.count == 1 || record.count == 61;
      for (const bool diagnostics : {false, true}) {
        if (diagnostics && !often) continue;
        request.diagnostics.clear();
        if (diagnostics)
          for (std::size_t d = 0; d < problem.diagnostics.size(); ++d) request.diagnostics.push_back(d);
        auto other = runs::go(request);
        runs::drop_unknown(other.outcome.final);
        EXPECT_EQ(other.outcome.final, plain.outcome.final) << schemes()[i].id;
        EXPECT_EQ(other.outcome.cost.steps, plain.outcome.cost.steps);
        EXPECT_EQ(other.outcome.cost.force_evaluations, plain.outcome.cost.force_evaluations);
        ASSERT_FALSE(other.rows.empty());
        if (diagnostics) {
          if (reports.empty()) reports = text(other.outcome.diagnostics);
          EXPECT_EQ(text(other.outcome.diagnostics), reports) << schemes()[i].id;
        }
        if (record.mode == Record::Mode::every && record.count == 1) all_rows = other.rows;
        if (record.mode == Record::Mode::every) {
          for (std::size_t k = 0; k < other.rows.size(); ++k)
            EXPECT_EQ(other.rows[k], all_rows[k * static_cast<std::size_t>(record.count)]) << schemes()[i].id;
        }
        if (record.mode != Record::Mode::every) {  // samples at the end are the final state, to the bit
          EXPECT_EQ(other.rows.back().at(0), request.end);
          EXPECT_EQ(std::vector<double>(other.rows.back().begin() + 1, other.rows.back().end()), plain.outcome.final);
        }
      }
    }
  }
}

}  // namespace laws

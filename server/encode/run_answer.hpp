// Solution of a run → bytes. Written straight from the samples, no tree in between.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "core/study/study.hpp"
#include "core/variations/sensitivities.hpp"
#include "server/shared/answer.hpp"
#include "server/shared/cards.hpp"
#include "server/shared/json_writer.hpp"
#include "server/shared/kept_rows.hpp"

namespace least::server {

/// How the scheme of a run was chosen, with the cards of all schemes.
struct AdviceWithCards {
  const Advice& advice;
  std::span<const SchemeCard> schemes;
  /// It was wished for by seconds, so that those of its alternatives are told. They were measured, and else would
  /// differ between answers to the same request.
  bool timed = false;
};

/// What is known of a run before it begins, and echoed.
struct PlannedRun {
  const Request& request;
  const ProblemCard& problem;
  const SchemeCard& scheme;
  const AdviceWithCards* choice = nullptr;                        ///< where it was not the client who chose
  const variations::SensitivitiesAsked* sensitivities = nullptr;  ///< where they are asked for
};

std::vector<const ColumnCard*> cards_of(const Request& request, const std::vector<std::size_t>& columns);

/// What was asked for and found of what the run depends on.
struct FoundSensitivities {
  const variations::SensitivitiesAsked& asked;
  const variations::Sensitivities& found;
};

/// A run that is over: everything an encoder reads.
struct FinishedRun : PlannedRun {
  const Solution& outcome;
  const KeptRows& samples;
  const KeptRows* points;                     ///< of the section, where there is one
  std::optional<FoundSensitivities> found{};  ///< where they are asked for
  /// Of the samples and of the section: looked up once, for an answer of a thousand columns has as many pieces.
  std::vector<const ColumnCard*> columns, point_columns;

  FinishedRun(const PlannedRun& planned, const Solution& ended, const KeptRows& rows,
              const KeptRows* of_section = nullptr, const variations::Sensitivities* slopes = nullptr)
      : PlannedRun(planned), outcome(ended), samples(rows), points(of_section) {
    columns = cards_of(request, request.columns);
    if (points) point_columns = cards_of(request, request.section_columns());
    if (sensitivities && slopes) found.emplace(FoundSensitivities{*sensitivities, *slopes});
  }
};

/// `application/x-ndjson`, line by line: `head` with the echo, `samples`, `section`, `progress`, and `end` with all
/// that is known after the run. Of points of the section, `before` is how many there were.
std::string run_head_line(const PlannedRun& run);
std::string run_samples_line(const PlannedRun& run, std::span<const double> rows);
std::string run_points_line(const PlannedRun& run, std::span<const double> rows, std::int64_t before);
std::string run_progress_line(double t, std::int64_t steps);
std::string run_end_line(const PlannedRun& run, const Solution& outcome,
                         const variations::Sensitivities* slopes = nullptr);

/// A form of the whole answer, written in pieces, one after the other, whenever there is somewhere to put them: little
/// of a large answer exists as text at a time. A further form is a further entry of `forms`.
struct Form {
  std::string_view type;          ///< media type, as clients ask for it
  std::string_view content_type;  ///< as the answer says it
  std::size_t (*pieces)(const FinishedRun& run);
  void (*write)(const FinishedRun& run, std::size_t piece, std::string& out);
  void (*add_fields)(const FinishedRun& run, Answer& answer) = nullptr;  ///< header fields that go with it
};

/// All forms, the default first:
/// - `application/json`: the response of the contract.
/// - `text/csv`: a line of column names, then a line per sample; what has no value is empty. The rest stands as one
///   line of JSON in header fields `Leastaction-Status`, `-Stop`, `-End`, `-Request` (the echo), `-Choice`, `-Final`,
///   `-Diagnostics`, `-Events`, `-Sensitivities`, `-Cost` and `-Warnings`. One that would be longer than 4 KiB says
///   `{"omitted":true}`: the other forms have it. Points of a section are such a part, `-Section`; where no trajectory
///   is kept they are the lines.
/// - `application/cbor` (RFC 8949): the members of JSON, the columns of the trajectory as typed arrays (RFC 8746) of
///   binary64 in little endian, in which what has no value is NaN; a column of words is an array of texts.
std::span<const Form> forms();
/// The section of a run that has one, as an object.
void write_points(JsonWriter& json, const FinishedRun& run);
extern const Form csv_form;

/// An answer with its body in memory.
Answer whole_answer(const Form& form, const FinishedRun& run);
inline Answer encode_json(const FinishedRun& run) { return whole_answer(forms()[0], run); }
inline Answer encode_csv(const FinishedRun& run) { return whole_answer(forms()[1], run); }

}  // namespace least::server

// The solution of a run as bytes, written directly from the samples.
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

/// AdviceWithCards is how the scheme of a run was chosen, with the cards of all schemes.
struct AdviceWithCards {
  const Advice& advice;
  std::span<const SchemeCard> schemes;
  /// The wish was for seconds, so that the seconds of alternatives are reported. Otherwise they are omitted, as
  /// measured times would differ between answers to the same request.
  bool timed = false;
};

/// PlannedRun is what is known of a run before it begins, and is echoed.
struct PlannedRun {
  const Request& request;
  const ProblemCard& problem;
  const SchemeCard& scheme;
  const AdviceWithCards* choice = nullptr;                        ///< null where the client chose the scheme
  const variations::SensitivitiesAsked* sensitivities = nullptr;  ///< null where none are asked for
};

std::vector<const ColumnCard*> cards_of(const Request& request, const std::vector<std::size_t>& columns);

/// FoundSensitivities are the sensitivities asked for and found.
struct FoundSensitivities {
  const variations::SensitivitiesAsked& asked;
  const variations::Sensitivities& found;
};

/// FinishedRun is a completed run, with everything an encoder reads.
struct FinishedRun : PlannedRun {
  const Solution& outcome;
  const KeptRows& samples;
  const KeptRows* points;                     ///< null where there is no section
  std::optional<FoundSensitivities> found{};  ///< nothing where none are asked for
  /// The cards of the columns of samples and section, looked up once: an answer of a thousand columns has as many
  /// pieces.
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
/// that is known after the run. `before` is the number of earlier points of the section.
std::string run_head_line(const PlannedRun& run);
std::string run_samples_line(const PlannedRun& run, std::span<const double> rows);
std::string run_points_line(const PlannedRun& run, std::span<const double> rows, std::int64_t before);
std::string run_progress_line(double t, std::int64_t steps);
std::string run_end_line(const PlannedRun& run, const Solution& outcome,
                         const variations::Sensitivities* slopes = nullptr);

/// Form is a format of the whole answer, written in pieces one after the other as there is room, so that only a small
/// part of a large answer is in memory as text. A further format is a further entry of `forms`.
struct Form {
  std::string_view type;          ///< media type, as clients ask for it
  std::string_view content_type;  ///< media type, as the answer states it
  std::size_t (*pieces)(const FinishedRun& run);
  void (*write)(const FinishedRun& run, std::size_t piece, std::string& out);
  /// Adds header fields of this format; may be null
  void (*add_fields)(const FinishedRun& run, Answer& answer) = nullptr;
};

/// forms() returns all formats, the default first:
/// - `application/json`: the response of the API.
/// - `text/csv`: a line of column names, then a line per sample; missing values are empty. The other parts are JSON in
///   the header fields `Leastaction-Status`, `-Stop`, `-End`, `-Request` (the echo), `-Choice`, `-Final`,
///   `-Diagnostics`, `-Events`, `-Sensitivities`, `-Cost` and `-Warnings`, each on one line. A field that would exceed
///   4 KiB is `{"omitted":true}`; the other formats contain it. The points of a section are such a part, `-Section`;
///   where no trajectory is kept they are the lines.
/// - `application/cbor` (RFC 8949): the members of JSON, with the columns of the trajectory as typed arrays (RFC 8746)
///   of little-endian binary64 and NaN where there is no value; a column of words is an array of texts.
std::span<const Form> forms();
/// write_points writes the section of a run that has one, as an object.
void write_points(JsonWriter& json, const FinishedRun& run);
extern const Form csv_form;

/// whole_answer returns an answer with its body in memory.
Answer whole_answer(const Form& form, const FinishedRun& run);

}  // namespace least::server

#include "study/session/trial_table.h"

#include <optional>

#include "core/base/text.h"
#include "palpate/error.h"

#include "study/session/course.h"

namespace palpate::study {
namespace {

std::string yes_or_no(bool value) { return value ? "1" : "0"; }

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

void append_row(std::string& table, const std::vector<std::string>& fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) table += (i == 0 ? "" : ",") + csv_field(fields[i]);
  table += '\n';
}

// Columns of one interval.
std::vector<TrialColumn> interval_columns(const std::string& number, const std::string& which) {
  return {{"peak_force_" + number, "N", "largest tissue force of the " + which + " interval, without noise"},
          {"mean_force_" + number, "N", "mean tissue force of the " + which + " interval, without noise"},
          {"depth_" + number, "mm", "largest depth of the " + which + " interval"},
          {"work_" + number, "mJ", "work of the hand in the " + which + " interval"}};
}

std::vector<TrialColumn> make_columns() {
  std::vector<TrialColumn> columns = {
      {"participant", "", "random identifier"},
      {"session", "", "number of the session"},
      {"block", "", "haptic run within the session"},
      {"task", "", "name of the task in the study file"},
      {"trial_number", "", "number in the task, or in its practice, from 0"},
      {"time", "", "ISO 8601, UTC"},
      {"practice", "", "1: practice, which no analysis uses"},
      {"repetition", "", "1: the task's repetition at the end of its session"},
      {"catch_trial", "", "1: at the largest level"},
      {"condition", "", "the participant's own code until the study is unblinded, then the name"},
      {"level", "", "of the stimulus: log10 of N, ln of a ratio, log10 of ln of a ratio, or a target in N"},
      {"stimulus", "", "the level in the unit of the next column; below 1: the comparison is softer"},
      {"stimulus_unit", "", "mN, N, or ratio"},
      {"second", "", "1: the signal, or the comparison, was in the second interval"},
      {"answer", "", "1: first interval, 2: second interval, 0: none"},
      {"correct", "", "1: the answer was correct"},
      {"response_time", "s", "from the end of the second interval"},
      {"spoiled", "", "reasons, separated by semicolons; such a trial does not count"},
      {"rms_error", "N", "of the force held after the first second"},
      {"variation", "", "coefficient of variation of the force held after the first second"},
      {"observer", "", "simulated observer; empty: a person"}};
  for (const auto& [number, which] : {std::pair{"1", "first"}, std::pair{"2", "second"}}) {
    for (TrialColumn& column : interval_columns(number, which)) columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace

const std::vector<TrialColumn>& trial_columns() {
  static const std::vector<TrialColumn> columns = make_columns();
  return columns;
}

std::vector<std::string> trial_row(const Study& study, const Participant& person, const TrialRecord& trial,
                                   const ArmNames& names) {
  constexpr double kMilli = 1e3;
  const std::optional<std::size_t> found = study.find_task(trial.task);
  if (!found) throw InputError(person.log.id + ": task = `" + trial.task + "` is not in the study file");
  const StudyTask& task = study.tasks[*found];
  const std::vector<std::string>& arms = names.tasks()[*found].arms;
  const std::size_t arm = names.index_of(person.number, *found, trial.code);
  const bool choice = task.two_intervals();
  const Readable stimulus = readable_level(task, trial.level);
  std::vector<std::string> row = {person.log.id,
                                  std::to_string(trial.session),
                                  std::to_string(trial.block),
                                  trial.task,
                                  std::to_string(trial.number),
                                  trial.time,
                                  yes_or_no(trial.practice),
                                  yes_or_no(trial.repeat),
                                  yes_or_no(trial.catch_trial),
                                  names.unblinded() || arms.size() == 1 ? arms[arm] : trial.code,
                                  shortest(trial.level),
                                  brief(stimulus.value),
                                  stimulus.unit,
                                  choice ? yes_or_no(trial.second) : "",
                                  choice ? std::to_string(trial.answer) : "",
                                  choice && trial.answer != 0 ? yes_or_no(is_correct(task, trial)) : "",
                                  choice ? shortest(trial.response_time) : "",
                                  joined(trial.spoiled, ";"),
                                  choice ? "" : shortest(trial.rms_error),
                                  choice ? "" : shortest(trial.variation),
                                  trial.observer};
  for (std::size_t i = 0; i < trial.intervals.size(); ++i) {
    const IntervalCues& cues = trial.intervals[i];
    const bool exists = choice || i == 0;
    for (const double value : {cues.peak_force, cues.mean_force, kMilli * cues.depth, kMilli * cues.work}) {
      row.push_back(exists ? shortest(value) : "");
    }
  }
  return row;
}

std::string table_csv(const Study& study, std::span<const Participant> people, const ArmNames& names) {
  std::string table;
  std::vector<std::string> header;
  for (const TrialColumn& column : trial_columns()) {
    header.push_back(column.unit.empty() ? column.name : column.name + "_" + column.unit);
  }
  append_row(table, header);
  for (const Participant& person : people) {
    if (person.log.withdrawn()) continue;
    for (const TrialRecord& trial : person.log.trials) {
      append_row(table, trial_row(study, person, trial, names));
    }
  }
  return table;
}

}  // namespace palpate::study

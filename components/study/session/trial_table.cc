#include "study/session/trial_table.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "palpate/error.h"

#include "study/session/course.h"

namespace palpate::study {
namespace {

std::string yes_or_no(bool value) { return value ? "1" : "0"; }

void append_row(std::string& table, const std::vector<std::string>& fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) table += (i == 0 ? "" : ",") + csv_cell(fields[i]);
  table += '\n';
}

/// A column and its text for one trial.
struct Cell {
  TrialColumn column;
  std::string text;
};

void add_interval_cells(const std::string& number, const std::string& which, const IntervalCues& cues,
                        bool exists, std::vector<Cell>& cells) {
  constexpr double kMilli = 1e3;
  const auto add = [&](const char* name, const char* unit, const std::string& what, double value) {
    cells.push_back({{name + number, unit, what}, exists ? shortest(value) : ""});
  };
  const std::string without = " interval, without noise";
  add("peak_force_", "N", "largest tissue force of the " + which + without, cues.peak_force);
  add("mean_force_", "N", "mean tissue force of the " + which + without, cues.mean_force);
  add("depth_", "mm", "largest depth of the " + which + " interval", kMilli * cues.depth);
  add("work_", "mJ", "work of the hand in the " + which + " interval", kMilli * cues.work);
}

// @param rendering null: unknown @param shows_noise false while it would reveal the arm
void add_rendering_cells(const TrialRendering* rendering, bool shows_noise, bool choice,
                         std::vector<Cell>& cells) {
  const auto onset = [&](std::size_t i) {
    return rendering == nullptr || rendering->onset[i] < 0.0 ? "" : shortest(rendering->onset[i]);
  };
  const bool known = rendering != nullptr && rendering->threshold.has_value();
  cells.push_back({{"noise_sd", "N",
                    "standard deviation of the noise in contact; empty until unblinding where "
                    "it would reveal the condition"},
                   rendering != nullptr && shows_noise ? brief(rendering->noise, 6) : ""});
  cells.push_back({{"threshold_sd", "N", "the own noise threshold that the noise is a share of"},
                   known ? brief(*rendering->threshold, 6) : ""});
  cells.push_back({{"onset_1", "s",
                    "start of the first interval in the block's recording; the fade of 50 ms is before it"},
                   onset(0)});
  cells.push_back(
      {{"onset_2", "s", "start of the second interval in the block's recording"}, choice ? onset(1) : ""});
}

// All columns in their order. @param id of the participant
std::vector<Cell> cells_of(const StudyTask& task, const TrialRecord& trial, const std::string& id,
                           const std::string& condition, const TrialRendering* rendering, bool shows_noise) {
  const bool choice = task.two_intervals();
  const Readable stimulus = readable_level(task, trial.level);
  const auto if_choice = [&](const std::string& text) { return choice ? text : ""; };
  const auto if_hold = [&](const std::string& text) { return choice ? "" : text; };
  std::vector<Cell> cells = {
      {{"participant", "", "random identifier"}, id},
      {{"session", "", "number of the session"}, std::to_string(trial.session)},
      {{"block", "", "haptic run within the session"}, std::to_string(trial.block)},
      {{"task", "", "name of the task in the study file"}, trial.task},
      {{"trial_number", "", "number in the task, or in its practice, from 0"}, std::to_string(trial.number)},
      {{"time", "", "ISO 8601, UTC"}, trial.time},
      {{"practice", "", "1: practice, which no analysis uses"}, yes_or_no(trial.practice)},
      {{"repetition", "", "1: the task's repetition at the end of its session"}, yes_or_no(trial.repeat)},
      {{"catch_trial", "", "1: at the largest level"}, yes_or_no(trial.catch_trial)},
      {{"condition", "", "the participant's own code until the study is unblinded, then the name"},
       condition},
      {{"level", "", "of the stimulus: log10 of N, ln of a ratio, log10 of ln of a ratio, or a target in N"},
       shortest(trial.level)},
      {{"stimulus", "", "the level in the unit of the next column; below 1: the comparison is softer"},
       brief(stimulus.value)},
      {{"stimulus_unit", "", "mN, N, or ratio"}, stimulus.unit},
      {{"second", "", "1: the signal, or the comparison, was in the second interval"},
       if_choice(yes_or_no(trial.second))},
      {{"answer", "", "1: first interval, 2: second interval, 0: none"},
       if_choice(std::to_string(trial.answer))},
      {{"correct", "", "1: the answer was correct"},
       trial.answer == 0 ? "" : if_choice(yes_or_no(is_correct(task, trial)))},
      {{"response_time", "s", "from the end of the second interval"},
       if_choice(shortest(trial.response_time))},
      {{"spoiled", "", "reasons, separated by semicolons; such a trial does not count"},
       joined(trial.spoiled, ";")},
      {{"rms_error", "N", "of the force held after the first second"}, if_hold(shortest(trial.rms_error))},
      {{"variation", "", "coefficient of variation of the force held after the first second"},
       if_hold(shortest(trial.variation))},
      {{"observer", "", "simulated observer; empty: a person"}, trial.observer}};
  add_interval_cells("1", "first", trial.intervals[0], true, cells);
  add_interval_cells("2", "second", trial.intervals[1], choice, cells);
  add_rendering_cells(rendering, shows_noise, choice, cells);
  return cells;
}

}  // namespace

std::vector<TrialRendering> renderings_of(const Study& study, SealedKey key, const Participant& person,
                                          double rate_Hz) {
  std::vector<TrialRendering> renderings;
  Course course(study, key, person.number);
  std::optional<double> threshold;
  int session = 0;
  course.replay(person.log, [&](const Trial& planned, const TrialRecord& record) {
    if (record.session != session && study.tasks[planned.task].has_noise()) {
      threshold.reset();
      if (const auto own = course.threshold()) threshold = std::pow(10.0, own->log10.mean);
      session = record.session;
    }
    TrialRendering& made = renderings.emplace_back();
    made.noise = planned.noise;
    if (study.tasks[planned.task].has_noise()) made.threshold = threshold;
    for (std::size_t i = 0; i < 2; ++i) {
      if (record.intervals[i].from_tick == 0) continue;
      made.onset[i] = static_cast<double>(record.intervals[i].from_tick) / rate_Hz;
    }
  });
  return renderings;
}

const std::vector<TrialColumn>& trial_columns() {
  static const std::vector<TrialColumn> columns = [] {
    std::vector<TrialColumn> all;
    for (Cell& cell : cells_of({}, {}, "", "", nullptr, false)) all.push_back(std::move(cell.column));
    return all;
  }();
  return columns;
}

std::vector<std::string> trial_row(const Study& study, const Participant& person, const TrialRecord& trial,
                                   const ArmNames& names) {
  const std::optional<std::size_t> found = study.find_task(trial.task);
  if (!found) throw InputError(person.log.id + ": task = `" + trial.task + "` is not in the study file");
  const std::vector<std::string>& arms = names.tasks()[*found].arms;
  const std::size_t arm = names.index_of(person.number, *found, trial.code);
  const std::string& condition = names.unblinded() || arms.size() == 1 ? arms[arm] : trial.code;
  std::vector<std::string> row;
  const auto index = static_cast<std::size_t>(&trial - person.log.trials.data());
  const TrialRendering* rendering = index < person.renderings.size() ? &person.renderings[index] : nullptr;
  for (Cell& cell : cells_of(study.tasks[*found], trial, person.log.id, condition, rendering,
                             names.unblinded() || arms.size() == 1)) {
    row.push_back(std::move(cell.text));
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

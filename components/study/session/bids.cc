#include "study/session/bids.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <system_error>
#include <tuple>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/version.h"

#include "study/session/deletion.h"
#include "study/session/trial_table.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Columns that the name of the file states.
constexpr const char* kInFileName[] = {"participant", "session", "task", "repetition"};

bool in_file_name(const std::string& column) {
  return std::find(std::begin(kInFileName), std::end(kInFileName), column) != std::end(kInFileName);
}

std::string cell(const std::string& text) { return text.empty() ? "n/a" : one_line(text); }

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be made: " + error.message());
}

void write_json(const fs::path& file, const Json& json) { write_output(file, json.dump(2) + '\n'); }

// A name with letters and digits alone, as BIDS needs: "weak-force" is "weakforce".
std::string bids_name(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += c;
  }
  return plain.empty() ? "task" : plain;
}

// Names of the tasks in files; two that differ in punctuation alone get a number.
std::vector<std::string> task_names(const Study& study) {
  std::vector<std::string> names;
  for (const StudyTask& task : study.tasks) {
    const std::string name = bids_name(task.name);
    std::string unique = name;
    for (int number = 2; std::find(names.begin(), names.end(), unique) != names.end(); ++number) {
      unique = name + std::to_string(number);
    }
    names.push_back(unique);
  }
  return names;
}

void write_description(const BidsSource& source, const fs::path& folder) {
  Json json = {{"Name", source.study.name}, {"BIDSVersion", "1.8.0"}, {"DatasetType", "raw"}};
  if (!source.study.approval.empty()) json["EthicsApprovals"] = Json::array({source.study.approval});
  json["GeneratedBy"] = Json::array({{{"Name", "palpate"}, {"Version", kVersion}}});
  write_json(folder / "dataset_description.json", json);
  std::size_t withdrawn = 0;
  for (const Participant& person : source.people) withdrawn += person.log.withdrawn() ? 1 : 0;
  const std::string deletions = deletions_text(deletions_of(source.people));
  write_output(
      folder / "README",
      fmt::format("{}\n\nA behavioural study of touch with Palpate {}, a haptic simulator of soft tissue.\n{}"
                  "Scene: {}. Seed: {}. SHA-256 of the registered study: {}.\n"
                  "{}\n{} withdrew and are not in this data set.\n{}Trials that do not count have a reason "
                  "in the column `spoiled`, or 1 in `practice`.\n"
                  "Please add authors and a licence to dataset_description.json before you publish it.\n",
                  source.study.name, kVersion,
                  source.simulated ? "ALL PARTICIPANTS ARE SIMULATED. These are not data of people.\n" : "",
                  source.study.scene, source.study.seed, source.lock_hash,
                  source.names.unblinded()
                      ? "The study is unblinded: the column `condition` has the conditions."
                      : "The study is blind: the column `condition` is n/a.",
                  counted(withdrawn, "person", "people"), deletions.empty() ? "" : deletions + ".\n"));
  write_output(folder / "CHANGES",
               fmt::format("1.0.0 {}\n  - Exported by palpate {}.\n", utc_now().substr(0, 10), kVersion));
}

std::string answer_of(const ParticipantLog& log, const std::string& question) {
  for (const EventRecord& event : log.events) {
    if (event.event == "answers" && !event.value(question).empty()) return event.value(question);
  }
  return "";
}

void write_participants(const BidsSource& source, const fs::path& folder) {
  std::string table = "participant_id";
  Json description = Json::object();
  description["simulated"] = {{"Description", "whether a simulated observer answered"},
                              {"Levels", {{"yes", "simulated"}, {"no", "a person"}}}};
  for (const std::string& question : source.study.ask) {
    table += '\t' + question;
    description[question] = {{"Description", "answer of the participant, in bands"}};
  }
  table += "\tsimulated\n";
  for (const Participant& person : source.people) {
    if (person.log.withdrawn() || person.log.trials.empty()) continue;
    table += "sub-" + bids_name(person.log.id);
    for (const std::string& question : source.study.ask)
      table += '\t' + cell(answer_of(person.log, question));
    table += std::string("\t") + (person.log.trials.front().observer.empty() ? "no" : "yes") + '\n';
  }
  write_output(folder / "participants.tsv", table);
  write_json(folder / "participants.json", description);
}

// Description of the columns of a task's tables.
Json columns_json(const BidsSource& source, std::size_t task) {
  Json json = {{"TaskName", source.study.tasks[task].name},
               {"SoftwareName", "palpate"},
               {"SoftwareVersion", kVersion},
               {"Seed", source.study.seed}};
  for (const TrialColumn& column : trial_columns()) {
    if (in_file_name(column.name)) continue;
    Json& of = json[column.name] = {{"Description", column.description}};
    if (!column.unit.empty()) of["Units"] = column.unit;
    if (column.name != "condition") continue;
    of["Description"] =
        source.names.unblinded() ? "condition of the study file" : "n/a until the study is unblinded";
    if (!source.names.unblinded()) continue;
    for (const Arm& arm : source.study.tasks[task].arms) {
      if (arm.name.empty()) continue;
      of["Levels"][arm.name] =
          fmt::format("noise of {} x the own noise threshold, {}", brief(arm.share),
                      arm.profile == NoiseProfile::kConstant ? "constant" : "growing near the tissue");
    }
  }
  return json;
}

std::string header_line() {
  std::string line;
  for (const TrialColumn& column : trial_columns()) {
    if (!in_file_name(column.name)) line += (line.empty() ? "" : "\t") + column.name;
  }
  return line + '\n';
}

std::string trial_line(const BidsSource& source, const Participant& person, const TrialRecord& trial) {
  const std::vector<TrialColumn>& columns = trial_columns();
  const std::vector<std::string> row = trial_row(source.study, person, trial, source.names);
  std::string line;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (in_file_name(columns[i].name)) continue;
    const bool hidden = columns[i].name == "condition" && !source.names.unblinded();
    line += (line.empty() ? "" : "\t") + (hidden ? "n/a" : cell(row[i]));
  }
  return line + '\n';
}

void write_person(const BidsSource& source, const std::vector<std::string>& tasks, const Participant& person,
                  const fs::path& folder) {
  std::map<std::tuple<int, std::size_t, bool>, std::string> tables;  // session, task, repetition
  for (const TrialRecord& trial : person.log.trials) {
    const std::size_t task = source.study.find_task(trial.task).value();
    std::string& table = tables[{trial.session, task, trial.repeat}];
    if (table.empty()) table = header_line();
    table += trial_line(source, person, trial);
  }
  const std::string subject = "sub-" + bids_name(person.log.id);
  for (const auto& [key, table] : tables) {
    const auto& [session, task, repetition] = key;
    const fs::path beh = folder / subject / fmt::format("ses-{}", session) / "beh";
    make_folder(beh);
    const std::string name =
        fmt::format("{}_ses-{}_task-{}_run-{}_beh", subject, session, tasks[task], repetition ? 2 : 1);
    write_output(beh / (name + ".tsv"), table);
    write_json(beh / (name + ".json"), columns_json(source, task));
  }
}

void link_recordings(const BidsSource& source, const Participant& person, const fs::path& folder) {
  for (const EventRecord& event : person.log.events) {
    if (event.event != "block" || event.value("recording").empty()) continue;
    const fs::path from = source.recordings / fs::path(event.value("recording")).filename();
    if (!file_exists(from)) continue;
    const fs::path to =
        folder / "sourcedata" / ("sub-" + bids_name(person.log.id)) / ("ses-" + event.value("session"));
    make_folder(to);
    std::error_code error;
    fs::create_hard_link(from, to / from.filename(), error);
    if (!error) continue;
    error.clear();
    fs::copy_file(from, to / from.filename(), error);
    if (error) throw InputError((to / from.filename()).string() + ": cannot be written: " + error.message());
  }
}

}  // namespace

void write_bids(const BidsSource& source, const fs::path& folder) {
  if (!is_free_folder(folder)) {
    throw InputError(folder.string() + ": exists; give a folder that is missing or empty");
  }
  make_folder(folder);
  write_description(source, folder);
  write_participants(source, folder);
  const std::vector<std::string> tasks = task_names(source.study);
  for (const Participant& person : source.people) {
    if (person.log.withdrawn()) continue;
    write_person(source, tasks, person, folder);
    if (source.names.unblinded() && !source.recordings.empty()) link_recordings(source, person, folder);
  }
}

}  // namespace palpate::study

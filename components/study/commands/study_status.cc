// `palpate study status` and `palpate study verify`: how far the participants are, and whether all files are
// consistent.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "palpate/recording.h"

#include "app/commands.h"
#include "app/output.h"
#include "app/progress.h"
#include "study/commands/study_commands.h"
#include "study/session/deletion.h"
#include "study/session/verify.h"

namespace palpate::app {
namespace {

struct StudyFolderFlags {
  std::string folder;
  bool json = false;
  bool logs_only = false;
  bool no_cache = false;
};

struct ParticipantStatus {
  std::string id;
  std::size_t sessions = 0;          // completed
  std::size_t planned_sessions = 0;  // by this person's order of the tasks
  int planned_trials = 0;
  int trials = 0;  // that count, without practice
  int spoiled = 0;
  bool withdrawn = false;
  std::optional<study::Deletion> deletion;
  bool undeleted_files = false;  // of a deletion that was cut short
  std::string last;              // time of the last line
  std::size_t cut_lines = 0;     // incomplete lines of crashes
};

std::size_t cut_lines_in(const std::filesystem::path& log) {
  const std::filesystem::path file = study::cut_lines_of(log);
  if (!file_exists(file)) return 0;
  const std::string text = InputFile(file, kTaskRecordInput).read_rest();
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

int planned_trials(const std::vector<study::PlannedSession>& sessions) {
  int trials = 0;
  for (const study::PlannedSession& session : sessions) {
    for (const study::PlannedPart& part : session.parts) trials += part.trials;
  }
  return trials;
}

ParticipantStatus status_of(const study::StudyFolder& study, const std::string& id) {
  const study::ParticipantLog log = study.read(id);
  ParticipantStatus status;
  status.id = id;
  const std::vector<study::PlannedSession> planned = study::plan_sessions(study.study, study.number_of(id));
  status.planned_sessions = planned.size();
  status.planned_trials = planned_trials(planned);
  status.sessions = log.finished_sessions();
  for (const study::EventRecord& event : log.events) status.last = std::max(status.last, event.time);
  for (const study::TrialRecord& trial : log.trials) {
    status.last = std::max(status.last, trial.time);
    if (!trial.practice) ++(trial.spoiled.empty() ? status.trials : status.spoiled);
  }
  status.withdrawn = log.withdrawn();
  status.deletion = log.deletion();
  status.undeleted_files = status.deletion && !study::files_of_person(study, id).empty();
  status.cut_lines = cut_lines_in(study.log_of(id)) + (log.cut ? 1 : 0);
  return status;
}

std::string remark_of(const ParticipantStatus& one) {
  if (one.undeleted_files) return "  data not wholly deleted: `palpate study delete` again";
  if (one.deletion) return "  data deleted on request: " + one_line(one.deletion->reason);
  return one.withdrawn ? "  withdrawn" : "";
}

void print_status(const study::StudyFolder& study, const std::vector<ParticipantStatus>& people) {
  std::cout << fmt::format("study {}, {}{}\n\n", study.study.name, study.unblinded() ? "unblinded" : "blind",
                           study.simulated ? ", simulated participants" : "");
  std::cout << fmt::format("{:<8}{:>9}{:>13}{:>9}{:>6}  {}\n", "id", "sessions", "trials", "spoiled", "cut",
                           "last entry (UTC)");
  for (const ParticipantStatus& one : people) {
    std::cout << fmt::format("{:<8}{:>9}{:>13}{:>9}{:>6}  {}{}\n", one.id,
                             fmt::format("{}/{}", one.sessions, one.planned_sessions),
                             fmt::format("{}/{}", one.trials, one.planned_trials), one.spoiled, one.cut_lines,
                             one.last.empty() ? "-" : one.last, remark_of(one));
  }
}

void print_status_json(const study::StudyFolder& study, const std::vector<ParticipantStatus>& people) {
  const std::vector<study::PlannedSession> first = study::plan_sessions(study.study);
  nlohmann::ordered_json json;
  json["study"] = study.study.name;
  json["unblinded"] = study.unblinded();
  json["simulated"] = study.simulated;
  json["sessions"] = first.size();
  json["trials"] = planned_trials(first);
  json["participants"] = nlohmann::ordered_json::array();
  for (const ParticipantStatus& one : people) {
    json["participants"].push_back({{"id", one.id},
                                    {"sessions", one.sessions},
                                    {"planned_sessions", one.planned_sessions},
                                    {"trials", one.trials},
                                    {"planned_trials", one.planned_trials},
                                    {"spoiled", one.spoiled},
                                    {"withdrawn", one.withdrawn},
                                    {"deleted", one.deletion.has_value()},
                                    {"last", one.last},
                                    {"cut_lines", one.cut_lines}});
  }
  std::cout << json.dump(2) << '\n';
}

int show_status(const StudyFolderFlags& flags) {
  const study::StudyFolder study = study::open_study(flags.folder);
  std::vector<ParticipantStatus> people;
  for (const std::string& id : study.ids) people.push_back(status_of(study, id));
  const auto print = flags.json ? print_status_json : print_status;
  print(study, people);
  return kDone;
}

/// Replays a recording, also of a blind study. @return the first difference, without its values
std::string replay_defect(const record::Recording& recording, bool no_cache,
                          const record::Progress& progress) {
  const OrganPreparation preparation(no_cache);  // its bar stays away where an organ is ready at once
  const record::ReplayResult result = record::replay(recording, progress, preparation.how());
  if (result.rows_different == 0) return "";
  return fmt::format("does not replay: {} of {} rows differ; first: {}", result.rows_different,
                     result.rows_compared, result.first_difference);
}

/// What verify_study() compares.
std::vector<std::string> checks_of(const StudyFolderFlags& flags, const study::VerifyCounts& counts) {
  std::vector<std::string> checks = {
      "study, scene, consent text and sealed key by their SHA-256 in lock.json",
      "simulated.json, unblinded.json, each log's end and each of its lines by macs of the sealed key",
      "each trial follows from the answers before it"};
  if (flags.logs_only || counts.recordings == 0) return checks;
  checks.emplace_back("each recording by its SHA-256 in the log, and that it replays bit for bit");
  checks.emplace_back("order and ticks of the log's trials, and their commanded noise, force and stiffness");
  checks.emplace_back("force, depth and work in the log follow from the recorded rows");
  return checks;
}

int verify_study(const StudyFolderFlags& flags) {
  const study::StudyFolder study = study::open_study(flags.folder);
  const std::vector<std::string> foreign = study::verify_folder(study);
  Progress bar("verify");
  study::VerifyCounts counts;
  for (std::size_t i = 0; i < study.ids.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(study.ids.size());
    bar.update(share, "checking " + study.ids[i]);
    study::CheckRecording check;
    if (!flags.logs_only) {
      check = [&](const record::Recording& recording) {
        return replay_defect(recording, flags.no_cache, [&](double replayed) {
          bar.update(share, fmt::format("checking {}, recording {}: {:.0f} %", study.ids[i],
                                        counts.recordings + 1, 100.0 * replayed));
        });
      };
    }
    study::verify_participant(study, study.ids[i], check, counts);
  }
  bar.clear();
  if (flags.json) {
    const nlohmann::ordered_json json{{"study", study.study.name},
                                      {"logs", counts.logs},
                                      {"trials", counts.trials},
                                      {"recordings", counts.recordings},
                                      {"unfinished", counts.unfinished},
                                      {"deleted", counts.deleted.size()},
                                      {"replayed", !flags.logs_only},
                                      {"foreign", foreign},
                                      {"checked", checks_of(flags, counts)}};
    std::cout << json_text(json) << '\n';
    return kDone;
  }
  std::cout << fmt::format("study {}: {}, {} and {} are consistent with the sealed key and with each other\n",
                           study.study.name, counted(counts.logs, "log", "logs"),
                           counted(counts.trials, "trial", "trials"),
                           counted(counts.recordings, "recording", "recordings"));
  for (const std::string& made : checks_of(flags, counts)) std::cout << "checked: " << made << '\n';
  if (!counts.deleted.empty()) std::cout << study::deletions_text(counts.deleted) << '\n';
  if (flags.logs_only) std::cout << "not checked: the content of the recordings\n";
  if (counts.unfinished > 0) {
    std::cout << fmt::format("not checked: {} cut off before the end of a block\n",
                             counted(counts.unfinished, "recording was", "recordings were"));
  }
  for (const std::string& file : foreign) {
    std::cout << "no part of the study: " << file
              << (study::is_leftover(study, file) ? ", left by a killed command" : "") << '\n';
  }
  return kDone;
}

}  // namespace

void add_study_status(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<StudyFolderFlags>();
  CLI::App* command = study.add_subcommand("status", "Show how far each participant is");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_flag("--json", flags->json, "print one JSON document");
  command->footer(
      "Examples:\n  palpate study status touch\n  palpate study status touch --json\n"
      "cut: incomplete lines of crashes. They are kept in participants/ID.cut; their trials are repeated.");
  command->callback([flags, &exit_code] { exit_code = show_status(*flags); });
}

void add_study_verify(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<StudyFolderFlags>();
  CLI::App* command = study.add_subcommand("verify", "Check that study, logs and recordings are consistent");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_flag("--logs-only", flags->logs_only, "do not replay the recordings");
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->add_flag("--json", flags->json, "print one JSON document");
  command->footer(
      "Examples:\n  palpate study verify touch\n  palpate study verify touch --logs-only --json\n"
      "Prints what it checked, and which files are no part of the study. A person who has sealed.json can\n"
      "forge a consistent folder, and an older copy of the whole folder is consistent too.\n"
      "Exit: 0 consistent, 2 not; the message names the first fault.");
  command->callback([flags, &exit_code] { exit_code = verify_study(*flags); });
}

}  // namespace palpate::app

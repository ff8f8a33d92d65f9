#include "study/session/verify.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

#include "study/session/compare_recording.h"
#include "study/session/deletion.h"
#include "study/session/folder_parts.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;

using BlockKey = std::pair<std::string, std::string>;  // session and block, as texts
using Blocks = std::map<BlockKey, std::vector<ReplayedTrial>>;

/// The trials of each block, which follow from the answers before them.
Blocks replayed_blocks(const StudyFolder& study, const std::string& id, const ParticipantLog& log) {
  Blocks blocks;
  try {
    Course(study.study, study.key, study.number_of(id))
        .replay(log, [&](const Trial& planned, const TrialRecord& logged) {
          blocks[{std::to_string(logged.session), std::to_string(logged.block)}].push_back({planned, logged});
        });
  } catch (const InputError& error) {
    throw InputError(study.log_of(id).string() + ": " + error.what());
  }
  return blocks;
}

/// The recording that an event "block" names. @throws InputError when it is missing
fs::path recording_of(const StudyFolder& study, const std::string& id, const EventRecord& event) {
  const fs::path name = event.value("recording");
  const std::string named_by = fmt::format("{}: session {}, block {}", study.log_of(id).string(),
                                           excerpt(event.value("session")), excerpt(event.value("block")));
  if (name != name.filename()) {
    throw InputError(fmt::format("{}: recording = \"{}\": must be the name of a file in recordings", named_by,
                                 excerpt(name.string())));
  }
  const fs::path file = study.folder / "recordings" / name;
  if (!file_exists(file)) {
    throw InputError(fmt::format("{}: its recording {} is missing", named_by, file.string()));
  }
  static_cast<void>(InputFile(file, kRecordingInput));  // a regular file
  return file;
}

/// @return the defect, or an empty text
std::string recording_defect(const StudyFolder& study, const fs::path& file, const EventRecord& event,
                             const std::vector<ReplayedTrial>& trials, const CheckRecording& check) {
  if (sha256_of_file(file) != event.value("sha256")) {
    return "was changed after the block: its SHA-256 is another one than in the log";
  }
  const record::Recording recording = record::read_recording(file, {}, record::Blind::kAllow);
  if (recording.facts.study != study.mark()) return "is of another study";
  const std::string defect = compare_with_recording(study.study, trials, recording);
  return defect.empty() ? check(recording) : defect;
}

}  // namespace

std::vector<std::string> verify_folder(const StudyFolder& study) {
  const fs::path heads = study.folder / LogHeads::kName;
  const std::size_t lines = 1 + study.ids.size();
  if (InputFile(heads, kStudyFileInput).size() > lines * LogHeads::text_of({}, study.mac_key).size()) {
    throw InputError(
        fmt::format("{}:{}: was added: the file must end with the line of the last participant, {}",
                    heads.string(), lines + 1, lines));
  }
  std::set<std::string> own{"lock.json",      "sealed.json",    LogHeads::kName,
                            "simulated.json", "unblinded.json", "recordings/blind-broken.jsonl"};
  own.insert(study.files.begin(), study.files.end());
  for (const std::string& id : study.ids) {
    own.insert({"participants/" + id + ".jsonl", "participants/" + id + ".cut", id + "-status.txt"});
  }
  std::vector<std::string> foreign;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(study.folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path path = entry->path().lexically_relative(study.folder);
    if (entry->symlink_status(error).type() == fs::file_type::directory) continue;
    const std::string name = path.filename().string();
    const bool recording = path.parent_path() == "recordings" &&
                           std::any_of(study.ids.begin(), study.ids.end(), [&](const std::string& id) {
                             return study.is_recording_of(id, name);
                           });
    if (!recording && !own.contains(path.generic_string())) foreign.push_back(path.generic_string());
  }
  if (error) throw InputError(study.folder.string() + ": cannot be read: " + error.message());
  std::sort(foreign.begin(), foreign.end());
  return foreign;
}

void verify_participant(const StudyFolder& study, const std::string& id,
                        const CheckRecording& check_recording, VerifyCounts& counts) {
  const ParticipantLog log = study.read(id);
  ++counts.logs;
  if (const std::optional<Deletion> deletion = log.deletion()) {
    require_deleted(study, id);
    counts.deleted.emplace_back(id, *deletion);
    return;
  }
  const Blocks blocks = replayed_blocks(study, id, log);
  counts.trials += log.trials.size();
  std::set<std::string> named;
  for (const EventRecord& event : log.events) {
    if (event.event != "block" || event.value("recording").empty()) continue;
    const fs::path file = recording_of(study, id, event);
    if (check_recording) {
      const auto block = blocks.find({event.value("session"), event.value("block")});
      const std::string defect = recording_defect(
          study, file, event, block == blocks.end() ? std::vector<ReplayedTrial>() : block->second,
          check_recording);
      if (!defect.empty()) throw InputError(fmt::format("{}: {}", file.string(), defect));
    }
    ++counts.recordings;
    named.insert(file.filename().string());
  }
  const fs::path folder = study.folder / "recordings";
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (study.is_recording_of(id, name) && !named.contains(name)) ++counts.unfinished;
  }
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
}

}  // namespace palpate::study

#include "science/experiment/verify.h"

#include <map>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/sha256.h"
#include "palpate/error.h"
#include "science/experiment/compare_recording.h"

namespace palpate::experiment {
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
  if (!regular_file_exists(file)) {
    throw InputError(fmt::format("{}: its recording {} is missing", named_by, file.string()));
  }
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

void verify_participant(const StudyFolder& study, const std::string& id,
                        const CheckRecording& check_recording, VerifyCounts& counts) {
  const ParticipantLog log = study.read(id);
  const Blocks blocks = replayed_blocks(study, id, log);
  ++counts.logs;
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
    if (name.starts_with(id + "-") && name.ends_with(".h5") && !named.contains(name)) ++counts.unfinished;
  }
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
}

}  // namespace palpate::experiment

#include "science/experiment/verify.h"

#include <set>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"
#include "science/experiment/course.h"

namespace palpate::experiment {

void verify_participant(const StudyFolder& study, SealedKey key, const std::string& id,
                        const CheckRecording& check_recording, VerifyCounts& counts) {
  const ParticipantLog log = study.read(id);
  try {
    Course(study.study, key, study.number_of(id)).replay(log);
  } catch (const InputError& error) {
    throw InputError(study.log_of(id).string() + ": " + error.what());
  }
  ++counts.logs;
  counts.trials += log.trials.size();
  std::set<std::string> named;
  for (const EventRecord& event : log.events) {
    const std::filesystem::path name = event.value("recording");
    if (event.event != "block" || name.empty()) continue;
    const std::string named_by = fmt::format("{}: session {}, block {}", study.log_of(id).string(),
                                             excerpt(event.value("session")), excerpt(event.value("block")));
    if (name != name.filename()) {
      throw InputError(fmt::format("{}: recording = \"{}\": must be the name of a file in recordings",
                                   named_by, excerpt(name.string())));
    }
    const std::filesystem::path file = study.folder / "recordings" / name;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      throw InputError(fmt::format("{}: its recording {} is missing", named_by, file.string()));
    }
    const std::string defect = check_recording ? check_recording(file) : "";
    if (!defect.empty()) throw InputError(fmt::format("{}: {}", file.string(), defect));
    ++counts.recordings;
    named.insert(name.string());
  }
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(study.folder / "recordings", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(id + "-") && name.ends_with(".h5") && !named.contains(name)) ++counts.unfinished;
  }
}

}  // namespace palpate::experiment

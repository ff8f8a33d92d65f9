#include "study/session/deletion.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/core.h>
#include <unistd.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/temporary.h"
#include "io/system/whole_file.h"
#include "palpate/error.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;

/// Adds the files of a folder whose names fit.
template <typename Fits>
void add_files(const fs::path& folder, const Fits& fits, std::vector<fs::path>& files) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (fits(entry->path())) files.push_back(entry->path());
  }
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
}

/// A log that does not fit its chain, or is missing, does not keep a person's data: empty.
std::optional<ParticipantLog> read_if_consistent(const StudyFolder& study, const std::string& id) {
  try {
    return study.read(id);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Replaces a log by its only line, whole or not at all. @return the new end
LogHead replace_log(const StudyFolder& study, const std::string& id, const Deletion& deletion) {
  const fs::path file = study.log_of(id);
  std::string temporary = (file.parent_path() / ("." + file.filename().string() + ".")).string();
  constexpr mode_t kRights = 0644;
  const int descriptor = open_temporary_file(temporary, kRights);
  if (descriptor < 0) throw InputError(file.string() + ": cannot be replaced: " + std::strerror(errno));
  ::close(descriptor);
  LogKey key = study.log_key(id);
  key.heads.clear();
  std::error_code error;
  try {
    LogWriter(temporary, key).append(deleted_event(deletion));
    const ParticipantLog made = read_log(temporary, key);
    fs::rename(temporary, file, error);
    if (error) throw InputError(file.string() + ": cannot be replaced: " + error.message());
    flush_folder(file.parent_path());
    return {made.lines(), made.last_mac};
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

}  // namespace

std::vector<fs::path> files_of_person(const StudyFolder& study, const std::string& id) {
  const fs::path log = study.log_of(id);
  std::vector<fs::path> files;
  const auto of_log = [&](const fs::path& path) {
    return path == log || path == cut_lines_of(log) || name_of_unfinished(path) == log.filename();
  };
  add_files(log.parent_path(), of_log, files);
  const auto of_recording = [&](const fs::path& path) {
    return study.is_recording_of(id, path.filename().string());
  };
  add_files(study.folder / "recordings", of_recording, files);
  const fs::path status = study.folder / (id + "-status.txt");
  if (file_or_link_exists(status)) files.push_back(status);
  const std::optional<ParticipantLog> read = read_if_consistent(study, id);
  if (read && read->deletion()) std::erase(files, log);
  std::sort(files.begin(), files.end());
  return files;
}

Deletion delete_person(const StudyFolder& study, const std::string& id, const std::string& why) {
  if (trimmed(why).empty()) throw InputError("--why: must be the reason, not empty");
  const LogHeads heads(study.folder / LogHeads::kName, LogHeads::Use::kUnblind);  // no session runs
  remove_leftovers(study);
  const LogKey key = study.log_key(id);
  const std::optional<ParticipantLog> log = read_if_consistent(study, id);
  std::vector<fs::path> files = files_of_person(study, id);
  if (log && log->lines() == 0 && files.empty()) {
    throw InputError(fmt::format("{}: there are no data of {}", study.folder.string(), id));
  }
  std::optional<Deletion> deletion = log ? log->deletion() : std::nullopt;
  if (!deletion) {
    const LogHead before = log ? LogHead{log->lines(), log->last_mac} : heads.read(key.number, key.mac_key);
    deletion = Deletion{utc_now(), why, before, !log};
    heads.write(key.number, before, key.mac_key);  // the new log names it
    heads.flush();
    heads.write(key.number, replace_log(study, id, *deletion), key.mac_key);
    std::erase(files, study.log_of(id));
  } else {
    heads.write(key.number, {log->lines(), log->last_mac}, key.mac_key);
  }
  heads.flush();
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) throw InputError(file.string() + ": cannot be removed: " + error.message());
  }
  for (const char* folder : {"participants", "recordings", ""}) flush_folder(study.folder / folder);
  return *deletion;
}

void require_deleted(const StudyFolder& study, const std::string& id) {
  const std::vector<fs::path> left = files_of_person(study, id);
  if (left.empty()) return;
  throw InputError(fmt::format(
      "{}: is there, though the data of {} were deleted ({} of them left): `palpate study delete` again "
      "removes {}",
      left.front().string(), id, counted(left.size(), "file", "files"), left.size() == 1 ? "it" : "them"));
}

std::string deletions_text(const Deletions& deletions) {
  constexpr std::size_t kDate = 10;  // characters of a time
  if (deletions.empty()) return "";
  std::string text =
      deletions.size() == 1 ? "1 person's data" : fmt::format("{} people's data", deletions.size());
  text += " deleted on request";
  const char* separator = " (";
  for (const auto& [id, deletion] : deletions) {
    text += fmt::format("{}{}, {}: {}{}", separator, id, deletion.time.substr(0, kDate),
                        one_line(deletion.reason), deletion.damaged ? "; the log was damaged before" : "");
    separator = "; ";
  }
  return text + ")";
}

}  // namespace palpate::study

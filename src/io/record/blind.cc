#include "io/record/blind.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/input_file.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

/// The recording's folder, with symbolic links followed. @throws InputError when it cannot be found
std::filesystem::path folder_of(const std::filesystem::path& recording) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(recording, error);
  if (error) throw InputError(to_text(recording) + ": its folder cannot be found: " + error.message());
  return file.parent_path();
}

}  // namespace

bool is_unblinded(const std::filesystem::path& recording, const StudyMark& study) {
  constexpr InputKind kUnblindedInput{"the file unblinded.json of a study", std::uint64_t{1} << 20};
  const std::filesystem::path file = folder_of(recording).parent_path() / "unblinded.json";
  if (study.commitment.empty() || !file_exists(file)) return false;
  const std::string text = InputFile(file, kUnblindedInput).read_rest();
  try {
    const nlohmann::json values = parse_json(text);
    return sha256(JsonField(values).at("proof").text()) == study.commitment;
  } catch (const InputError&) {
    return false;  // not the study's own file
  }
}

void refuse_blind(const std::filesystem::path& recording, const std::string& study) {
  throw InputError(fmt::format(
      "{}: belongs to the study {}, which is still blind: its forces and noise show the condition. `palpate "
      "study unblind` opens all recordings in the study's folder; --break-blind opens this one and keeps a "
      "note of it beside the file",
      to_text(recording), study));
}

void log_broken_blind(const std::filesystem::path& recording, const std::string& command) {
  const std::filesystem::path log = folder_of(recording) / "blind-broken.jsonl";
  nlohmann::ordered_json entry;
  entry["time"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  entry["event"] = "break-blind";
  entry["file"] = to_text(recording.filename());
  entry["command"] = command;
  const std::string line = entry.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  constexpr int kAppend = O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
  const int fd = open_file(log, kAppend, 0666);
  const std::ptrdiff_t count = fd < 0 ? -1 : write_next(fd, line.data(), line.size());
  const bool cut = count >= 0 && static_cast<std::size_t>(count) < line.size();  // errno is not set
  const bool written = count >= 0 && !cut && flush_to_disk(fd) == 0;
  const std::string why = cut ? "there is no space for the whole line" : std::strerror(errno);
  if (fd >= 0) ::close(fd);
  if (written) return;
  throw InputError(
      fmt::format("{}: cannot be written, so {} stays blind: {}", to_text(log), to_text(recording), why));
}

}  // namespace palpate::record

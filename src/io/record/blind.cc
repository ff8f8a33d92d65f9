#include "io/record/blind.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "io/system/path_text.h"
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

bool is_unblinded(const std::filesystem::path& recording) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder_of(recording).parent_path() / "unblinded.json", error);
}

void refuse_blind(const std::filesystem::path& recording, const std::string& study) {
  throw InputError(fmt::format(
      "{}: belongs to the study {}, which is still blind: its forces and noise show the condition. `palpate "
      "study unblind` opens all recordings of a study; --break-blind opens this one and keeps a note of it",
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
  const int fd = ::open(log.c_str(), kAppend, 0666);
  const ssize_t count = fd < 0 ? -1 : ::write(fd, line.data(), line.size());
  const bool cut = count >= 0 && static_cast<std::size_t>(count) < line.size();  // errno is not set
  const bool written = count >= 0 && !cut && ::fsync(fd) == 0;
  const std::string why = cut ? "there is no space for the whole line" : std::strerror(errno);
  if (fd >= 0) ::close(fd);
  if (written) return;
  throw InputError(
      fmt::format("{}: cannot be written, so {} stays blind: {}", to_text(log), to_text(recording), why));
}

}  // namespace palpate::record

#include "io/system/cache_folder.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <vector>

#include "io/system/path_text.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTemporaryLetters = 7;  // a dot and mkstemp's six letters
constexpr std::chrono::hours kAbandoned{1};

/// The folder that the environment variable `variable` names, else `in_home` in the home folder; empty if
/// neither is set. On Windows %LOCALAPPDATA%.
fs::path user_folder(const char* variable, const char* in_home) {
  if (const fs::path local = environment_path("LOCALAPPDATA"); kIsWindows && local.is_absolute()) {
    return local / "palpate";
  }
  const fs::path given = environment_path(variable);
  if (given.is_absolute()) return given / "palpate";
  const fs::path home = environment_path("HOME");
  return home.is_absolute() ? home / in_home / "palpate" : fs::path();
}

struct CachedFile {
  fs::path path;
  std::uint64_t size = 0;
  fs::file_time_type written;
};

}  // namespace

fs::path user_cache_folder() {
  if (environment_path("PALPATE_CACHE") == "off") return {};
  return user_folder("XDG_CACHE_HOME", ".cache");
}

fs::path user_state_folder() { return user_folder("XDG_STATE_HOME", ".local/state"); }

fs::path user_config_folder() { return user_folder("XDG_CONFIG_HOME", ".config"); }

bool is_private(const FileStatus& facts) noexcept {
  return is_of_this_user(facts) && !is_open_to_others(facts);
}

std::string distrust_reason(const fs::path& folder) {
  FileStatus facts{};
  if (status_of(folder, facts) != 0) return {};
  if (is_private(facts)) return {};
  return to_text(folder) + (!is_of_this_user(facts) ? ": belongs to another user"
                                                    : ": other users may write to it (chmod go-w " +
                                                          to_text(folder) + " corrects that)");
}

bool make_private_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  (void)make_folder(folder);  // it may exist already
  // An error counts as absent: there is no cache then.
  return fs::is_directory(folder, error) && distrust_reason(folder).empty();
}

void trim_cache(const fs::path& folder, std::string_view ending, std::uint64_t max_bytes) {
  std::error_code error;
  std::vector<CachedFile> files;
  std::uint64_t total = 0;
  const fs::file_time_type abandoned = fs::file_time_type::clock::now() - kAbandoned;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code of_this;
    // An error counts as absent: the file stays.
    if (!entry->is_regular_file(of_this) || entry->is_symlink(of_this)) continue;
    const std::string name = to_text(entry->path().filename());
    const CachedFile file{entry->path(), entry->file_size(of_this), entry->last_write_time(of_this)};
    if (of_this) continue;
    if (name.size() > kTemporaryLetters &&
        name.substr(0, name.size() - kTemporaryLetters).ends_with(ending) && file.written < abandoned) {
      fs::remove(file.path, of_this);
    } else if (name.ends_with(ending)) {
      total += file.size;
      files.push_back(file);
    }
  }
  std::sort(files.begin(), files.end(), [](const CachedFile& a, const CachedFile& b) {
    return a.written != b.written ? a.written < b.written : a.path < b.path;
  });
  for (const CachedFile& file : files) {
    if (total <= max_bytes) return;
    std::error_code of_this;
    if (fs::remove(file.path, of_this)) total -= file.size;
  }
}

}  // namespace palpate

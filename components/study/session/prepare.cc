// `palpate study prepare`: the folder of a study.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/system/file_exists.h"
#include "io/system/sha256.h"
#include "io/system/temporary.h"
#include "io/system/whole_file.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/version.h"

#include "study/session/folder.h"
#include "study/session/folder_parts.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using FolderJson = nlohmann::ordered_json;

constexpr int kMaxParticipants = 999;

void fill_randomly(std::span<unsigned char> bytes) {
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw InputError(std::string("the system gives no random numbers: ") + std::strerror(errno));
  }
}

/// P and four letters or digits that are hard to confuse and make no words.
std::string random_id() {
  constexpr std::string_view kAlphabet = "234679CDFGHJKMNPQRTVWXYZ";
  std::array<unsigned char, 4> bytes{};
  fill_randomly(bytes);
  std::string id = "P";
  for (const unsigned char byte : bytes) id += kAlphabet[byte % kAlphabet.size()];
  return id;
}

std::vector<std::string> make_ids(int participants, bool random) {
  std::vector<std::string> ids;
  while (ids.size() < static_cast<std::size_t>(participants)) {
    const std::string id = random ? random_id() : fmt::format("P{:02}", ids.size() + 1);
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  }
  return ids;
}

/// A folder in preparation.
struct Preparation {
  fs::path folder;
  FolderJson hashes = FolderJson::object();  // of the copied files by their path in the folder

  void copy(const fs::path& from, const fs::path& to) {
    const std::string bytes = content_of(from);
    fs::create_directories((folder / to).parent_path());
    create_whole_file(folder / to, bytes);
    hashes[to.generic_string()] = sha256(bytes);
  }
};

fs::path normal(const fs::path& file) { return fs::absolute(file).lexically_normal(); }

bool is_below(const fs::path& file, const fs::path& folder) {
  const fs::path relative = normal(file).lexically_relative(normal(folder));
  return !relative.empty() && *relative.begin() != "..";
}

/// The innermost folder that all files are in.
fs::path common_folder(const std::vector<scene::SourceFile>& files) {
  fs::path folder = normal(files.front().path).parent_path();
  for (const scene::SourceFile& file : files) {
    while (!is_below(file.path, folder)) folder = folder.parent_path();
  }
  return folder;
}

/// Copies a scene file and all files that it needs. @return the path of the copied scene in the folder
fs::path copy_scene(const fs::path& file, const std::vector<scene::SourceFile>& files, Preparation& made) {
  const fs::path from = common_folder(files);
  const fs::path to = "scene";
  for (const scene::SourceFile& source : files) {
    made.copy(source.path, to / normal(source.path).lexically_relative(from));
  }
  fs::path scene = to / normal(file).lexically_relative(from);
  scene::Overrides copied;
  copied.scene = made.folder / scene;
  const scene::Scene read = scene::load(copied);
  for (std::size_t i = 0; i < read.files.size(); ++i) {
    if (is_below(read.files[i].path, made.folder / to)) continue;
    throw InputError(
        fmt::format("{}: {}: must be named by a path relative to the scene file, so that the "
                    "study can keep a copy",
                    files[i].named_by, files[i].path.string()));
  }
  return scene;
}

void copy_consent(const Study& study, Preparation& made, FolderJson& lock) {
  if (study.consent_file.empty()) return;
  const fs::path from = study.file.parent_path() / study.consent_file;
  const fs::path to = fs::path("consent") / from.filename();
  try {
    made.copy(from, to);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: ethics.consent_file = \"{}\": {}", study.file.string(),
                                 study.consent_file, error.what()));
  }
  lock["consent"] = to.generic_string();
}

FolderJson make_sealed() {
  std::array<unsigned char, sizeof(SealedKey)> key{};
  std::array<unsigned char, 32> salt{};  // the lock's hash of this file does not reveal the key
  fill_randomly(key);
  fill_randomly(salt);
  SealedKey number = 0;
  std::memcpy(&number, key.data(), sizeof number);
  std::string digits;
  for (const unsigned char byte : salt) digits += fmt::format("{:02x}", byte);
  return {{"key", number}, {"salt", digits}};
}

std::string text_of(const FolderJson& json) {
  return json.dump(2, ' ', false, FolderJson::error_handler_t::replace) + "\n";
}

/// The heads of the study and of each participant's empty log.
void write_heads(const std::vector<std::string>& ids, const std::string& sealed, const std::string& lock_hash,
                 const fs::path& folder) {
  const std::string mac_key = mac_key_of(sealed);
  std::string text = LogHeads::text_of({0, lock_hash}, mac_key);
  for (const std::string& id : ids) text += LogHeads::text_of({0, lock_hash}, mac_key_of_log(mac_key, id));
  create_whole_file(folder / LogHeads::kName, text);
}

void fill_folder(const Study& study, int participants, Preparation& made) {
  FolderJson lock;
  lock["format"] = kFolderFormat;
  lock["study"] = study.name;
  lock["prepared"] = utc_now();
  lock["program"] = kVersion;
  lock["ids"] = make_ids(participants, study.random_ids);
  const scene::Overrides request = scene_of(study);
  const scene::Scene read = scene::load(request);
  lock["scene"] = request.scene ? copy_scene(*request.scene, read.files, made).generic_string() : study.scene;
  made.copy(study.file, "study.toml");
  copy_consent(study, made, lock);
  if (!study.language_file.empty())
    made.copy(study.file.parent_path() / study.language_file, study.language_file);
  if (study.calibration) made.copy(study.file.parent_path() / study.calibration_file, study.calibration_file);
  lock["files"] = made.hashes;
  lock["organ"] = read.organ_name;
  lock["organ_sha256"] = hash_of_builtin(read.organ_name);
  fs::create_directory(made.folder / "participants");
  fs::create_directory(made.folder / "recordings");
  constexpr mode_t kOwnerOnly = 0600;
  const std::string sealed = text_of(make_sealed());
  create_whole_file(made.folder / "sealed.json", sealed, kOwnerOnly);
  lock["sealed_sha256"] = sha256(sealed);
  const std::string locked = text_of(lock);
  create_whole_file(made.folder / "lock.json", locked);
  write_heads(lock["ids"].get<std::vector<std::string>>(), sealed, sha256(locked), made.folder);
}

/// The folder beside the target in which a study is prepared. It has a lock, which a killed process releases.
class PreparationFolder final {
 public:
  explicit PreparationFolder(const fs::path& target) {
    const fs::path parent = target.parent_path();
    std::error_code error;
    fs::create_directories(parent, error);
    remove_abandoned(parent);
    path_ = make_temporary_folder(parent / kStart);
    if (path_.empty()) throw InputError(target.string() + ": cannot be created: " + std::strerror(errno));
    lock_ = lock(path_);
  }
  ~PreparationFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (lock_ >= 0) ::close(lock_);
  }
  PreparationFolder(const PreparationFolder&) = delete;
  PreparationFolder& operator=(const PreparationFolder&) = delete;

  [[nodiscard]] const fs::path& path() const noexcept { return path_; }

 private:
  static constexpr const char* kStart = ".palpate-study-";

  /// @return the descriptor that holds the lock; -1: another process has it, or it is no folder of this user
  static int lock(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    struct stat facts {};
    if (descriptor < 0) return -1;
    if (::fstat(descriptor, &facts) == 0 && facts.st_uid == ::geteuid() &&
        ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
      return descriptor;
    }
    ::close(descriptor);
    return -1;
  }

  /// Whether a preparation may have made a folder: by its name, and as it holds nothing but a study.
  static bool is_of_preparation(const fs::path& folder) {
    constexpr std::size_t kLetters = 6;  // of make_temporary_folder()
    const std::string name = folder.filename().string();
    if (!name.starts_with(kStart) || name.size() != std::string_view(kStart).size() + kLetters) return false;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      if (entry->path().filename() != "study") return false;
    }
    return !error;
  }

  /// Removes what killed processes left, also their sealed keys.
  static void remove_abandoned(const fs::path& parent) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
      if (is_of_preparation(entry->path())) found.push_back(entry->path());
    }
    for (const fs::path& folder : found) {
      const int held = lock(folder);
      if (held < 0) continue;
      fs::remove_all(folder, error);
      ::close(held);
      if (error) {
        throw InputError(
            folder.string() +
            ": was left by an interrupted `palpate study prepare` and cannot be removed: " + error.message());
      }
    }
  }

  fs::path path_;
  int lock_ = -1;
};

}  // namespace

void prepare_study(const fs::path& study_file, const fs::path& folder, int participants) {
  if (participants < 1 || participants > kMaxParticipants) {
    throw InputError(fmt::format("--participants {}: must be a whole number from 1 to {}", participants,
                                 kMaxParticipants));
  }
  if (!is_free_folder(folder)) {
    throw InputError(folder.string() + ": is in use, must be a new or an empty folder");
  }
  const Study study = load_study(study_file);
  for (std::uint32_t i = 0; i < task_orders(study).size(); ++i) static_cast<void>(plan_sessions(study, i));
  const fs::path target = normal(folder / "").parent_path();
  try {
    const PreparationFolder scratch(target);
    Preparation made{scratch.path() / "study"};
    fs::create_directory(made.folder);
    fill_folder(study, participants, made);
    fs::rename(made.folder, target);
    flush_folder(target.parent_path());
  } catch (const fs::filesystem_error& failure) {
    throw InputError(folder.string() + ": cannot be written: " + failure.code().message());
  }
}

}  // namespace palpate::study

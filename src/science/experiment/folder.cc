#include "science/experiment/folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/content_hash.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "io/system/input_file.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/version.h"

namespace palpate::experiment {
namespace {

namespace fs = std::filesystem;
using FolderJson = nlohmann::ordered_json;

constexpr InputKind kStudyFileInput{"a file of a study", std::uint64_t{1} << 30};
constexpr int kMostParticipants = 999;
constexpr const char* kFormat = "palpate study 1";
// Parts of the random numbers that follow from the sealed key (core/base/random.h).
constexpr std::uint32_t kCodesPart = 0x7000'0000;
constexpr std::uint32_t kLabelsPart = 0x8000'0000;
constexpr std::uint32_t kAllParticipants = 0xffff'ffff;

std::string content_of(const fs::path& file) { return InputFile(file, kStudyFileInput).read_rest(); }

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

/// Writes a new file that only this process creates, and flushes it to the disk.
void write_new(const fs::path& file, const FolderJson& json, mode_t mode) {
  const std::string text = json.dump(2, ' ', false, FolderJson::error_handler_t::replace) + "\n";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) throw InputError(file.string() + ": cannot be created: " + std::strerror(errno));
  const bool written = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       ::fsync(descriptor) == 0;
  const std::string why = std::strerror(errno);
  ::close(descriptor);
  if (!written) throw InputError(file.string() + ": cannot be written: " + why);
}

/// SHA-256 of the mesh of a built-in organ; empty for an organ file, which is copied.
std::string hash_of_builtin(const std::string& organ) {
  const std::vector<std::string>& known = geometry::builtin_organ_names();
  if (std::find(known.begin(), known.end(), organ) == known.end()) return {};
  const geometry::TriangleMesh mesh = geometry::make_organ(organ);
  std::string bytes;
  const auto add = [&bytes](const auto& values) {
    for (const auto& value : values) bytes.append(reinterpret_cast<const char*>(value.data()), sizeof value);
  };
  add(mesh.vertices);
  add(mesh.triangles);
  return sha256(bytes);
}

/// A folder in preparation.
struct Preparation {
  fs::path folder;
  FolderJson hashes = FolderJson::object();  // of the copied files by their path in the folder

  void copy(const fs::path& from, const fs::path& to) {
    const std::string bytes = content_of(from);
    fs::create_directories((folder / to).parent_path());
    write_output(folder / to, bytes);
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

void fill_folder(const Study& study, int participants, Preparation& made) {
  FolderJson lock;
  lock["format"] = kFormat;
  lock["study"] = study.name;
  lock["prepared"] = utc_now();
  lock["program"] = kVersion;
  lock["ids"] = make_ids(participants, study.random_ids);
  const scene::Overrides request = scene_of(study);
  const scene::Scene read = scene::load(request);
  lock["scene"] = request.scene ? copy_scene(*request.scene, read.files, made).generic_string() : study.scene;
  made.copy(study.file, "study.toml");
  copy_consent(study, made, lock);
  lock["files"] = made.hashes;
  lock["organ"] = read.organ_name;
  lock["organ_sha256"] = hash_of_builtin(read.organ_name);
  fs::create_directory(made.folder / "participants");
  fs::create_directory(made.folder / "recordings");
  constexpr mode_t kOwnerOnly = 0600;
  constexpr mode_t kUsual = 0644;
  write_new(made.folder / "sealed.json", make_sealed(), kOwnerOnly);
  lock["sealed_sha256"] = sha256(content_of(made.folder / "sealed.json"));
  write_new(made.folder / "lock.json", lock, kUsual);
}

/// Reads a JSON file of a study's folder and calls `use` with its content.
template <typename Use>
void use_json(const fs::path& file, const Use& use) {
  const std::string where = to_text(file) + ": ";
  nlohmann::json json;
  try {
    json = parse_json(content_of(file));
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()).starts_with(where) ? error.what() : where + error.what());
  }
  use(JsonField(json, where));
}

void check_hash(const std::string& found, const std::string& locked, const std::string& what) {
  if (found != locked) throw InputError(what + ": was changed after the study was prepared (lock.json)");
}

void read_lock(const JsonField& lock, StudyFolder& made) {
  if (lock.at("format").text() != kFormat) lock.at("format").fail(fmt::format("\"{}\"", kFormat));
  made.program = lock.at("program").text();
  made.ids = lock.at("ids").texts();
  for (const auto& [name, hash] : lock.at("files").members()) {
    const fs::path file = made.folder / name;
    check_hash(sha256(content_of(file)), hash.text(), file.string());
  }
  const std::string organ = lock.at("organ").text();
  check_hash(hash_of_builtin(organ), lock.at("organ_sha256").text(),
             "the mesh of the built-in organ " + organ);
  made.study = load_study(made.folder / "study.toml");
  made.study.scene = lock.at("scene").text();
  if (lock.has("consent")) made.study.consent_file = lock.at("consent").text();
}

}  // namespace

std::vector<std::size_t> arms_of_codes(SealedKey key, std::uint32_t participant, std::size_t task,
                                       std::size_t arms) {
  return Random(key, participant, kCodesPart + static_cast<std::uint32_t>(task)).permutation(arms);
}

std::vector<std::size_t> labels_of_arms(SealedKey key, std::size_t task, std::size_t arms) {
  return Random(key, kAllParticipants, kLabelsPart + static_cast<std::uint32_t>(task)).permutation(arms);
}

fs::path StudyFolder::log_of(const std::string& id) const {
  return folder / "participants" / (id + ".jsonl");
}

fs::path StudyFolder::recording_of(const std::string& id, int session, int block) const {
  return folder / "recordings" / fmt::format("{}-s{}-b{:02}.h5", id, session, block);
}

std::uint32_t StudyFolder::number_of(const std::string& id) const {
  const auto found = std::find(ids.begin(), ids.end(), id);
  if (found != ids.end()) return static_cast<std::uint32_t>(found - ids.begin());
  const std::string near = nearest_word(id, ids);
  throw InputError(fmt::format("{}: participant {}: unknown id, {}", folder.string(), excerpt(id),
                               near.empty() ? "valid are " + joined(ids) : "did you mean " + near + "?"));
}

bool StudyFolder::unblinded() const {
  std::error_code error;
  return fs::exists(folder / "unblinded.json", error);
}

ParticipantLog StudyFolder::read(const std::string& id) const { return read_log(log_of(id), lock_hash); }

void prepare_study(const fs::path& study_file, const fs::path& folder, int participants) {
  if (participants < 1 || participants > kMostParticipants) {
    throw InputError(fmt::format("--participants {}: must be a whole number from 1 to {}", participants,
                                 kMostParticipants));
  }
  std::error_code error;
  if (fs::exists(folder, error) && !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
    throw InputError(folder.string() + ": is in use, must be a new or an empty folder");
  }
  const Study study = load_study(study_file);
  static_cast<void>(plan_sessions(study));
  const fs::path target = normal(folder / "").parent_path();
  fs::create_directories(target.parent_path(), error);
  const fs::path scratch = make_temporary_folder(target.parent_path() / ".palpate-study-");
  if (scratch.empty()) {
    throw InputError(folder.string() + ": cannot be created: " + std::strerror(errno));
  }
  try {
    Preparation made{scratch / "study"};
    fs::create_directory(made.folder);
    fill_folder(study, participants, made);
    fs::rename(made.folder, target);
  } catch (const fs::filesystem_error& failure) {
    fs::remove_all(scratch, error);
    throw InputError(folder.string() + ": cannot be written: " + failure.code().message());
  } catch (...) {
    fs::remove_all(scratch, error);
    throw;
  }
  fs::remove_all(scratch, error);
}

StudyFolder open_study(const fs::path& folder) {
  StudyFolder made;
  made.folder = folder;
  std::error_code error;
  if (!fs::exists(folder / "lock.json", error)) {
    throw InputError(folder.string() +
                     ": has no lock.json, must be a folder made by `palpate study prepare`");
  }
  made.lock_hash = sha256(content_of(folder / "lock.json"));
  use_json(folder / "lock.json", [&](const JsonField& lock) { read_lock(lock, made); });
  made.simulated = fs::exists(folder / "simulated.json", error);
  return made;
}

SealedKey read_sealed_key(const StudyFolder& study) {
  const fs::path file = study.folder / "sealed.json";
  const InputFile opened(file, kStudyFileInput);
  struct stat facts {};
  constexpr mode_t kOthers = 0077;
  if (::fstat(opened.descriptor(), &facts) == 0 && (facts.st_mode & kOthers) != 0) {
    throw InputError(
        fmt::format("{}: others can read it (mode {:04o}), must be readable by its owner only: "
                    "chmod 600 {}",
                    file.string(), facts.st_mode & 07777U, file.string()));
  }
  std::string locked;
  use_json(study.folder / "lock.json",
           [&](const JsonField& lock) { locked = lock.at("sealed_sha256").text(); });
  check_hash(sha256(content_of(file)), locked, file.string());
  SealedKey key = 0;
  use_json(file, [&](const JsonField& json) { key = json.at("key").whole<SealedKey>(); });
  return key;
}

void mark_simulated(const StudyFolder& study) {
  std::error_code error;
  const fs::path file = study.folder / "simulated.json";
  if (!fs::exists(file, error)) write_new(file, {{"time", utc_now()}}, 0644);
}

void unblind_study(const StudyFolder& study, const std::string& why) {
  if (trimmed(why).empty()) throw InputError("--why: must be the reason, not empty");
  const fs::path file = study.folder / "unblinded.json";
  if (study.unblinded()) {
    use_json(file, [&](const JsonField& json) {
      throw InputError(fmt::format("the study was unblinded already at {}: {}", json.at("time").text(),
                                   one_line(json.at("reason").text())));
    });
  }
  write_new(file, {{"time", utc_now()}, {"reason", why}}, 0644);
}

}  // namespace palpate::experiment

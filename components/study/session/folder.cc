#include "study/session/folder.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "core/base/random.h"
#include "core/base/text.h"
#include "io/system/file_content.h"
#include "io/system/file_exists.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "io/system/sha256.h"
#include "io/system/whole_file.h"
#include "io/system/whole_json.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/scene.h"

#include "study/session/folder_parts.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using FolderJson = nlohmann::ordered_json;

constexpr const char* kUnblindedFile = "unblinded.json";
constexpr const char* kSimulatedFile = "simulated.json";
// Parts of the random numbers that follow from the sealed key (core/base/random.h).
constexpr std::uint32_t kCodesPart = 0x7000'0000;
constexpr std::uint32_t kLabelsPart = 0x8000'0000;
constexpr std::uint32_t kAllParticipants = 0xffff'ffff;

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

/// lock.json has no mac of its own: heads.txt and, later, unblinded.json hold its hash.
void check_lock(const StudyFolder& study, const std::string& hash, const char* by) {
  if (hash == study.lock_hash) return;
  throw InputError(fmt::format("{}: was changed after the study was prepared ({})",
                               (study.folder / "lock.json").string(), by));
}

/// The mac of a file that marks the study, from its values without the mac.
std::string mac_of(const std::string& name, const FolderJson& values, const std::string& mac_key) {
  return hmac_sha256(mac_key, name + values.dump(-1, ' ', false, FolderJson::error_handler_t::replace));
}

/// Creates a file that marks the study. @return its mac
std::string write_mark(const StudyFolder& study, const char* name, FolderJson values) {
  const std::string mac = mac_of(name, values, study.mac_key);
  values["mac"] = mac;
  create_whole_file(study.folder / name,
                    values.dump(2, ' ', false, FolderJson::error_handler_t::replace) + "\n");
  return mac;
}

/// Reads a file that marks the study. @throws InputError unless write_mark() made it
FolderJson read_mark(const StudyFolder& study, const char* name, const char* otherwise) {
  const fs::path file = study.folder / name;
  const std::string text = content_of(file);
  FolderJson values;
  try {
    values = parse_ordered_json(text);
  } catch (const InputError&) {
    values = nullptr;
  }
  std::string mac;
  if (values.is_object() && values.contains("mac") && values["mac"].is_string()) {
    mac = values["mac"].get<std::string>();
    values.erase("mac");
  }
  if (mac.empty() || mac != mac_of(name, values, study.mac_key)) {
    throw InputError(fmt::format("{}: is empty, damaged or not made with this study's sealed key, so {}",
                                 file.string(), otherwise));
  }
  return values;
}

Unblinding read_unblinding(const StudyFolder& study, bool known) {
  const FolderJson values =
      read_mark(study, kUnblindedFile,
                known ? "nobody can read why the study was unblinded: restore the file"
                      : "the study is not unblinded: remove the file, and the study is blind");
  check_lock(study, values.value("lock", study.lock_hash), kUnblindedFile);
  Unblinding read{values.at("time").get<std::string>(), values.at("reason").get<std::string>(), {}};
  for (const std::string& id : study.ids) {
    const FolderJson& log = values.at("logs").at(id);
    read.logs.push_back({whole_number<std::uint64_t>(log, "lines"), log.at("mac").get<std::string>()});
  }
  return read;
}

/// Reads whether the study is simulated, and whether it is unblinded.
void read_marks(StudyFolder& study) {
  study.simulated = file_or_link_exists(study.folder / kSimulatedFile);
  if (study.simulated) {
    static_cast<void>(
        read_mark(study, kSimulatedFile, "nobody knows whether the participants are simulated"));
  }
  const LogHead head = LogHeads(study.folder / LogHeads::kName).read(0, study.mac_key);
  if (head.lines == 0) check_lock(study, head.mac, LogHeads::kName);
  if (file_or_link_exists(study.folder / kUnblindedFile)) {
    study.unblinding = read_unblinding(study, head.lines > 0);
  } else if (head.lines > 0) {
    throw InputError(fmt::format("{}: is missing, though the study was unblinded ({})",
                                 (study.folder / kUnblindedFile).string(), LogHeads::kName));
  }
}

/// Reads the sealed key. @throws InputError when others can read it, or it is another than the lock's
void read_sealed(const std::string& locked_hash, StudyFolder& made) {
  const fs::path file = made.folder / "sealed.json";
  InputFile opened(file, kStudyFileInput);
  struct stat facts {};
  constexpr mode_t kOthers = 0077;
  if (::fstat(opened.descriptor(), &facts) == 0 && (facts.st_mode & kOthers) != 0) {
    throw InputError(
        fmt::format("{}: others can read it (mode {:04o}), must be readable by its owner only: chmod 600 {}",
                    file.string(), facts.st_mode & 07777U, file.string()));
  }
  const std::string sealed = opened.read_rest();
  check_hash(sha256(sealed), locked_hash, file.string());
  made.mac_key = mac_key_of(sealed);
  use_json(file, [&](const JsonField& json) { made.key = json.at("key").whole<SealedKey>(); });
}

/// Whether all trials are of simulated participants, or all of people, as the folder says.
void check_kind(const StudyFolder& study, const fs::path& file, const ParticipantLog& log) {
  for (const TrialRecord& trial : log.trials) {
    if (trial.observer.empty() != study.simulated) continue;
    throw InputError(fmt::format("{}: has trials of {}, but {} is {}: one of them was removed or added",
                                 file.string(), study.simulated ? "a person" : "a simulated observer",
                                 kSimulatedFile, study.simulated ? "there" : "missing"));
  }
}

/// A path of the lock. @throws InputError unless it stays in the folder
std::string path_in_lock(const StudyFolder& made, const char* field, const fs::path& path) {
  const bool up = std::find(path.begin(), path.end(), "..") != path.end();
  if (!up && path.is_relative() && !path.empty()) return path.string();
  throw InputError(fmt::format("{}: {}: \"{}\": must be a path in the study's folder, without \"..\"",
                               (made.folder / "lock.json").string(), field, excerpt(path.string())));
}

void read_lock(const JsonField& lock, StudyFolder& made) {
  const std::string format = lock.at("format").text();
  if (format == "palpate study 1") {
    throw InputError(fmt::format(
        "{}: was prepared by palpate {}, whose logs have no macs: go on with that version; this one needs a "
        "new folder made by `palpate study prepare`",
        made.folder.string(), one_line(lock.at("program").text())));
  }
  if (format != kFolderFormat) lock.at("format").fail(fmt::format("\"{}\"", kFolderFormat));
  made.program = lock.at("program").text();
  made.ids = lock.at("ids").texts();
  for (const auto& [name, hash] : lock.at("files").members()) {
    made.files.push_back(path_in_lock(made, "files", name));
    const fs::path file = made.folder / name;
    check_hash(sha256(content_of(file)), hash.text(), file.string());
  }
  const std::string organ = lock.at("organ").text();
  check_hash(hash_of_builtin(organ), lock.at("organ_sha256").text(),
             "the mesh of the built-in organ " + organ);
  made.study = load_study(made.folder / "study.toml");
  made.study.scene = path_in_lock(made, "scene", lock.at("scene").text());
  if (lock.has("consent")) {
    made.study.consent_file = path_in_lock(made, "consent", lock.at("consent").text());
  }
  read_sealed(lock.at("sealed_sha256").text(), made);
}

}  // namespace

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

std::string mac_key_of(const std::string& sealed) { return hmac_sha256(sealed, "macs of the study"); }

std::string mac_key_of_log(const std::string& mac_key, const std::string& id) {
  return hmac_sha256(mac_key, "log " + id);
}

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

bool StudyFolder::is_recording_of(const std::string& id, const std::string& name) const {
  int session = 0;
  int block = 0;
  return name.starts_with(id) && std::sscanf(name.c_str() + id.size(), "-s%d-b%d", &session, &block) == 2 &&
         recording_of(id, session, block).filename() == name;
}

std::uint32_t StudyFolder::number_of(const std::string& id) const {
  const auto found = std::find(ids.begin(), ids.end(), id);
  if (found != ids.end()) return static_cast<std::uint32_t>(found - ids.begin());
  const std::string near = nearest_word(id, ids);
  throw InputError(fmt::format("{}: participant {}: unknown id, {}", folder.string(), excerpt(id),
                               near.empty() ? "valid are " + joined(ids) : "did you mean " + near + "?"));
}

LogKey StudyFolder::log_key(const std::string& id) const {
  return {lock_hash, mac_key_of_log(mac_key, id), folder / LogHeads::kName, number_of(id) + std::size_t{1}};
}

record::StudyMark StudyFolder::mark() const { return {study.name, sha256(unblinding_proof())}; }

std::string StudyFolder::unblinding_proof() const { return hmac_sha256(mac_key, "unblind"); }

ParticipantLog StudyFolder::read(const std::string& id) const {
  ParticipantLog log = read_log(log_of(id), log_key(id));
  check_kind(*this, log_of(id), log);
  if (!unblinding) return log;
  const LogHead& then = unblinding->logs.at(number_of(id));
  const std::optional<Deletion> deletion = log.deletion();
  const bool deleted_since = deletion && deletion->before == then;
  if (!deleted_since && LogHead{log.lines(), log.last_mac} != then) {
    throw InputError(fmt::format("{}: has {}, had {} when the study was unblinded ({})", log_of(id).string(),
                                 counted(log.lines(), "line", "lines"), then.lines, kUnblindedFile));
  }
  return log;
}

StudyFolder open_study(const fs::path& folder) {
  StudyFolder made;
  made.folder = folder;
  if (!folder_exists(folder)) refuse_other_content(folder, FileContent::kUnknown, "the folder of a study");
  if (!file_exists(folder / "lock.json")) {
    throw InputError(folder.string() +
                     ": has no lock.json, must be a folder made by `palpate study prepare`");
  }
  made.lock_hash = sha256(content_of(folder / "lock.json"));
  use_json(folder / "lock.json", [&](const JsonField& lock) { read_lock(lock, made); });
  for (const char* name : {"participants", "recordings"}) {
    if (!file_or_link_exists(folder / name) || folder_exists(folder / name)) continue;
    throw InputError((folder / name).string() + ": is no folder, must be one");
  }
  read_marks(made);
  return made;
}

void mark_simulated(StudyFolder& study) {
  if (!file_exists(study.folder / kSimulatedFile)) write_mark(study, kSimulatedFile, {{"time", utc_now()}});
  study.simulated = true;
}

void require_blind(const StudyFolder& study) {
  if (!study.unblinded() && !file_or_link_exists(study.folder / kUnblindedFile)) return;
  throw InputError(study.folder.string() +
                   ": is unblinded, so nobody can be run blind; prepare another folder");
}

bool is_leftover(const StudyFolder& study, const fs::path& file) {
  const fs::path name = name_of_unfinished(file);
  const bool log = name.extension() == ".jsonl" &&
                   std::find(study.ids.begin(), study.ids.end(), name.stem()) != study.ids.end();
  return log || name == kUnblindedFile || name == kSimulatedFile;
}

void remove_leftovers(const StudyFolder& study) {
  for (const fs::path& folder : {study.folder, study.folder / "participants"}) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      if (is_leftover(study, entry->path())) found.push_back(entry->path());
    }
    for (const fs::path& file : found) fs::remove(file, error);  // `verify` names those that stay
  }
}

std::vector<std::string> unfinished_people(const StudyFolder& study) {
  std::vector<std::string> unfinished;
  for (const std::string& id : study.ids) {
    const std::size_t sessions = plan_sessions(study.study, study.number_of(id)).size();
    const ParticipantLog log = study.read(id);
    if (log.finished_sessions() < sessions && !log.withdrawn() && !log.deletion()) unfinished.push_back(id);
  }
  return unfinished;
}

void unblind_study(StudyFolder& study, const std::string& why, bool early) {
  if (trimmed(why).empty()) throw InputError("--why: must be the reason, not empty");
  if (study.unblinding) {
    throw InputError(fmt::format("{}: the study was unblinded already at {}: {}",
                                 (study.folder / kUnblindedFile).string(), study.unblinding->time,
                                 one_line(study.unblinding->reason)));
  }
  const LogHeads heads(study.folder / LogHeads::kName, LogHeads::Use::kUnblind);  // no session runs
  remove_leftovers(study);
  const std::vector<std::string> unfinished = unfinished_people(study);
  if (!unfinished.empty() && !early) {
    constexpr std::size_t kNamed = 5;
    std::vector<std::string> named = unfinished;
    named.resize(std::min(kNamed, named.size()));
    if (unfinished.size() > kNamed) named.emplace_back("...");
    throw InputError(fmt::format(
        "{}: {} of {} participants are not finished ({}): nobody can be run blind after unblinding; --early "
        "ends the study for them",
        study.folder.string(), unfinished.size(), study.ids.size(), joined(named)));
  }
  Unblinding made{utc_now(), why, {}};
  FolderJson logs;
  for (const std::string& id : study.ids) {
    const ParticipantLog log = study.read(id);
    made.logs.push_back({log.lines(), log.last_mac});
    logs[id] = {{"lines", log.lines()}, {"mac", log.last_mac}};
  }
  const std::string mac = write_mark(study, kUnblindedFile,
                                     {{"time", made.time},
                                      {"reason", why},
                                      {"proof", study.unblinding_proof()},
                                      {"lock", study.lock_hash},
                                      {"logs", logs}});
  study.unblinding = std::move(made);
  heads.write(0, {1, mac}, study.mac_key);
}

}  // namespace palpate::study

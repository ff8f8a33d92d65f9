#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/recording.h"

#include "study/session/log_heads.h"
#include "study/session/study.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// The secret number that arms and their order follow from. It is in sealed.json, which only the owner can
/// read.
using SealedKey = std::uint64_t;

/// [setup] Code index -> arm index, for one participant and task: codes "c1", "c2", ... are drawn for
/// each participant. @param participant number from 0
[[nodiscard]] std::vector<std::size_t> arms_of_codes(SealedKey key, std::uint32_t participant,
                                                     std::size_t task, std::size_t arms);

/// [setup] Arm index -> label index, for blind analysis: labels A, B, C, the same for all participants.
[[nodiscard]] std::vector<std::size_t> labels_of_arms(SealedKey key, std::size_t task, std::size_t arms);

/// When and why a study was unblinded.
struct Unblinding {
  std::string time;  // ISO 8601, UTC
  std::string reason;
  std::vector<LogHead> logs;  // of all participants then, by number
};

/// A prepared study: DIR/study.toml, scene/..., consent/..., lock.json, sealed.json, heads.txt,
/// participants/ID.jsonl, recordings/, simulated.json if its participants are simulated, unblinded.json once
/// it is unblinded.
struct StudyFolder {
  std::filesystem::path folder;
  Study study;  // its scene and consent file are the copies in the folder
  SealedKey key = 0;
  std::string mac_key;                   // from sealed.json; authenticates logs, heads.txt, and the two marks
  std::string lock_hash;                 // SHA-256 of lock.json; each log begins with it
  std::string program;                   // version of palpate that prepared it
  std::vector<std::string> files;        // study, scene and consent text, by their path in the folder
  std::vector<std::string> ids;          // of all participants, by number
  bool simulated = false;                // filled by `palpate study simulate`
  std::optional<Unblinding> unblinding;  // empty: blind

  [[nodiscard]] std::filesystem::path log_of(const std::string& id) const;
  [[nodiscard]] std::filesystem::path recording_of(const std::string& id, int session, int block) const;
  /// Whether a name is that of a recording of one participant.
  [[nodiscard]] bool is_recording_of(const std::string& id, const std::string& name) const;
  /// Number of a participant. @throws InputError with the nearest id
  [[nodiscard]] std::uint32_t number_of(const std::string& id) const;
  [[nodiscard]] bool unblinded() const noexcept { return unblinding.has_value(); }
  [[nodiscard]] LogKey log_key(const std::string& id) const;
  /// What unblinded.json proves, and the mark of the recordings, which holds the SHA-256 of the proof.
  [[nodiscard]] std::string unblinding_proof() const;
  [[nodiscard]] record::StudyMark mark() const;
  /// The log of one participant. @throws InputError as read_log(), and when it does not fit simulated.json or
  /// unblinded.json
  [[nodiscard]] ParticipantLog read(const std::string& id) const;
};

/// [setup] Prepares a folder, which must not exist or be empty: copies the study file, its scene with all
/// files that it needs, and the consent file. @throws InputError naming the file or value, and writes nothing
void prepare_study(const std::filesystem::path& study_file, const std::filesystem::path& folder,
                   int participants);

/// [setup] Opens a prepared folder. @throws InputError when a file is missing, differs from the lock or was
/// not made with the sealed key, or when others can read the sealed key
[[nodiscard]] StudyFolder open_study(const std::filesystem::path& folder);

/// [setup] Marks the folder as filled by simulated participants. @throws InputError when it cannot be written
void mark_simulated(StudyFolder& study);

/// [setup] @throws InputError when the study is unblinded by now
void require_blind(const StudyFolder& study);

/// [setup] Whether a file is one that a killed command left. remove_leftovers() removes them; only with
/// heads.txt locked.
[[nodiscard]] bool is_leftover(const StudyFolder& study, const std::filesystem::path& file);
void remove_leftovers(const StudyFolder& study);

/// [setup] The ids whose sessions are not all complete, who have not withdrawn and whose data were not
/// deleted. @throws InputError
[[nodiscard]] std::vector<std::string> unfinished_people(const StudyFolder& study);

/// [setup] Unblinds once and for ever: creates unblinded.json with time, reason, the proof that opens the
/// recordings, and the end of each log. @param early while people are unfinished @throws InputError if it is
/// unblinded already, for an empty reason, while a session runs, or when the file cannot be written; then the
/// study is as blind as before
void unblind_study(StudyFolder& study, const std::string& why, bool early = false);

}  // namespace palpate::study

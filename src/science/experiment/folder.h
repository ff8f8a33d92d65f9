#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "science/experiment/study.h"
#include "science/experiment/trial_log.h"

namespace palpate::experiment {

/// The secret number that arms and their order follow from. It is in sealed.json, which only the owner can
/// read.
using SealedKey = std::uint64_t;

/// [setup] Code index -> arm index, for one participant and task: codes "c1", "c2", ... are drawn for
/// each participant. @param participant number from 0
[[nodiscard]] std::vector<std::size_t> arms_of_codes(SealedKey key, std::uint32_t participant,
                                                     std::size_t task, std::size_t arms);

/// [setup] Arm index -> label index, for blind analysis: labels A, B, C, the same for all participants.
[[nodiscard]] std::vector<std::size_t> labels_of_arms(SealedKey key, std::size_t task, std::size_t arms);

/// A prepared study: DIR/study.toml, scene/..., consent/..., lock.json, sealed.json, participants/ID.jsonl,
/// recordings/, simulated.json if its participants are simulated, unblinded.json once it is unblinded.
struct StudyFolder {
  std::filesystem::path folder;
  Study study;                   // its scene and consent file are the copies in the folder
  std::string lock_hash;         // SHA-256 of lock.json; each log begins with it
  std::string program;           // version of palpate that prepared it
  std::vector<std::string> ids;  // of all participants, by number
  bool simulated = false;        // filled by `palpate study simulate`

  [[nodiscard]] std::filesystem::path log_of(const std::string& id) const;
  [[nodiscard]] std::filesystem::path recording_of(const std::string& id, int session, int block) const;
  /// Number of a participant. @throws InputError with the nearest id
  [[nodiscard]] std::uint32_t number_of(const std::string& id) const;
  [[nodiscard]] bool unblinded() const;
  /// The log of one participant. @throws InputError as read_log()
  [[nodiscard]] ParticipantLog read(const std::string& id) const;
};

/// [setup] Prepares a folder, which must not exist or be empty: copies the study file, its scene with all
/// files that it needs, and the consent file. @throws InputError naming the file or value, and writes nothing
void prepare_study(const std::filesystem::path& study_file, const std::filesystem::path& folder,
                   int participants);

/// [setup] Opens a prepared folder. @throws InputError when a file is missing or differs from the lock
[[nodiscard]] StudyFolder open_study(const std::filesystem::path& folder);

/// [setup] Reads the sealed key, for running and analysis. @throws InputError
[[nodiscard]] SealedKey read_sealed_key(const StudyFolder& study);

/// [setup] Marks the folder as filled by simulated participants. @throws InputError when it cannot be written
void mark_simulated(const StudyFolder& study);

/// [setup] Unblinds once and for ever: writes unblinded.json with time and reason. @throws InputError if it
/// is unblinded already, or for an empty reason
void unblind_study(const StudyFolder& study, const std::string& why);

}  // namespace palpate::experiment

#pragma once
#include <filesystem>
#include <string>

#include "palpate/recording.h"

/// The recordings of a study stay blind until the folder above theirs has the study's file unblinded.json. A
/// recording holds the SHA-256 of the proof in that file (StudyMark::commitment), and the proof is made with
/// the sealed key, so a copy elsewhere is as blind. Only for the module record.
namespace palpate::record {

/// [setup] Whether the folder above the recording's folder has a file unblinded.json with the study's proof.
/// @throws InputError when the file exists and cannot be read
[[nodiscard]] bool is_unblinded(const std::filesystem::path& recording, const StudyMark& study);

/// [setup] @throws InputError that names the recording and says how its study is unblinded.
[[noreturn]] void refuse_blind(const std::filesystem::path& recording, const std::string& study);

/// [setup] Appends a line to the file blind-broken.jsonl in the recording's folder. @param command that reads
/// the recording @throws InputError that names the file when it cannot be written.
void log_broken_blind(const std::filesystem::path& recording, const std::string& command);

}  // namespace palpate::record

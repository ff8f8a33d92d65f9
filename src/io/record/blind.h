#pragma once
#include <filesystem>
#include <string>

/// The recordings of a study stay blind until the study's folder has a file unblinded.json. Only for the
/// module record.
namespace palpate::record {

/// [setup] Whether the folder above the recording's folder has the file unblinded.json.
[[nodiscard]] bool is_unblinded(const std::filesystem::path& recording);

/// [setup] @throws InputError that names the recording and says how its study is unblinded.
[[noreturn]] void refuse_blind(const std::filesystem::path& recording, const std::string& study);

/// [setup] Appends a line to the file blind-broken.jsonl in the recording's folder. @param command that reads
/// the recording @throws InputError that names the file when it cannot be written.
void log_broken_blind(const std::filesystem::path& recording, const std::string& command);

}  // namespace palpate::record

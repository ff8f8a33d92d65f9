#pragma once
#include <filesystem>
#include <string>

#include "io/system/input_file.h"

// What the preparation of a study's folder and its readers know. Only for folder.cc, prepare.cc and
// verify.cc.
namespace palpate::study {

inline constexpr const char* kFolderFormat = "palpate study 2";
inline constexpr InputKind kStudyFileInput{"a file of a study", std::uint64_t{1} << 30};

/// [setup] The whole content. @throws InputError
[[nodiscard]] inline std::string content_of(const std::filesystem::path& file) {
  return InputFile(file, kStudyFileInput).read_rest();
}

/// [setup] SHA-256 of the mesh of a built-in organ; empty for an organ file, which is copied.
[[nodiscard]] std::string hash_of_builtin(const std::string& organ);

/// [setup] The key of all macs of a study, and that of one participant's log. @param sealed content of
/// sealed.json
[[nodiscard]] std::string mac_key_of(const std::string& sealed);
[[nodiscard]] std::string mac_key_of_log(const std::string& mac_key, const std::string& id);

}  // namespace palpate::study

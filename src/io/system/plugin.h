#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// [setup] The folder of the running program, absolute, with symbolic links resolved. Empty where it is
/// unknown.
[[nodiscard]] std::filesystem::path folder_of_program();

/// [setup] Existing files of a plug-in, such as "palpate_mpi.so": beside the running program (build tree) and
/// in ../lib/palpate (installed; of a program in libexec ../../lib/palpate). Empty: the plug-in is not built
/// or not installed.
[[nodiscard]] std::vector<std::filesystem::path> find_plugin(const std::string& file_name);

}  // namespace palpate

#include "io/system/plugin.h"

#include <system_error>

namespace palpate {

std::vector<std::filesystem::path> find_plugin(const std::string& file_name) {
  std::error_code failed;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const std::filesystem::path folder = program.parent_path();
  std::vector<std::filesystem::path> found;
  for (const std::filesystem::path& file :
       {folder / file_name, folder.parent_path() / "lib" / "palpate" / file_name}) {
    // An error counts as absent: a plug-in is optional.
    if (std::filesystem::exists(file, failed)) found.push_back(file);
  }
  return found;
}

}  // namespace palpate

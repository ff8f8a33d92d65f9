#include "io/system/plugin.h"

#include <system_error>

namespace palpate {

namespace fs = std::filesystem;

std::vector<fs::path> find_plugin(const std::string& file_name) {
  const fs::path folder = folder_of_program();
  if (folder.empty()) return {};
  std::error_code failed;
  std::vector<fs::path> found;
  for (const fs::path& file : {folder / file_name, folder / "../lib/palpate" / file_name,
                               folder / "../../lib/palpate" / file_name}) {  // the last one from libexec
    // An error counts as absent: a plug-in is optional.
    if (fs::exists(file, failed)) found.push_back(file);
  }
  return found;
}

}  // namespace palpate

#include "io/system/plugin.h"

#include <system_error>

#include <sys/auxv.h>

namespace palpate {

namespace fs = std::filesystem;

fs::path folder_of_program() {
  std::error_code failed;
  fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) {  // without /proc, as in some chroots: the file that the kernel executed
    const auto* executed = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
    program = executed == nullptr ? fs::path() : fs::canonical(executed, failed);
  }
  // A program outside the root of this process has a path that is not absolute: "(unreachable)/...".
  return failed || !program.is_absolute() ? fs::path() : program.parent_path();
}

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

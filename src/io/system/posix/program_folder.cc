#include <system_error>

#include <sys/auxv.h>

#include "io/system/plugin.h"

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

}  // namespace palpate

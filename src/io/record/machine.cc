#include "io/record/machine.h"

namespace palpate::record {

std::string palpate_version() { return PALPATE_VERSION; }

std::string compiler_version() {
#if defined(__clang__)
  return "clang++ " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace palpate::record

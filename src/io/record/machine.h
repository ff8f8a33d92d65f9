#pragma once
#include <string>

namespace palpate::record {

/// [setup] Version of palpate, e.g. "0.2.0".
[[nodiscard]] std::string palpate_version();

/// [setup] The compiler of this build, e.g. "g++ 12.2.0".
[[nodiscard]] std::string compiler_version();

/// [setup] Processor and kernel of this machine, in one line.
[[nodiscard]] std::string machine_description();

}  // namespace palpate::record

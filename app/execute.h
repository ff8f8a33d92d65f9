#pragma once
#include <filesystem>

namespace palpate::app {

/// [setup] Replaces this process by `program`. Windows cannot do that: there this process waits for the
/// program and ends with its exit code. Returns only when `program` cannot be executed. @param arguments end
/// with a null @return the reason
int execute(const std::filesystem::path& program, char** arguments);

}  // namespace palpate::app

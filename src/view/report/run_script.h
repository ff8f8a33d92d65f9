#pragma once
#include <filesystem>
#include <string>

namespace palpate::report {

/// [setup] Runs `program figure.gp` in `folder`, with its messages in errors.txt there. @return exit status
/// @throws FigureError when it is missing or does not start.
[[nodiscard]] int run_script(const std::filesystem::path& folder, const std::string& program);

}  // namespace palpate::report

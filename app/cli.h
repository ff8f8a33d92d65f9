#pragma once
// CLI11, with paths as the UTF-8 that arguments are. Every file includes it in place of CLI11's header.
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "io/system/path_text.h"

namespace CLI::detail {

template <>
inline bool lexical_cast<std::filesystem::path>(const std::string& input, std::filesystem::path& output) {
  output = palpate::to_path(input);
  return true;
}

}  // namespace CLI::detail

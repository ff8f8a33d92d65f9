#pragma once
// Pictures and reports of the program. A build without OpenGL (app/windows/pictures.cc) says so.
#include <filesystem>
#include <string>

#include "palpate/recording.h"
#include "palpate/session.h"

namespace palpate::app {

/// [any] Whether this program writes reports and pictures.
[[nodiscard]] bool has_pictures() noexcept;

/// [setup] @throws InputError naming the flag when this program writes no pictures and reports.
void require_pictures(const std::string& flag);

/// [setup] Writes a picture of a recording's deepest tick as a PNG file. @param no_cache ignores the cache of
/// prepared organs @throws InputError when the file cannot be written, std::runtime_error without OpenGL.
void write_screenshot(const record::Recording& recording, const session::RunStatistics& statistics,
                      const std::filesystem::path& file, bool no_cache);

}  // namespace palpate::app

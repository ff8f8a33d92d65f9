#pragma once
#include <filesystem>
#include <string>

#include <sys/types.h>

namespace palpate {

/// [setup] Makes a file that was not there, under a name that nobody can predict, and opens it for reading
/// and writing. @param path how its name begins; becomes the whole name
/// @param mode of the file, less the process's umask; 0600: its owner alone may read it
/// @return the descriptor, which other programs do not inherit; -1 when it cannot be made, `path` as it was
[[nodiscard]] int open_temporary_file(std::string& path, mode_t mode = 0600);

/// [setup] Makes a folder that nobody else has. @param path how its name begins
/// @return its whole name; empty when it cannot be made
[[nodiscard]] std::filesystem::path make_temporary_folder(const std::filesystem::path& path);

/// A folder below the system's temporary folder, removed with everything in it at the end.
class ScratchFolder {
 public:
  /// [setup] @param name how its name begins
  explicit ScratchFolder(const std::string& name);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// [any] Empty when it could not be made.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate

#pragma once
#include <filesystem>
#include <string>

#include <sys/types.h>

namespace palpate {

/// [setup] Creates a new file with an unpredictable name and opens it for reading and writing.
/// @param path start of its name; becomes the complete path @param mode of the file, less the process's
/// umask; 0600: only its owner may read it
/// @return the descriptor, which child programs do not inherit; -1 when it cannot be created, with `path`
/// unchanged
[[nodiscard]] int open_temporary_file(std::string& path, mode_t mode = 0600);

/// [setup] Creates a new folder with an unpredictable name. @param path start of its name @return its
/// complete path; empty when it cannot be created
[[nodiscard]] std::filesystem::path make_temporary_folder(const std::filesystem::path& path);

/// A folder in the system's temporary folder; the destructor removes it with its content.
class ScratchFolder {
 public:
  /// [setup] @param name start of the folder's name
  explicit ScratchFolder(const std::string& name);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// [any] The path; empty when it could not be created.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate

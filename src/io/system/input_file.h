#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace palpate {

/// A kind of input file and its largest size (docs/file-formats.md, "Files that are read").
struct InputKind {
  const char* name;         // name in error messages: "a CSV file"
  std::uint64_t max_bytes;  // larger files are rejected
};

// The TOML library takes quadratic time for tables with many keys: 2 s for 1 MiB, 27 s for 4 MiB.
inline constexpr InputKind kTomlInput{"a TOML file", std::uint64_t{1} << 20};
inline constexpr InputKind kCsvInput{"a CSV file", std::uint64_t{1} << 30};
inline constexpr InputKind kMeshInput{"a mesh file", std::uint64_t{512} << 20};
inline constexpr InputKind kRecordingInput{"a palpate recording", std::uint64_t{1} << 40};
inline constexpr InputKind kPictureInput{"a PNG or JPEG picture", std::uint64_t{256} << 20};
inline constexpr InputKind kTaskRecordInput{"a record of finished tasks", std::uint64_t{1} << 30};
inline constexpr InputKind kTokenInput{"a file with a token in its first line", std::uint64_t{4} << 10};
inline constexpr InputKind kPageInput{"a file for browsers", std::uint64_t{4} << 20};

/// A regular file, opened for reading. FIFOs, devices, sockets and folders are rejected without blocking. The
/// check is made on the opened file, so nobody can replace it in between.
class InputFile final {
 public:
  /// [setup] @throws InputError naming the file, the defect and the remedy, when the file does not exist, is
  /// not regular, cannot be read, or is larger than `kind.max_bytes`.
  InputFile(const std::filesystem::path& file, const InputKind& kind);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// [setup] Size in bytes when the file was opened.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// [setup] Reads the file's next bytes. @return their number, 0 at the end of the file @throws InputError
  /// when the file cannot be read, or has grown beyond `kind.max_bytes`.
  [[nodiscard]] std::size_t read(std::span<char> bytes);
  /// [setup] Reads the rest of the file. @throws InputError as read().
  [[nodiscard]] std::string read_rest();

 private:
  void check();

  std::string name_;
  InputKind kind_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace palpate

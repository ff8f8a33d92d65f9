#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/mesh_io/mesh_file.h"

// Words and numbers of a legacy VTK file, for vtk_file.cc.
namespace palpate::geometry {

enum class VtkType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// Goes through a legacy VTK file: lines and words of its text, numbers as text or as big-endian bytes.
class VtkScan final {
 public:
  explicit VtkScan(const MeshFile& file) : file_(file), bytes_(file.bytes) {}

  void set_binary(bool is_binary) { is_binary_ = is_binary; }
  [[nodiscard]] bool is_binary() const { return is_binary_; }

  /// The rest of the current line; at the end of the file an error that names what was wanted.
  std::string_view line(const std::string& wanted);
  /// The next word, empty at the end of the file.
  std::string_view word();
  /// The next word without taking it.
  [[nodiscard]] std::string_view peek();
  /// A number that is at least 0 and not more than what is left can hold.
  std::size_t count(const std::string& of);
  VtkType type(const std::string& of);

  /// Before a block of numbers: ends the line of its head, and checks that so many can be there.
  void begin_numbers(std::size_t numbers, VtkType type, const std::string& of);
  double real(VtkType type, const std::string& of);
  std::int64_t whole(VtkType type, const std::string& of);
  void skip_numbers(std::size_t numbers, VtkType type, const std::string& of);
  /// Passes over the rest of this line and all up to an empty one.
  void skip_to_empty_line();

  /// @throws InputError with the file and the place of the last word or number
  [[noreturn]] void refuse(const std::string& words) const;

 private:
  std::array<char, 8> take(VtkType type, const std::string& of);
  [[noreturn]] void refuse_as_truncated(const std::string& of) const;

  const MeshFile& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t last_ = 0;  // where the last word or number begins
  bool is_binary_ = false;
};

}  // namespace palpate::geometry

#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/mesh_io/mesh_file.h"

// Reads lines, words and numbers of a mesh file, for all readers in this folder.
namespace palpate::mesh_io {

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// @param at offset of the four bytes
[[nodiscard]] std::uint32_t little_endian_32(std::string_view bytes, std::size_t at);

/// Scans a mesh file: words, within a line or across lines, and numbers as text or bytes. Lines end in LF, CR
/// LF or CR. A UTF-8 byte order mark before the first word is skipped. Errors are an InputError of one line,
/// with the file, the line (text) or byte (binary) of the last word or number, and the defect.
class MeshScan final {
 public:
  enum class Encoding { kText, kLittleEndian, kBigEndian };
  enum class Lines {
    kPlain,
    kCommented  // comments start with #; a line that ends in a backslash continues on the next
  };

  explicit MeshScan(const MeshFile& file, Lines lines = Lines::kPlain);

  void set_encoding(Encoding encoding) { encoding_ = encoding; }
  [[nodiscard]] bool is_binary() const { return encoding_ != Encoding::kText; }

  /// Goes to the next line. Until leave_lines(), words come from this line only. @return false at the end of
  /// the file
  bool next_line();
  /// The rest of the line, without spaces at its ends.
  [[nodiscard]] std::string_view rest_of_line() const;
  /// Goes to the end of the line; then words may come from any following line.
  void leave_lines();

  /// The next word; empty at the end.
  std::string_view word();
  /// The next word without taking it.
  [[nodiscard]] std::string_view peek() const;
  void expect(std::string_view wanted);
  /// Goes to a byte of the file.
  void go_to(std::size_t byte) { at_ = byte; }
  /// Goes to the position after the next occurrence of `mark`.
  void skip_past(std::string_view mark);

  /// The next word as a count of `of`; at most the file's size in bytes.
  std::size_t count(std::string_view of);
  /// Checks a count of `of` that was already read; at most the file's size in bytes.
  [[nodiscard]] std::size_t as_count(std::int64_t number, std::string_view of) const;
  /// The next word as a number type, with the names of PLY and VTK.
  NumberType type();

  /// Sets what is being read, for messages: "face 2". @param what must outlive its use @param count number of
  /// all such items, 0 if unknown
  void reading(std::string_view what, std::optional<std::size_t> number = std::nullopt,
               std::size_t count = 0);
  [[nodiscard]] std::size_t least_bytes(NumberType type) const;
  /// Rejects a count of items that need more bytes than the file has left.
  void require_room(std::size_t count, std::size_t bytes_each, std::string_view of);
  double real(NumberType type);
  std::int64_t whole(NumberType type);
  /// Three finite coordinates of a vertex; in text rounded to the type.
  Vec3 point(NumberType type, std::size_t number, std::size_t count = 0);
  void require_finite(const Vec3& point) const;
  /// A vertex index, counted from 0.
  std::int32_t index(NumberType type, std::size_t vertices);
  /// Call before a block of numbers that follows a line of text. Ends the line of a binary block, and checks
  /// that the file has enough bytes for the numbers.
  void begin_numbers(std::size_t numbers, NumberType type, std::string_view of);
  void skip_numbers(std::size_t numbers, NumberType type);
  void skip_bytes(std::size_t bytes);

  /// @return the offset [byte] of the last word or number
  [[nodiscard]] std::size_t offset() const { return last_; }
  [[noreturn]] void refuse(const std::string& message) const { refuse_at(last_, message); }
  /// Rejects the file; the message names the current item.
  [[noreturn]] void refuse_item(const std::string& message) const { refuse(item() + ": " + message); }
  [[noreturn]] void refuse_at(std::size_t place, const std::string& message) const;
  [[noreturn]] void refuse_index(std::int64_t index, std::size_t vertices, int first,
                                 std::size_t place) const;

 private:
  [[nodiscard]] std::size_t line_end(std::size_t from) const;
  [[nodiscard]] std::size_t behind_line_end(std::size_t end) const;
  [[nodiscard]] std::string item() const;
  std::string_view number_word();
  std::array<char, 8> take(NumberType type);
  [[noreturn]] void refuse_as_short() const;

  const MeshFile& file_;
  std::string_view bytes_;
  Lines lines_;
  Encoding encoding_ = Encoding::kText;
  std::size_t at_ = 0;
  std::size_t limit_;     // end of the line or of the file, for words
  std::size_t next_ = 0;  // line
  std::size_t last_ = 0;
  std::string_view what_;
  std::optional<std::size_t> number_;
  std::size_t count_ = 0;
};

[[nodiscard]] std::optional<double> number(std::string_view word);
/// The word's first 40 letters in upper case, to compare keywords.
[[nodiscard]] std::string upper(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view word);

}  // namespace palpate::mesh_io

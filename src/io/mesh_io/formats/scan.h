#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/mesh_io/mesh_file.h"

// Lines, words and numbers of a mesh file, for all readers of this folder.
namespace palpate::geometry {

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// @param at where four bytes follow
[[nodiscard]] std::uint32_t little_endian_32(std::string_view bytes, std::size_t at);

/// Goes through a mesh file: words, from one line or over line ends, and numbers as text or bytes. Lines end
/// in \n, \r\n or \r. All that throws throws InputError of one line with the file, the line (text) or byte
/// (binary) of the last word or number, and what is wrong with it.
class MeshScan final {
 public:
  enum class Encoding { kText, kLittleEndian, kBigEndian };
  enum class Lines {
    kPlain,
    kCommented  // from # on a comment; a line that ends in \ goes on in the next
  };

  explicit MeshScan(const MeshFile& file, Lines lines = Lines::kPlain);

  void set_encoding(Encoding encoding) { encoding_ = encoding; }
  [[nodiscard]] bool is_binary() const { return encoding_ != Encoding::kText; }

  /// Goes to the next line; until leave_lines(), words are taken from this one alone. @return false at the
  /// end
  bool next_line();
  /// What is left of the line, without blanks at its ends.
  [[nodiscard]] std::string_view rest_of_line() const;
  /// Goes behind the line; words are then taken over line ends.
  void leave_lines();

  /// The next word; empty at the end.
  std::string_view word();
  /// The next word without taking it.
  [[nodiscard]] std::string_view peek() const;
  void expect(std::string_view wanted);
  /// Goes behind the next occurrence of `mark`.
  void skip_past(std::string_view mark);

  /// The next word as a number of `of`; no more than the file has bytes.
  std::size_t count(std::string_view of);
  /// The same of a number that was read already.
  [[nodiscard]] std::size_t as_count(std::int64_t number, std::string_view of) const;
  /// The next word as a type of numbers, by the names of PLY and VTK.
  NumberType type();

  /// What is read from here on, for messages: "face 2". @param what stays where it is; @param count of them;
  /// 0: unknown
  void reading(std::string_view what, std::optional<std::size_t> number = std::nullopt,
               std::size_t count = 0);
  [[nodiscard]] std::size_t least_bytes(NumberType type) const;
  /// Refuses a count of things for which too few bytes are left.
  void require_room(std::size_t count, std::size_t bytes_each, std::string_view of);
  double real(NumberType type);
  std::int64_t whole(NumberType type);
  /// Three finite coordinates of a vertex, in text rounded as the type would be.
  Vec3 point(NumberType type, std::size_t number, std::size_t count = 0);
  void require_finite(const Vec3& point) const;
  /// A vertex index from 0.
  std::int32_t index(NumberType type, std::size_t vertices);
  /// Before a block of numbers behind a line of text: ends the line where they are bytes, and checks that so
  /// many can be there.
  void begin_numbers(std::size_t numbers, NumberType type, std::string_view of);
  void skip_numbers(std::size_t numbers, NumberType type);
  void skip_bytes(std::size_t bytes);

  /// @return where the last word or number begins [byte]
  [[nodiscard]] std::size_t place() const { return last_; }
  [[noreturn]] void refuse(const std::string& words) const { refuse_at(last_, words); }
  /// Says what is being read, too.
  [[noreturn]] void refuse_item(const std::string& words) const { refuse(item() + ": " + words); }
  [[noreturn]] void refuse_at(std::size_t place, const std::string& words) const;
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
  std::size_t limit_;     // of the words: the line's or the file's end
  std::size_t next_ = 0;  // line
  std::size_t last_ = 0;
  std::string_view what_;
  std::optional<std::size_t> number_;
  std::size_t count_ = 0;
};

[[nodiscard]] std::optional<double> number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view word);

}  // namespace palpate::geometry

#pragma once
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/system/input_file.h"
#include "io/system/utf16.h"

namespace palpate {

/// [setup] A text in quotes, as a cell of a CSV file.
[[nodiscard]] std::string csv_quoted(std::string_view text);
/// [setup] A text as a cell of a CSV file: in quotes where it contains a comma, a quote or a line end.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// A column that a CSV file may have.
struct CsvColumn {
  std::string name;  // as in the header, with its unit
  bool required = true;
  bool is_text = false;  // a name, not a number
  bool is_time = false;  // its numbers may be larger than the table's limit, as those since 1970
};

/// A CSV file, read row by row: columns by header name in any order. Commas, semicolons, tabs or blanks
/// separate the cells: those by which the header names the most columns. Cells may be in quotation marks (RFC
/// 4180, within a line). A number between semicolons or tabs, or in quotation marks, may have a decimal
/// comma; the file has one decimal mark, and some number must show that it is none of thousands (0,5 does,
/// 1,234 does not). Ignored are blank lines, lines that begin with #, one row of the columns' units below the
/// header, a first column without a name or named by R or pandas (row names), and a separator at the end of
/// all lines. The text is UTF-8, or UTF-16 with a byte order mark. Every error is one line, FILE:LINE: COLUMN
/// = VALUE: what would be right. A line has at most 64 KiB.
class CsvTable final {
 public:
  /// [setup] Opens the file and reads its header. @param largest absolute value of a number, a power of ten
  /// @throws InputError when the file cannot be read or is empty, or when the header is missing, repeats a
  /// column, has one that is not in `columns`, or lacks a required one.
  CsvTable(const std::filesystem::path& file, std::vector<CsvColumn> columns,
           double largest = std::numeric_limits<double>::infinity());

  /// [setup] Whether the header names the column, given by its index in `columns`.
  [[nodiscard]] bool has(std::size_t column) const { return cell_of_[column] != kAbsent; }

  /// [setup] Reads the next row. @return false at the end of the file @throws InputError when the file has no
  /// row, a row does not have one value per column, a name is empty, or a number is not finite or too large.
  [[nodiscard]] bool next_row();

  /// [setup] The row's number in a column; 0 when the file lacks the column.
  [[nodiscard]] double number(std::size_t column) const { return numbers_[column]; }

  /// [setup] The row's name in a column, valid until the next row is read; empty when the file lacks the
  /// column.
  [[nodiscard]] std::string_view text(std::size_t column) const {
    return has(column) ? cells_[cell_of_[column]] : std::string_view();
  }

  /// [setup] @throws InputError "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;
  /// [setup] @throws InputError "FILE:LINE: COLUMN = VALUE: want", with the row's number in a column.
  [[noreturn]] void fail(std::size_t column, const std::string& want) const;

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  [[nodiscard]] std::string in_line(const std::string& what) const;
  [[nodiscard]] bool next_line();
  [[nodiscard]] std::size_t read_text(std::span<char> to);
  void find_encoding();
  void split();
  [[nodiscard]] std::string_view take_quoted(std::string_view& rest);
  void choose_separator();
  void read_header();
  [[nodiscard]] bool next_cells();
  [[nodiscard]] bool begins_with_row_name() const;
  [[nodiscard]] bool is_row_of_units() const;
  void require_decimal_mark(std::size_t column);
  void check_header(const std::vector<std::string>& unknown) const;
  void read_number(std::size_t column);

  [[nodiscard]] bool take_line();

  std::string file_;
  InputFile in_;
  std::vector<CsvColumn> columns_;
  double largest_;
  std::string buffer_;
  std::size_t begin_ = 0;  // bytes of the buffer that were read but not used yet, up to end_
  std::size_t end_ = 0;
  std::string_view line_;  // in the buffer
  char separator_ = ',';
  std::vector<std::string_view> cells_;
  std::vector<bool> in_quotes_;       // of each cell
  std::string unquoted_;              // cells of the row that had doubled quotation marks
  std::vector<std::size_t> cell_of_;  // of each column: its cell in a row
  std::vector<double> numbers_;       // of each column: the row's number
  std::size_t line_number_ = 0;
  std::size_t header_cells_ = 0;
  bool has_rows_ = false;
  bool has_row_names_ = false;       // in a first cell of each row that the header lacks
  bool ends_in_separator_ = false;   // the header does
  char decimal_mark_ = '\0';         // of the numbers so far; 0: they had none
  bool decimal_mark_known_ = false;  // some number's mark cannot be one of thousands
  std::string undecided_;            // the first number whose mark can
  std::optional<ByteOrder> utf16_;
  std::string raw_;      // UTF-16 that was read but not decoded yet
  std::string decoded_;  // UTF-8 that is not in the buffer yet
};

}  // namespace palpate

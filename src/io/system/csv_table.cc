#include "io/system/csv_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "io/system/file_content.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate {
namespace {

constexpr std::size_t kLongestLine = std::size_t{64} << 10U;

/// "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

/// As listed(), but at most five names and the number of the others.
std::string first_names(std::vector<std::string> names) {
  constexpr std::size_t kShown = 5;
  if (names.size() > kShown + 1) {
    const std::string others = std::to_string(names.size() - kShown) + " others";
    names.resize(kShown);
    names.push_back(others);
  }
  return listed(names);
}

std::string required_names(const std::vector<CsvColumn>& columns) {
  std::vector<std::string> names;
  for (const CsvColumn& column : columns) {
    if (column.required) names.push_back(column.name);
  }
  return listed(names);
}

/// "mm" of "depth_mm"; empty for a column without a unit.
std::string_view unit_of(std::string_view column) {
  const std::size_t end = column.rfind('_');
  return end == std::string_view::npos ? std::string_view() : column.substr(end + 1);
}

std::string_view without_brackets(std::string_view text) {
  const bool has_brackets = text.size() >= 2 && ((text.front() == '[' && text.back() == ']') ||
                                                 (text.front() == '(' && text.back() == ')'));
  return has_brackets ? text.substr(1, text.size() - 2) : text;
}

/// A missing number of Excel, no comment.
bool is_error_of_excel(std::string_view text) {
  constexpr std::array<std::string_view, 7> kErrors = {"#N/A",  "#VALUE!", "#DIV/0!", "#REF!",
                                                       "#NUM!", "#NAME?",  "#NULL!"};
  return std::any_of(kErrors.begin(), kErrors.end(),
                     [text](std::string_view error) { return text.starts_with(error); });
}

/// The number with a point as its decimal mark; nullopt with several marks.
std::optional<double> parse_with_comma(std::string_view cell) {
  if (cell.find('.') != std::string_view::npos) return std::nullopt;
  std::string text(cell);
  text[text.find(',')] = '.';
  return parse_number(text);
}

/// The position of the first separator; the end of the text without one. A blank stands for tabs, too.
std::size_t find_separator(std::string_view text, char separator) {
  return std::min(text.size(), separator == ' ' ? text.find_first_of(" \t") : text.find(separator));
}

/// Whether the only mark of a number may separate thousands: 1,234 but not 0,234 or 1,23.
bool may_be_thousands(std::string_view number, char mark) {
  if (number.starts_with('+') || number.starts_with('-')) number.remove_prefix(1);
  const std::size_t at = number.find(mark);
  return at >= 1 && at <= 3 && number.front() != '0' && number.size() == at + 4 &&
         number.find_first_not_of("0123456789", at + 1) == std::string_view::npos;
}

}  // namespace

std::string csv_quoted(std::string_view text) {
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + '"';
}

std::string csv_cell(std::string_view text) {
  return text.find_first_of(",\"\r\n") == std::string_view::npos ? std::string(text) : csv_quoted(text);
}

CsvTable::CsvTable(const std::filesystem::path& file, std::vector<CsvColumn> columns, double largest)
    : file_(to_text(file)),
      in_(file, kCsvInput),
      columns_(std::move(columns)),
      largest_(largest),
      buffer_(kLongestLine, '\0'),
      cell_of_(columns_.size(), kAbsent),
      numbers_(columns_.size(), 0.0) {
  unquoted_.reserve(kLongestLine);
  try {
    find_encoding();
    if (!next_line()) throw InputError(file_ + ": is empty, must have a header and rows");
    read_header();
  } catch (const InputError&) {
    refuse_other_content(file, FileContent::kTable, "a CSV file");
    throw;
  }
}

bool CsvTable::next_row() {
  if (!next_cells() || (!has_rows_ && is_row_of_units() && !next_cells())) return false;
  has_rows_ = true;
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (!has(column)) continue;
    if (!columns_[column].is_text) {
      read_number(column);
    } else if (text(column).empty()) {
      fail(columns_[column].name + ": empty, must be a name");
    }
  }
  return true;
}

/// Reads the cells of the next row, one for each of the header. The first row shows whether rows have names;
/// between commas, some number must then have a decimal point, as a decimal comma makes a further cell, too.
/// @return false at the end of the file
bool CsvTable::next_cells() {
  if (!next_line()) {
    if (!has_rows_) throw InputError(file_ + ": has no rows after the header");
    if (!undecided_.empty() && !decimal_mark_known_) throw InputError(undecided_);
    return false;
  }
  split();
  if (ends_in_separator_ && cells_.size() > header_cells_ && cells_.back().empty()) cells_.pop_back();
  const bool has_name = cells_.size() == header_cells_ + 1 && begins_with_row_name();
  const auto wrong_length = [&] {
    return "the row has " + std::to_string(cells_.size()) + " values, must have " +
           std::to_string(header_cells_) + " as the header";
  };
  if (!has_rows_ && has_name && separator_ == ',') {
    decimal_mark_ = '.';
    undecided_ =
        in_line(wrong_length() +
                ": the first may be a row name, or a comma a decimal one, and no number has a decimal point");
  }
  has_row_names_ = has_row_names_ || (!has_rows_ && has_name);
  if (has_row_names_ ? !has_name : cells_.size() != header_cells_) {
    const bool decimal_comma = separator_ == ',' && cells_.size() == 2 * header_cells_;
    fail(wrong_length() + (has_row_names_ ? ", behind a row name" : "") +
         (decimal_comma ? "; a decimal comma must be a point" : ""));
  }
  if (has_name) cells_.erase(cells_.begin());
  return true;
}

/// Whether a row's first cell is a name of the row, before a number: no number itself, or in quotation marks
/// before a cell without them.
bool CsvTable::begins_with_row_name() const {
  const auto first = static_cast<std::size_t>(std::find(cell_of_.begin(), cell_of_.end(), std::size_t{0}) -
                                              cell_of_.begin());
  const bool may_be = first < columns_.size() && !columns_[first].is_text && !cells_[0].empty() &&
                      cells_[0].find(',') == std::string_view::npos;
  return may_be && ((in_quotes_[0] && !in_quotes_[1]) || !parse_number(cells_[0]));
}

/// Whether each cell of a number's column has the column's unit. @throws InputError for another unit
bool CsvTable::is_row_of_units() const {
  bool any = false;
  std::size_t other = kAbsent;
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (!has(column) || columns_[column].is_text) continue;
    if (parse_number(text(column))) return false;
    const std::string_view unit = unit_of(columns_[column].name);
    const std::string_view cell = without_brackets(text(column));
    const bool fits = cell == unit || (unit.empty() && cell == "-");
    any = any || (fits && !unit.empty());
    if (!fits && other == kAbsent) other = column;
  }
  if (any && other != kAbsent) {
    fail(columns_[other].name + ": the row of units says " + excerpt(text(other)) +
         ", must be the unit in the column's name: convert the numbers");
  }
  return any;
}

std::string CsvTable::in_line(const std::string& what) const {
  return file_ + ":" + std::to_string(line_number_) + ": " + what;
}

void CsvTable::fail(const std::string& what) const { throw InputError(in_line(what)); }

void CsvTable::fail(std::size_t column, const std::string& want) const {
  fail(columns_[column].name + " = " + shortest(number(column)) + ": " + want);
}

/// Takes the file's first bytes: a byte order mark of UTF-16 makes it UTF-16.
void CsvTable::find_encoding() {
  while (end_ < 2) {
    const std::size_t count = in_.read(std::span(buffer_).subspan(end_, 2 - end_));
    if (count == 0) return;
    end_ += count;
  }
  const std::string_view first(buffer_.data(), 2);
  if (first == "\xFF\xFE") utf16_ = ByteOrder::kLittleEndian;
  if (first == "\xFE\xFF") utf16_ = ByteOrder::kBigEndian;
  if (utf16_) end_ = 0;
}

/// Reads further text of the file as UTF-8. @return the number of its bytes; 0 at the end of the file
std::size_t CsvTable::read_text(std::span<char> to) {
  if (!utf16_) return in_.read(to);
  constexpr std::size_t kBlock = 4096;
  while (decoded_.empty()) {
    const std::size_t kept = raw_.size();
    raw_.resize(kept + kBlock);
    const std::size_t count = in_.read(std::span(raw_).subspan(kept));
    raw_.resize(kept + count);
    if (count == 0) return 0;
    append_utf16(raw_, *utf16_, decoded_);
  }
  const std::size_t count = std::min(to.size(), decoded_.size());
  std::copy_n(decoded_.begin(), count, to.begin());
  decoded_.erase(0, count);
  return count;
}

/// Reads the file's next line into line_, without its line end. @return false at the end of the file
bool CsvTable::take_line() {
  for (std::size_t searched = begin_;;) {
    const std::size_t newline = std::string_view(buffer_).substr(0, end_).find('\n', searched);
    if (newline != std::string_view::npos) {
      line_ = std::string_view(buffer_).substr(begin_, newline - begin_);
      begin_ = newline + 1;
      return true;
    }
    std::copy(buffer_.data() + begin_, buffer_.data() + end_, buffer_.data());
    end_ -= std::exchange(begin_, 0);
    searched = end_;
    if (end_ == buffer_.size()) {
      ++line_number_;
      fail("the line is longer than 64 KiB, is this a CSV file?");
    }
    const std::size_t count = read_text(std::span(buffer_).subspan(end_));
    end_ += count;
    if (count > 0) continue;
    line_ = std::string_view(buffer_).substr(0, end_);
    begin_ = end_;
    return !line_.empty();
  }
}

/// Goes to the next line that is neither blank nor a comment, nor a first line "sep=;" for Excel.
bool CsvTable::next_line() {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  for (;;) {
    if (!take_line()) return false;
    ++line_number_;
    if (line_number_ == 1 && line_.starts_with(kByteOrderMark)) line_.remove_prefix(kByteOrderMark.size());
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    const std::string_view text = trimmed(line_);
    const bool is_for_excel = line_number_ == 1 && text.starts_with("sep=");
    const bool is_comment = text.starts_with('#') && !is_error_of_excel(text);
    if (text.empty() || is_comment || is_for_excel) continue;
    if (line_.find('\0') != std::string_view::npos) {
      fail("has zero bytes: must be UTF-8, or UTF-16 with a byte order mark");
    }
    if (line_.find('\r') != std::string_view::npos) fail("lines end in CR alone, must end in LF or CR LF");
    return true;
  }
}

void CsvTable::split() {
  cells_.clear();
  in_quotes_.clear();
  unquoted_.clear();
  for (std::string_view rest = separator_ == ' ' ? trimmed(line_) : line_;;) {
    std::size_t first = rest.find_first_not_of(separator_ == '\t' ? " " : " \t");
    if (separator_ == ' ') rest.remove_prefix(std::exchange(first, 0));
    in_quotes_.push_back(first != std::string_view::npos && rest[first] == '"');
    if (in_quotes_.back()) {
      rest.remove_prefix(first + 1);
      cells_.push_back(take_quoted(rest));
    } else {
      const std::size_t end = find_separator(rest, separator_);
      cells_.push_back(trimmed(rest.substr(0, end)));
      rest.remove_prefix(end);
    }
    if (rest.empty()) return;
    rest.remove_prefix(1);
  }
}

/// Takes a cell from behind its first quotation mark up to the next separator; a doubled mark inside is one.
std::string_view CsvTable::take_quoted(std::string_view& rest) {
  const std::size_t begin = unquoted_.size();
  bool has_doubled = false;
  std::size_t end = rest.find('"');
  for (std::size_t from = 0; end != std::string_view::npos; end = rest.find('"', from)) {
    unquoted_.append(rest.substr(from, end - from));
    if (rest.substr(end + 1, 1) != "\"") break;
    unquoted_ += '"';
    has_doubled = true;
    from = end + 2;
  }
  if (end == std::string_view::npos) fail("a cell in quotation marks must end in its line");
  const std::string_view cell = has_doubled ? std::string_view(unquoted_).substr(begin) : rest.substr(0, end);
  rest.remove_prefix(end + 1);
  const std::size_t next = find_separator(rest, separator_);
  if (!trimmed(rest.substr(0, next)).empty()) {
    fail(excerpt(cell) + ": has text behind its quotation mark; a mark inside a cell must be doubled");
  }
  rest.remove_prefix(next);
  return trimmed(cell);
}

/// Takes the separator by which the header names the most columns, else the one that makes the most cells.
void CsvTable::choose_separator() {
  std::pair<std::size_t, std::size_t> best;
  char found = separator_;
  for (const char separator : {',', ';', '\t', ' '}) {
    separator_ = separator;
    try {
      split();
    } catch (const InputError&) {  // quotation marks that do not end before this separator
      continue;
    }
    const auto named = static_cast<std::size_t>(
        std::count_if(columns_.begin(), columns_.end(), [&](const CsvColumn& column) {
          return std::find(cells_.begin(), cells_.end(), column.name) != cells_.end();
        }));
    if (separator == ' ' && named <= best.first) continue;  // words, or blanks beside another separator
    if (std::pair(named, cells_.size()) > best) {
      best = {named, cells_.size()};
      found = separator;
    }
  }
  separator_ = found;
  split();
}

void CsvTable::read_header() {
  choose_separator();
  const std::string required = required_names(columns_);
  if (parse_number(cells_.front())) fail("the header is missing: the first line must name " + required);
  ends_in_separator_ = cells_.size() > 1 && cells_.back().empty();
  if (ends_in_separator_) cells_.pop_back();
  std::vector<std::string> unknown;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const bool has_row_names =
        i == 0 && cells_.size() > 1 && (cells_[0].empty() || cells_[0] == "Unnamed: 0");
    if (has_row_names) continue;
    const auto named = std::find_if(columns_.begin(), columns_.end(),
                                    [&](const CsvColumn& column) { return column.name == cells_[i]; });
    if (named == columns_.end()) {
      unknown.push_back(excerpt(cells_[i]));
      continue;
    }
    const auto column = static_cast<std::size_t>(named - columns_.begin());
    if (has(column)) fail(columns_[column].name + ": the column appears twice, must appear once");
    cell_of_[column] = i;
  }
  header_cells_ = cells_.size();
  check_header(unknown);
}

/// @param unknown header names that are not in `columns`
void CsvTable::check_header(const std::vector<std::string>& unknown) const {
  std::vector<std::string> missing;
  std::vector<std::string> absent;
  std::vector<std::string> known;
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    known.push_back(columns_[column].name);
    if (!has(column)) absent.push_back(known.back());
    if (!has(column) && columns_[column].required) missing.push_back(known.back());
  }
  if (missing.empty() && unknown.empty()) return;
  const bool one_misspelt = !unknown.empty() && missing.size() <= 1;
  const std::string near =
      one_misspelt ? nearest_word(unknown.front(), missing.empty() ? absent : missing) : "";
  if (missing.empty() || !near.empty()) {
    fail("column \"" + unknown.front() + "\": unknown, " +
         (near.empty() ? "valid are " + listed(known) + "; rename it, or delete the column"
                       : "did you mean " + near + other_unit(unknown.front(), near) + "?"));
  }
  std::string unit;
  for (const std::string& name : unknown) {
    for (const std::string& column : missing) {
      if (unit.empty()) unit = other_unit(name, column);
    }
  }
  const std::vector<std::string> names(cells_.begin(), cells_.end());
  const ContentFacts other = table_of(names);
  fail(listed(missing) + ": missing, the header must name " + required_names(columns_) +
       (unknown.empty() ? "" : "; unknown in it: " + first_names(unknown)) + unit +
       (other.name.empty() ? "" : "; the file is " + other.name + ": " + other.use));
}

void CsvTable::read_number(std::size_t column) {
  const std::string_view cell = text(column);
  const bool has_comma = cell.find(',') != std::string_view::npos;
  const std::optional<double> value = has_comma ? parse_with_comma(cell) : parse_number(cell);
  const bool limited = !columns_[column].is_time;
  if (!value || !std::isfinite(*value) || (limited && std::abs(*value) > largest_)) {
    int power = 0;
    for (double size = 1.0; size < largest_ && !std::isinf(size); size *= 10.0) ++power;
    const std::string most = largest_ < 1e300 ? " up to 1e" + std::to_string(power) : "";
    fail(columns_[column].name + " = " + excerpt(cell) + ": must be a finite number" + most);
  }
  numbers_[column] = *value;
  require_decimal_mark(column);
}

/// Requires the same decimal mark in all numbers, and keeps the first that may be one of thousands.
void CsvTable::require_decimal_mark(std::size_t column) {
  const std::string_view cell = text(column);
  const std::size_t at = cell.find_first_of(".,");
  if (at == std::string_view::npos) return;
  const char mark = cell[at];
  const auto refusal = [&](const std::string& want) {
    return columns_[column].name + " = " + excerpt(cell) + ": " + want;
  };
  if (decimal_mark_ != '\0' && decimal_mark_ != mark) {
    fail(refusal(std::string("must have the decimal mark of the numbers before it, a ") +
                 (mark == ',' ? "point" : "comma")));
  }
  decimal_mark_ = mark;
  const bool is_plain = mark == '.' && separator_ != ';';
  if (is_plain || !may_be_thousands(cell, mark)) {
    decimal_mark_known_ = true;
  } else if (undecided_.empty()) {
    undecided_ = in_line(refusal(
        "its mark may be a decimal one or one of thousands, and no other number shows which: must be a "
        "decimal point, with commas between the columns"));
  }
}

}  // namespace palpate

#include "io/mesh_io/formats/scan.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <system_error>

#include <fmt/core.h>

#include "core/base/charconv.h"
#include "core/base/infinity.h"
#include "core/base/text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

constexpr std::string_view kBlank = " \t\v\f\r\n";

struct TypeFacts {
  std::size_t size;        // bytes
  std::string_view names;  // each between spaces
};

constexpr std::array<TypeFacts, 10> kTypes{{{1, " char int8 signed_char "},  // as in NumberType
                                            {1, " uchar uint8 unsigned_char "},
                                            {2, " short int16 "},
                                            {2, " ushort uint16 unsigned_short "},
                                            {4, " int int32 vtkidtype "},
                                            {4, " uint uint32 unsigned_int "},
                                            {8, " long vtktypeint64 "},
                                            {8, " unsigned_long vtktypeuint64 "},
                                            {4, " float float32 "},
                                            {8, " double float64 "}}};

std::size_t size_of(NumberType type) { return kTypes[static_cast<std::size_t>(type)].size; }

template <typename T>
T decoded(const std::array<char, 8>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::string quoted(std::string_view word) { return "\"" + excerpt(word, 40) + "\""; }

}  // namespace

std::uint32_t little_endian_32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::optional<double> number(std::string_view word) {
  if (const std::optional<double> value = parse_number(word)) return value;
  double value = 0.0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc::result_out_of_range || end != word.data() + word.size()) return std::nullopt;
  const bool is_small =
      word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
  return is_small ? 0.0 : kInfinity;
}

std::optional<std::int64_t> whole_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string upper(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text;
}

MeshScan::MeshScan(const MeshFile& file, Lines lines)
    : file_(file), bytes_(file.bytes), lines_(lines), limit_(bytes_.size()) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes_.starts_with(kByteOrderMark)) at_ = next_ = last_ = kByteOrderMark.size();
}

void MeshScan::refuse_at(std::size_t place, const std::string& message) const {
  std::string at = "byte " + std::to_string(place);
  if (!is_binary()) {
    std::size_t line = 1;
    for (std::size_t end = line_end(0); end < std::min(place, bytes_.size());
         end = line_end(behind_line_end(end)))
      ++line;
    at = "line " + std::to_string(line);
  }
  throw InputError(fmt::format("{}, {}: {}", to_text(file_.path), at, one_line(message)));
}

void MeshScan::refuse_index(std::int64_t index, std::size_t vertices, int first, std::size_t place) const {
  refuse_at(place,
            fmt::format("{}: vertex index {} is out of range: the file has {} vertices, the first is {}",
                        item(), index, vertices, first));
}

void MeshScan::refuse_as_short() const {
  if (limit_ < bytes_.size()) refuse(item() + " has too few numbers");
  refuse(fmt::format("truncated: ends in {}{}", item(), count_ == 0 ? "" : fmt::format(" of {}", count_)));
}

std::string MeshScan::item() const {
  return number_ ? fmt::format("{} {}", what_, *number_) : std::string(what_);
}

std::size_t MeshScan::line_end(std::size_t from) const {
  return std::min(bytes_.size(), bytes_.find_first_of("\r\n", from));
}

std::size_t MeshScan::behind_line_end(std::size_t end) const {
  return std::min(bytes_.size(), end + (bytes_.substr(end, 2) == "\r\n" ? 2 : 1));
}

bool MeshScan::next_line() {
  at_ = last_ = next_;
  if (at_ >= bytes_.size()) return false;
  limit_ = line_end(at_);
  next_ = behind_line_end(limit_);
  if (lines_ == Lines::kPlain) return true;
  while (limit_ > at_ && bytes_[limit_ - 1] == '\\' && next_ < bytes_.size()) {
    limit_ = line_end(next_);
    next_ = behind_line_end(limit_);
  }
  limit_ = std::min(limit_, bytes_.substr(0, limit_).find('#', at_));
  return true;
}

std::string_view MeshScan::rest_of_line() const {
  return trimmed(bytes_.substr(at_, std::min(limit_, line_end(at_)) - at_));
}

void MeshScan::leave_lines() {
  at_ = limit_ == bytes_.size() ? behind_line_end(line_end(at_)) : next_;
  last_ = at_;
  limit_ = bytes_.size();
}

std::string_view MeshScan::word() {
  const std::string_view within = bytes_.substr(0, limit_);
  while (true) {
    at_ = std::min(limit_, within.find_first_not_of(kBlank, at_));
    last_ = at_;
    const std::size_t end = std::min(limit_, within.find_first_of(kBlank, at_));
    std::string_view word = within.substr(at_, end - at_);
    at_ = end;
    const bool is_joined = lines_ == Lines::kCommented && word.ends_with('\\') && end < limit_ &&
                           (bytes_[end] == '\r' || bytes_[end] == '\n');
    if (is_joined) word.remove_suffix(1);
    if (!word.empty() || !is_joined) return word;
  }
}

std::string_view MeshScan::peek() const { return MeshScan(*this).word(); }

void MeshScan::expect(std::string_view wanted) {
  const std::string_view found = word();
  if (found == wanted) return;
  refuse(fmt::format("{}: must be {} here", found.empty() ? "truncated" : quoted(found), wanted));
}

void MeshScan::skip_past(std::string_view mark) {
  const std::size_t found = bytes_.find(mark, at_);
  if (found == std::string_view::npos) refuse(fmt::format("truncated: {} is missing", mark));
  at_ = found + mark.size();
}

std::size_t MeshScan::count(std::string_view of) {
  const std::string_view text = word();
  const std::optional<std::int64_t> number = whole_number(text);
  if (!number) refuse(fmt::format("{} is not a number of {}", quoted(text), of));
  return as_count(*number, of);
}

std::size_t MeshScan::as_count(std::int64_t number, std::string_view of) const {
  if (number < 0) refuse(fmt::format("\"{}\" is not a number of {}", number, of));
  if (static_cast<std::uint64_t>(number) > bytes_.size()) {
    refuse(fmt::format("declares {} {}, more than its {} bytes can hold", number, of, bytes_.size()));
  }
  return static_cast<std::size_t>(number);
}

NumberType MeshScan::type() {
  const std::string_view text = word();
  std::string name = " " + std::string(text) + " ";
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (std::size_t n = 0; n < kTypes.size(); ++n) {
    if (kTypes[n].names.find(name) != std::string_view::npos) return static_cast<NumberType>(n);
  }
  refuse(quoted(text) + " is not a type of numbers, such as float or int");
}

void MeshScan::reading(std::string_view what, std::optional<std::size_t> number, std::size_t count) {
  what_ = what;
  number_ = number;
  count_ = count;
}

std::size_t MeshScan::least_bytes(NumberType type) const {
  return is_binary() ? size_of(type) : 2;  // a digit and a space, except after the last
}

void MeshScan::require_room(std::size_t count, std::size_t bytes_each, std::string_view of) {
  last_ = at_;
  const std::size_t left = bytes_.size() - at_;
  if (bytes_each == 0 || count <= (left + 1) / bytes_each) return;
  refuse(fmt::format("truncated: {} {} do not fit in the {} bytes that are left", count, of, left));
}

std::array<char, 8> MeshScan::take(NumberType type) {
  const std::size_t size = size_of(type);
  last_ = at_;
  if (bytes_.size() - at_ < size) refuse_as_short();
  std::array<char, 8> bytes{};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), size, bytes.begin());
  if (encoding_ == Encoding::kBigEndian)
    std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  at_ += size;
  return bytes;
}

std::string_view MeshScan::number_word() {
  const std::string_view text = word();
  if (text.empty()) refuse_as_short();
  return text;
}

double MeshScan::real(NumberType type) {
  const bool is_whole = type != NumberType::kFloat && type != NumberType::kDouble;
  if (is_binary()) {
    if (is_whole) return static_cast<double>(whole(type));
    const std::array<char, 8> bytes = take(type);
    return type == NumberType::kFloat ? static_cast<double>(decoded<float>(bytes)) : decoded<double>(bytes);
  }
  const std::string_view text = number_word();
  const std::optional<double> value = number(text);
  if (!value) refuse_item(quoted(text) + " is not a number");
  return type == NumberType::kFloat ? static_cast<double>(static_cast<float>(*value)) : *value;
}

std::int64_t MeshScan::whole(NumberType type) {
  if (!is_binary()) {
    const std::string_view text = number_word();
    const std::optional<std::int64_t> value = whole_number(text);
    if (!value) refuse_item(quoted(text) + " is not a whole number");
    return *value;
  }
  const std::array<char, 8> bytes = take(type);
  switch (type) {
    case NumberType::kInt8:
      return decoded<std::int8_t>(bytes);
    case NumberType::kUint8:
      return decoded<std::uint8_t>(bytes);
    case NumberType::kInt16:
      return decoded<std::int16_t>(bytes);
    case NumberType::kUint16:
      return decoded<std::uint16_t>(bytes);
    case NumberType::kInt32:
      return decoded<std::int32_t>(bytes);
    case NumberType::kUint32:
      return decoded<std::uint32_t>(bytes);
    case NumberType::kInt64:
    case NumberType::kUint64:
      return decoded<std::int64_t>(bytes);
    default:
      refuse(item() + " must have whole numbers");
  }
}

Vec3 MeshScan::point(NumberType type, std::size_t number, std::size_t count) {
  reading("vertex", number, count);
  Vec3 point;
  for (double& x : point) x = real(type);
  require_finite(point);
  return point;
}

void MeshScan::require_finite(const Vec3& point) const {
  if ((point.array().abs() <= kLargestCoordinate).all()) return;  // false for NaN
  refuse(item() + " is not finite (NaN, infinite or past 3.4e38)");
}

std::int32_t MeshScan::index(NumberType type, std::size_t vertices) {
  const std::int64_t index = whole(type);
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) refuse_index(index, vertices, 0, last_);
  return static_cast<std::int32_t>(index);
}

void MeshScan::begin_numbers(std::size_t numbers, NumberType type, std::string_view of) {
  if (is_binary()) leave_lines();
  require_room(numbers, least_bytes(type), fmt::format("numbers of {}", of));
}

void MeshScan::skip_numbers(std::size_t numbers, NumberType type) {
  require_room(numbers, least_bytes(type), "numbers");
  if (is_binary()) return skip_bytes(numbers * size_of(type));
  for (std::size_t n = 0; n < numbers; ++n) (void)number_word();
}

void MeshScan::skip_bytes(std::size_t bytes) { at_ = std::min(bytes_.size(), at_ + bytes); }

}  // namespace palpate::mesh_io

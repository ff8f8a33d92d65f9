#include "io/mesh_io/vtk_scan.h"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/text_scan.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr std::string_view kBlank = " \t\v\f\r\n";

constexpr std::array<std::pair<std::string_view, VtkType>, 14> kTypes{{{"char", VtkType::kInt8},
                                                                       {"signed_char", VtkType::kInt8},
                                                                       {"unsigned_char", VtkType::kUint8},
                                                                       {"short", VtkType::kInt16},
                                                                       {"unsigned_short", VtkType::kUint16},
                                                                       {"int", VtkType::kInt32},
                                                                       {"vtkidtype", VtkType::kInt32},
                                                                       {"unsigned_int", VtkType::kUint32},
                                                                       {"long", VtkType::kInt64},
                                                                       {"vtktypeint64", VtkType::kInt64},
                                                                       {"unsigned_long", VtkType::kUint64},
                                                                       {"vtktypeuint64", VtkType::kUint64},
                                                                       {"float", VtkType::kFloat},
                                                                       {"double", VtkType::kDouble}}};

std::size_t size_of(VtkType type) {
  switch (type) {
    case VtkType::kInt8:
    case VtkType::kUint8:
      return 1;
    case VtkType::kInt16:
    case VtkType::kUint16:
      return 2;
    case VtkType::kInt32:
    case VtkType::kUint32:
    case VtkType::kFloat:
      return 4;
    case VtkType::kInt64:
    case VtkType::kUint64:
    case VtkType::kDouble:
      return 8;
  }
  return 1;
}

template <typename T>
T decoded(const std::array<char, 8>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::string quoted(std::string_view word) { return "\"" + std::string(word.substr(0, 40)) + "\""; }

}  // namespace

void VtkScan::refuse(const std::string& words) const {
  std::string place = ", byte " + std::to_string(last_);
  if (!is_binary_) {
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(last_, bytes_.size()));
    place = ", line " + std::to_string(1 + std::count(bytes_.begin(), end, '\n'));
  }
  throw InputError(fmt::format("{}{}: {}", file_.path.string(), place, without_controls(words)));
}

void VtkScan::refuse_as_truncated(const std::string& of) const { refuse("truncated: ends in " + of); }

std::string_view VtkScan::line(const std::string& wanted) {
  last_ = at_;
  if (at_ >= bytes_.size()) refuse("truncated: ends before " + wanted);
  const std::size_t end = std::min(bytes_.size(), bytes_.find('\n', at_));
  const std::string_view line = bytes_.substr(at_, end - at_);
  at_ = std::min(bytes_.size(), end + 1);
  return trimmed(line);
}

std::string_view VtkScan::word() {
  at_ = std::min(bytes_.size(), bytes_.find_first_not_of(kBlank, at_));
  last_ = at_;
  const std::size_t end = std::min(bytes_.size(), bytes_.find_first_of(kBlank, at_));
  const std::string_view word = bytes_.substr(at_, end - at_);
  at_ = end;
  return word;
}

std::string_view VtkScan::peek() {
  const auto kept = std::pair(at_, last_);
  const std::string_view next = word();
  std::tie(at_, last_) = kept;
  return next;
}

std::size_t VtkScan::count(const std::string& of) {
  const std::string_view text = word();
  const std::optional<std::int64_t> number = whole_number(text);
  if (!number || *number < 0) refuse(quoted(text) + " is not a number of " + of);
  if (static_cast<std::uint64_t>(*number) > bytes_.size()) {
    refuse(fmt::format("declares {} {}, more than its {} bytes can hold", *number, of, bytes_.size()));
  }
  return static_cast<std::size_t>(*number);
}

VtkType VtkScan::type(const std::string& of) {
  const std::string_view text = word();
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const auto& [name, type] : kTypes) {
    if (name == lower) return type;
  }
  refuse(quoted(text) + " is not a type of " + of);
}

void VtkScan::begin_numbers(std::size_t numbers, VtkType type, const std::string& of) {
  if (is_binary_) {
    const std::size_t end = bytes_.find('\n', at_);
    at_ = end == std::string_view::npos ? bytes_.size() : end + 1;
  }
  last_ = at_;
  const std::size_t left = bytes_.size() - at_;
  // A number in text takes two bytes, the last one needs no blank.
  if (numbers > (is_binary_ ? left / size_of(type) : (left + 1) / 2)) {
    refuse(fmt::format("truncated: {} numbers of {} do not fit in the {} bytes that are left", numbers, of,
                       left));
  }
}

std::array<char, 8> VtkScan::take(VtkType type, const std::string& of) {
  const std::size_t size = size_of(type);
  last_ = at_;
  if (bytes_.size() - at_ < size) refuse_as_truncated(of);
  std::array<char, 8> bytes{};
  std::reverse_copy(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                    bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size), bytes.begin());
  at_ += size;
  return bytes;
}

double VtkScan::real(VtkType type, const std::string& of) {
  if (is_binary_) {
    const std::array<char, 8> bytes = take(type, of);
    return type == VtkType::kFloat ? static_cast<double>(decoded<float>(bytes)) : decoded<double>(bytes);
  }
  const std::string_view text = word();
  if (text.empty()) refuse_as_truncated(of);
  const std::optional<double> value = number(text);
  if (!value) refuse(quoted(text) + " is not a number, in " + of);
  return type == VtkType::kFloat ? static_cast<double>(static_cast<float>(*value)) : *value;
}

std::int64_t VtkScan::whole(VtkType type, const std::string& of) {
  if (is_binary_) {
    const std::array<char, 8> bytes = take(type, of);
    switch (type) {
      case VtkType::kUint8:
        return decoded<std::uint8_t>(bytes);
      case VtkType::kInt32:
        return decoded<std::int32_t>(bytes);
      case VtkType::kUint32:
        return decoded<std::uint32_t>(bytes);
      default:
        return decoded<std::int64_t>(bytes);
    }
  }
  const std::string_view text = word();
  if (text.empty()) refuse_as_truncated(of);
  const std::optional<std::int64_t> value = whole_number(text);
  if (!value) refuse(quoted(text) + " is not a whole number, in " + of);
  return *value;
}

void VtkScan::skip_numbers(std::size_t numbers, VtkType type, const std::string& of) {
  begin_numbers(numbers, type, of);
  if (is_binary_) {
    at_ += numbers * size_of(type);
    return;
  }
  for (std::size_t n = 0; n < numbers; ++n) {
    if (word().empty()) refuse_as_truncated(of);
  }
}

void VtkScan::skip_to_empty_line() {
  (void)line("an empty line");
  while (at_ < bytes_.size() && !line("an empty line").empty()) {
  }
}

}  // namespace palpate::geometry

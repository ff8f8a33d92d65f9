#include "io/mesh_io/text_scan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/core.h>

#include "palpate/error.h"

namespace palpate::geometry {
std::string_view LineReader::take() {
  const std::size_t end = rest_.find_first_of("\r\n");
  const std::string_view line = rest_.substr(0, end);
  ++lines_taken_;
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    const bool is_pair = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
    rest_.remove_prefix(end + (is_pair ? 2 : 1));
  }
  return line;
}

bool LineReader::next() {
  if (rest_.empty()) return false;
  number_ = lines_taken_ + 1;
  line_ = take();
  if (!joins_ || line_.empty() || line_.back() != '\\') return true;
  joined_ = line_;
  while (!joined_.empty() && joined_.back() == '\\' && !rest_.empty()) {
    joined_.back() = ' ';
    joined_ += take();
  }
  line_ = joined_;
  return true;
}

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t\v\f\r\n");
  if (begin == std::string_view::npos) {
    rest = {};
    return {};
  }
  const std::size_t end = std::min(rest.size(), rest.find_first_of(" \t\v\f\r\n", begin));
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::optional<double> number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // too large, or so small that it is none
    return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
               ? 0.0
               : std::numeric_limits<double>::infinity();
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

void require_finite(const Point& point, const std::string& where, std::size_t vertex) {
  for (const float x : point) {
    if (std::isfinite(x)) continue;
    throw InputError(
        fmt::format("{}: vertex {} is not finite (NaN, infinite or past 3.4e38)", where, vertex));
  }
}

Point read_point(std::string_view rest, const std::string& where, std::size_t vertex) {
  Point point{};
  for (float& x : point) {
    const std::string_view word = next_word(rest);
    if (word.empty()) {
      throw InputError(fmt::format("{}: vertex {} has fewer than three numbers", where, vertex));
    }
    const std::optional<double> value = number(word);
    if (!value) {
      throw InputError(
          fmt::format("{}: vertex {}: \"{}\" is not a number", where, vertex, word.substr(0, 40)));
    }
    x = static_cast<float>(*value);
  }
  require_finite(point, where, vertex);
  return point;
}

void PolygonBudget::take(std::size_t corners, const std::string& where) {
  constexpr std::size_t kMostCorners = 512;
  constexpr std::uint64_t kMostSteps = 120'000'000;  // about 4 s
  if (corners <= 3) return;
  if (corners > kMostCorners) {
    throw InputError(fmt::format("{}: a polygon of {} corners: at most {} are cut into triangles", where,
                                 corners, kMostCorners));
  }
  steps_ += static_cast<std::uint64_t>(corners) * corners * corners / 6;
  if (steps_ > kMostSteps) {
    throw InputError(
        fmt::format("{}: too many polygons as large as this one of {} corners: cut them into triangles first",
                    where, corners));
  }
}

void PointSet::add(const Point& point) {
  distinct_.insert({point[0] + 0.0F, point[1] + 0.0F, point[2] + 0.0F});  // -0 is 0
}

std::size_t PointSet::Hash::operator()(const Point& point) const noexcept {
  std::uint64_t hash = 0;
  for (const float x : point) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

void ObjText::add_point(const Point& point) {
  vertices_ += 'v';
  for (const float value : point) {
    std::array<char, 32> digits;
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    vertices_ += ' ';
    if (error == std::errc()) vertices_.append(digits.data(), end);
  }
  vertices_ += '\n';
}

void ObjText::add_corner(std::uint64_t vertex) {
  if (!in_face_) faces_ += 'f';
  in_face_ = true;
  faces_ += ' ' + std::to_string(vertex + 1);
}

void ObjText::end_face() {
  if (in_face_) faces_ += '\n';
  in_face_ = false;
}

std::string without_controls(std::string words) {
  constexpr char kFirstPrinted = 0x20;
  constexpr char kDelete = 0x7f;
  for (char& c : words) {
    if ((c >= 0 && c < kFirstPrinted) || c == kDelete) c = '?';
  }
  return words;
}

}  // namespace palpate::geometry

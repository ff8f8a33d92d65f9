#include "view/report/text_format.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "core/base/text.h"

namespace palpate::report {

std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

std::string grouped(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string escaped(std::string_view text) {
  static constexpr std::string_view kMarkup = "&<>\"'";
  static constexpr std::array<const char*, kMarkup.size()> kEntities = {"&amp;", "&lt;", "&gt;", "&quot;",
                                                                        "&#39;"};
  std::string result;
  for (const char c : text) {
    const std::size_t which = kMarkup.find(c);
    result += which < kEntities.size() ? kEntities[which] : std::string(1, c);
  }
  return result;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t taken = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < taken ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += k <= taken ? kAlphabet[(group >> (18U - 6U * k)) & 63U] : '=';
    }
  }
  return result;
}

std::string utc_time(std::int64_t unix_ns) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(unix_ns / 1'000'000'000)));
}

std::string number(double value, const char* unit) {
  constexpr int kDigits = 12;
  return brief(value, kDigits) + (*unit == '\0' ? "" : " ") + unit;
}

std::string millimetres(double metres) { return number(metres * kMilli, "mm"); }

std::string point_mm(const Vec3& p) {
  const auto bare = [](double metres) {
    const std::string text = millimetres(metres);
    return text.substr(0, text.size() - 3);
  };
  return fmt::format("{}, {}, {} mm", bare(p.x()), bare(p.y()), bare(p.z()));
}

}  // namespace palpate::report

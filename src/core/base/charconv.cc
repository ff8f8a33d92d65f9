#include "core/base/charconv.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace palpate::by_printf {
namespace {

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// The end of a decimal number's text; `first` without a number.
const char* end_of_number(const char* first, const char* last) noexcept {
  const auto skip_digits = [last](const char* at) { return std::find_if_not(at, last, is_digit); };
  const char* const begin = first != last && *first == '-' ? first + 1 : first;
  const char* at = skip_digits(begin);
  std::ptrdiff_t digits = at - begin;
  if (at != last && *at == '.') {
    const char* const end = skip_digits(at + 1);
    digits += end - (at + 1);
    at = end;
  }
  if (digits == 0) return first;
  if (at != last && (*at == 'e' || *at == 'E')) {
    const char* exponent = at + 1;
    if (exponent != last && (*exponent == '+' || *exponent == '-')) ++exponent;
    if (exponent != last && is_digit(*exponent)) at = skip_digits(exponent);
  }
  return at;
}

/// "inf", "infinity" or "nan" in any case, after a sign.
std::from_chars_result word_from(const char* first, const char* last, double& value) noexcept {
  const bool is_negative = first != last && *first == '-';
  const char* const begin = first + (is_negative ? 1 : 0);
  const std::string_view text(begin, static_cast<std::size_t>(last - begin));
  for (const std::string_view word :
       {std::string_view("infinity"), std::string_view("inf"), std::string_view("nan")}) {
    const bool same =
        text.size() >= word.size() && std::equal(word.begin(), word.end(), text.begin(), [](char a, char b) {
          return a == std::tolower(static_cast<unsigned char>(b));
        });
    if (!same) continue;
    value =
        word == "nan" ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
    if (is_negative) value = -value;
    return {text.data() + word.size(), std::errc{}};
  }
  return {first, std::errc::invalid_argument};
}

/// The shortest scientific text that reads back to the same bits. @return its length
int write_scientific(std::array<char, 32>& text, double value) noexcept {
  int length = 0;
  // A normal number keeps any 15 digits, a subnormal one fewer.
  for (int decimals = std::isnormal(value) ? 14 : 0; decimals < 17; ++decimals) {
    length = std::snprintf(text.data(), text.size(), "%.*e", decimals, value);
    if (std::strtod(text.data(), nullptr) == value) break;
  }
  char* const exponent = std::find(text.data(), text.data() + length, 'e');
  char* end = exponent;
  if (std::find(text.data(), exponent, '.') != exponent) {
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
  }
  std::copy(exponent, text.data() + length + 1, end);
  return length - static_cast<int>(exponent - end);
}

}  // namespace

std::from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* const end = end_of_number(first, last);
  if (end == first) return word_from(first, last, value);
  const std::string text(first, end);
  const double read = std::strtod(text.c_str(), nullptr);
  const std::string_view mantissa = std::string_view(text).substr(0, text.find_first_of("eE"));
  if (std::isinf(read) || (read == 0.0 && mantissa.find_first_of("123456789") != std::string_view::npos)) {
    return {end, std::errc::result_out_of_range};
  }
  value = read;
  return {end, std::errc{}};
}

std::to_chars_result to_chars(char* first, char* last, double value) noexcept {
  std::array<char, 32> scientific{};
  std::array<char, 32> fixed{};
  int length = 0;
  const char* text = scientific.data();
  if (!std::isfinite(value)) {
    text = std::isinf(value) ? (value < 0.0 ? "-inf" : "inf") : (std::signbit(value) ? "-nan" : "nan");
    length = static_cast<int>(std::strlen(text));
  } else {
    length = write_scientific(scientific, value);
    const char* const exponent = std::find(text, text + length, 'e');
    const int power = std::atoi(exponent + 1);
    const auto digits = static_cast<int>(std::count_if(text, exponent, is_digit));
    if (std::abs(power) < 25) {
      const int of_fixed =
          std::snprintf(fixed.data(), fixed.size(), "%.*f", std::max(0, digits - 1 - power), value);
      if (of_fixed <= length) {
        text = fixed.data();
        length = of_fixed;
      }
    }
  }
  if (length > last - first) return {last, std::errc::value_too_large};
  return {std::copy(text, text + length, first), std::errc{}};
}

}  // namespace palpate::by_printf

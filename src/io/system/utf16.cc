#include "io/system/utf16.h"

#include <cstdint>

namespace palpate {
namespace {

constexpr bool is_high_surrogate(std::uint32_t unit) { return unit >= 0xD800 && unit < 0xDC00; }
constexpr bool is_low_surrogate(std::uint32_t unit) { return unit >= 0xDC00 && unit < 0xE000; }

void append_code_point(std::uint32_t code, std::string& utf8) {
  const auto add = [&utf8](std::uint32_t byte) { utf8 += static_cast<char>(byte); };
  const auto add_tail = [&](int shift) { add(0x80U | (code >> shift & 0x3FU)); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xC0U | code >> 6U);
  } else if (code < 0x10000) {
    add(0xE0U | code >> 12U);
    add_tail(6);
  } else {
    add(0xF0U | code >> 18U);
    add_tail(12);
    add_tail(6);
  }
  add_tail(0);
}

}  // namespace

void append_utf16(std::string& utf16, ByteOrder order, std::string& utf8) {
  constexpr std::uint32_t kReplacement = 0xFFFD;
  const auto unit_at = [&](std::size_t at) {
    const auto first = static_cast<std::uint8_t>(utf16[at]);
    const auto second = static_cast<std::uint8_t>(utf16[at + 1]);
    return order == ByteOrder::kBigEndian ? std::uint32_t{first} << 8U | second
                                          : std::uint32_t{second} << 8U | first;
  };
  std::size_t at = 0;
  while (at + 2 <= utf16.size()) {
    const std::uint32_t unit = unit_at(at);
    std::uint32_t code = unit;
    if (is_high_surrogate(unit)) {
      if (at + 4 > utf16.size()) break;
      const std::uint32_t low = unit_at(at + 2);
      code = kReplacement;
      if (is_low_surrogate(low)) {
        code = 0x10000U + ((unit - 0xD800U) << 10U) + (low - 0xDC00U);
        at += 2;
      }
    } else if (is_low_surrogate(unit)) {
      code = kReplacement;
    }
    append_code_point(code, utf8);
    at += 2;
  }
  utf16.erase(0, at);
}

}  // namespace palpate

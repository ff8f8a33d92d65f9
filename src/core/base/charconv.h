#pragma once
// What some standard libraries lack (Emscripten 3.1.6): std::bit_cast, and std::from_chars and std::to_chars
// of double.
#include <charconv>
#include <version>

namespace palpate {

/// [any] As std::bit_cast.
template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

namespace by_printf {

/// [any] As std::from_chars of decimal numbers, by strtod. Allocates for a text of over 63 characters.
std::from_chars_result from_chars(const char* first, const char* last, double& value);
/// [any] As std::to_chars, by snprintf: the shortest text that reads back to the same bits, for a few powers
/// of two with one digit more.
std::to_chars_result to_chars(char* first, char* last, double value) noexcept;

}  // namespace by_printf

using std::from_chars;
using std::to_chars;
#if !defined(__cpp_lib_to_chars)
using by_printf::from_chars;
using by_printf::to_chars;
#endif

}  // namespace palpate

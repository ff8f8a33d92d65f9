#pragma once
#include <string>

namespace palpate {

enum class ByteOrder { kLittleEndian, kBigEndian };

/// [setup] Moves the characters of a UTF-16 text to the end of a UTF-8 text. An incomplete character at the
/// end of `utf16` stays there. Half of a surrogate pair becomes U+FFFD.
void append_utf16(std::string& utf16, ByteOrder order, std::string& utf8);

}  // namespace palpate

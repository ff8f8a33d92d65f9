#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// [any] Bytes in base64, padded [RFC 4648, section 4].
[[nodiscard]] std::string base64(std::string_view bytes);

/// [any] The bytes of a text in base64, up to its padding or first character that is no digit of it.
[[nodiscard]] std::string base64_decoded(std::string_view text);

}  // namespace palpate

#pragma once
#include <span>

namespace palpate::geometry {

/// [setup] Inflates bytes in zlib's format. @return whether they fill `unpacked` exactly
[[nodiscard]] bool inflate(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) noexcept;

}  // namespace palpate::geometry

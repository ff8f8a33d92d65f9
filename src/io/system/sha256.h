#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// [setup] SHA-256 of bytes, in hexadecimal [FIPS 180-4].
[[nodiscard]] std::string sha256(std::string_view bytes);

/// [setup] SHA-256 of a file's content. @throws InputError when it cannot be read
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

/// [setup] HMAC-SHA-256 of bytes, in hexadecimal [RFC 2104]. It cannot be made without the key.
[[nodiscard]] std::string hmac_sha256(std::string_view key, std::string_view bytes);

}  // namespace palpate

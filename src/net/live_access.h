#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

// Access control of the live interface: tokens and origins.
namespace palpate::net {

inline constexpr std::size_t kShortestToken = 16;  // characters

/// [setup] A new token: 32 random bytes from the system as 64 hexadecimal digits.
[[nodiscard]] std::string new_token();

/// [setup] The token in the first line of a file. @throws InputError when the file cannot be read or users
/// other than its owner may read it, or when the token is shorter than kShortestToken, longer than 1024
/// characters or not printable ASCII without spaces.
[[nodiscard]] std::string read_token_file(const std::filesystem::path& file);

/// [any] Whether both are equal, in a time that depends only on the length of `given`.
[[nodiscard]] bool same_token(std::string_view wanted, std::string_view given) noexcept;

/// [setup] Checks an origin as browsers send it: http://HOST or https://HOST, with :PORT or without.
/// @throws InputError that states the required form.
void check_origin(const std::string& origin);

/// [any] Whether a web page of this origin may connect: the server's own page under the address and port of
/// the connection (also localhost, on this machine), and allowed origins. Other web pages must not control a
/// device.
/// @param host local address of the connection, as in a URL
[[nodiscard]] bool origin_allowed(std::string_view origin, const std::string& host, std::uint16_t port,
                                  bool loopback, std::span<const std::string> allowed);

}  // namespace palpate::net

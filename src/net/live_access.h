#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

// Who may talk to the live interface.
namespace palpate::net {

inline constexpr std::size_t kShortestToken = 16;  // characters

/// [setup] A new token: 32 random bytes of the system's as 64 hexadecimal digits.
[[nodiscard]] std::string new_token();

/// [setup] The token in the first line of a file. @throws InputError when the file cannot be read, is
/// readable for others than its owner, or its token is shorter than kShortestToken, longer than 1024
/// characters or not of printable ASCII without spaces.
[[nodiscard]] std::string read_token_file(const std::filesystem::path& file);

/// [any] Whether the two are the same, in a time that depends on the length of `given` alone.
[[nodiscard]] bool same_token(std::string_view wanted, std::string_view given) noexcept;

/// [setup] Checks an origin as browsers send it: http://HOST or https://HOST, with :PORT or without.
/// @throws InputError that says its form.
void check_origin(const std::string& origin);

/// [any] Whether a browser's page of this origin may connect: the page that the server itself gives out,
/// under the address and port that it was asked at (and localhost, where that is this machine), and those
/// that are allowed by name. A page of another origin must not reach a device on its reader's desk.
/// @param host of the address that the connection came in at, as in a URL
[[nodiscard]] bool origin_allowed(std::string_view origin, const std::string& host, std::uint16_t port,
                                  bool loopback, std::span<const std::string> allowed);

}  // namespace palpate::net

#include "net/live_access.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include <fmt/core.h>

#include "io/system/files.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::net {
namespace {

constexpr std::size_t kLongestToken = 1024;  // characters

bool printable(char c) { return c > ' ' && c <= '~'; }

}  // namespace

std::string new_token() {
  std::array<char, 32> bytes{};
  if (!random_bytes(bytes.data(), bytes.size())) {
    throw std::runtime_error("the system gives no random bytes for a token");
  }
  std::string token;
  for (const char letter : bytes) {
    const auto byte = static_cast<unsigned char>(letter);
    token += "0123456789abcdef"[byte >> 4U];
    token += "0123456789abcdef"[byte & 15U];
  }
  return token;
}

std::string read_token_file(const std::filesystem::path& file) try {
  InputFile input(file, kTokenInput);
  const auto refuse = [&file](const std::string& why) { throw InputError(to_text(file) + ": " + why); };
  FileStatus facts{};
  if (status_of(input.descriptor(), facts) != 0) refuse("cannot be read");
  if (is_usable_by_others(facts)) {
    refuse("others than its owner may use it, so that it is no secret: chmod 600 " + to_text(file));
  }
  std::istringstream lines(input.read_rest());
  std::string token;
  if (!std::getline(lines, token)) refuse("is empty, a token is wanted in its first line");
  if (!token.empty() && token.back() == '\r') token.pop_back();
  if (token.size() < kShortestToken || token.size() > kLongestToken) {
    refuse(fmt::format("its first line has {} characters, a token must have {} to {}", token.size(),
                       kShortestToken, kLongestToken));
  }
  if (!std::all_of(token.begin(), token.end(), printable)) {
    refuse("its first line has other characters than printable ASCII without spaces");
  }
  return token;
} catch (const InputError& error) {
  throw InputError(std::string("--token-file ") + error.what());
}

bool same_token(std::string_view wanted, std::string_view given) noexcept {
  volatile unsigned char different = wanted.size() == given.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const char expected = wanted.empty() ? '\0' : wanted[i % wanted.size()];
    different = static_cast<unsigned char>(
        different | (static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(expected)));
  }
  return different == 0;
}

void check_origin(const std::string& origin) {
  std::string_view rest = origin;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (rest.substr(0, scheme.size()) != scheme) continue;
    rest.remove_prefix(scheme.size());
    const bool plain = std::all_of(rest.begin(), rest.end(), printable);
    if (!rest.empty() && plain && rest.find_first_of("/*?#@\\") == std::string_view::npos) return;
  }
  throw InputError("--allow-origin " + origin +
                   ": must be an origin as browsers send it, http://HOST:PORT without a path, as in "
                   "http://localhost:8000");
}

bool origin_allowed(std::string_view origin, const std::string& host, std::uint16_t port, bool loopback,
                    std::span<const std::string> allowed) {
  // Browsers omit the scheme's default port, which is 80 for http.
  const std::string ending = port == 80 ? "" : ":" + std::to_string(port);
  if (origin == "http://" + host + ending) return true;
  if (loopback && origin == "http://localhost" + ending) return true;
  return std::find(allowed.begin(), allowed.end(), origin) != allowed.end();
}

}  // namespace palpate::net

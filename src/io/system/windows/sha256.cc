#include "io/system/sha256.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

// The second header needs the first.
// clang-format off
#include <windows.h>
#include <bcrypt.h>
// clang-format on

#include "io/system/input_file.h"

namespace palpate {
namespace {

constexpr InputKind kHashedFile{"a regular file", std::uint64_t{1} << 40};
constexpr std::size_t kDigestBytes = 32;

void require_done(NTSTATUS status) {
  if (status < 0) throw std::runtime_error("Windows (bcrypt) cannot compute SHA-256");
}

/// SHA-256, or HMAC-SHA-256 with a key.
class Hash final {
 public:
  Hash() : Hash(0, {}) {}
  explicit Hash(std::string_view key) : Hash(BCRYPT_ALG_HANDLE_HMAC_FLAG, key) {}
  ~Hash() {
    if (hash_ != nullptr) BCryptDestroyHash(hash_);
    if (algorithm_ != nullptr) BCryptCloseAlgorithmProvider(algorithm_, 0);
  }
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;

  void add(std::string_view bytes) {
    constexpr std::size_t kMost = std::size_t{1} << 30;
    while (!bytes.empty()) {
      std::string_view part = bytes.substr(0, kMost);
      require_done(BCryptHashData(hash_, bytes_of(part), static_cast<ULONG>(part.size()), 0));
      bytes.remove_prefix(part.size());
    }
  }

  std::string hexadecimal() {
    std::array<unsigned char, kDigestBytes> digest{};
    require_done(BCryptFinishHash(hash_, digest.data(), kDigestBytes, 0));
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const unsigned char byte : digest) {
      text += kDigits[byte >> 4U];
      text += kDigits[byte & 15U];
    }
    return text;
  }

 private:
  Hash(ULONG flags, std::string_view key) {
    require_done(BCryptOpenAlgorithmProvider(&algorithm_, BCRYPT_SHA256_ALGORITHM, nullptr, flags));
    const NTSTATUS made =
        BCryptCreateHash(algorithm_, &hash_, nullptr, 0, key.empty() ? nullptr : bytes_of(key),
                         static_cast<ULONG>(key.size()), 0);
    if (made < 0) BCryptCloseAlgorithmProvider(algorithm_, 0);
    require_done(made);
  }

  // The functions change no bytes, but their parameters are not const.
  static unsigned char* bytes_of(std::string_view text) {
    return const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(text.data()));
  }

  BCRYPT_ALG_HANDLE algorithm_ = nullptr;
  BCRYPT_HASH_HANDLE hash_ = nullptr;
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.hexadecimal();
}

std::string sha256_of_file(const std::filesystem::path& file) {
  InputFile input(file, kHashedFile);
  Hash hash;
  std::vector<char> block(std::size_t{1} << 16U);
  while (const std::size_t count = input.read(block)) hash.add(std::string_view(block.data(), count));
  return hash.hexadecimal();
}

std::string hmac_sha256(std::string_view key, std::string_view bytes) {
  Hash hash(key);
  hash.add(bytes);
  return hash.hexadecimal();
}

}  // namespace palpate

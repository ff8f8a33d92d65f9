#include "io/system/sha256.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "io/system/input_file.h"

namespace palpate {
namespace {

using Digest = std::array<unsigned char, EVP_MAX_MD_SIZE>;

constexpr InputKind kAnyInput{"a regular file", std::uint64_t{1} << 40};

std::string hexadecimal(const Digest& digest, unsigned int size) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : std::span(digest).first(size)) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

[[noreturn]] void fail() { throw std::runtime_error("libcrypto cannot compute SHA-256"); }

}  // namespace

std::string sha256(std::string_view bytes) {
  Digest digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) fail();
  return hexadecimal(digest, size);
}

std::string sha256_of_file(const std::filesystem::path& file) {
  InputFile input(file, kAnyInput);
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  if (!context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) fail();
  std::vector<char> block(std::size_t{1} << 16U);
  while (const std::size_t count = input.read(block)) {
    if (EVP_DigestUpdate(context.get(), block.data(), count) != 1) fail();
  }
  Digest digest{};
  unsigned int size = 0;
  if (EVP_DigestFinal_ex(context.get(), digest.data(), &size) != 1) fail();
  return hexadecimal(digest, size);
}

std::string hmac_sha256(std::string_view key, std::string_view bytes) {
  Digest digest{};
  unsigned int size = 0;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), data, bytes.size(), digest.data(),
           &size) == nullptr) {
    fail();
  }
  return hexadecimal(digest, size);
}

}  // namespace palpate

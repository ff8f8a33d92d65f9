#include "core/base/content_hash.h"

#include <bit>
#include <cstring>

namespace palpate {
namespace {

// Odd constants with half of their bits set: fractions of the golden ratio and of sqrt(2).
constexpr std::uint64_t kOne = 0x9e3779b97f4a7c15U;
constexpr std::uint64_t kTwo = 0x6a09e667f3bcc909U;

/// Mixes x so that every bit of the result depends on every bit of x.
std::uint64_t scatter(std::uint64_t x) noexcept {
  x = (x ^ (x >> 32)) * kOne;
  x = (x ^ (x >> 29)) * kTwo;
  return x ^ (x >> 32);
}

}  // namespace

std::string ContentHash::hexadecimal() const {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint64_t word : words) {
    for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[(word >> shift) & 15U];
  }
  return text;
}

void ContentHasher::mix(std::uint64_t word) noexcept {
  // Each line is a bijection of its accumulator for any word. Two independent chains detect any single
  // change.
  a_ = (a_ ^ word) * kOne;
  a_ ^= a_ >> 32;
  b_ = (std::rotl(b_, 29) + word) * kTwo;
}

ContentHasher& ContentHasher::add(std::span<const std::byte> bytes) noexcept {
  mix(bytes.size());
  std::uint64_t word = 0;
  while (bytes.size() >= sizeof word) {
    std::memcpy(&word, bytes.data(), sizeof word);
    mix(word);
    bytes = bytes.subspan(sizeof word);
  }
  if (!bytes.empty()) {
    word = 0;
    std::memcpy(&word, bytes.data(), bytes.size());
    mix(word);
  }
  return *this;
}

ContentHash ContentHasher::hash() const noexcept {
  return {{scatter(a_ + std::rotl(b_, 32)), scatter(b_ ^ scatter(a_))}};
}

}  // namespace palpate

#include "io/igtl/igtl_bytes.h"

#include <algorithm>
#include <array>
#include <bit>

namespace palpate::net {
namespace {

constexpr std::array<std::uint64_t, 256> checksum_table() {
  constexpr std::uint64_t kPolynomial = 0x42f0'e1eb'a9ea'3693;
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t byte = 0; byte < table.size(); ++byte) {
    std::uint64_t value = byte << 56U;
    for (int bit = 0; bit < 8; ++bit) value = (value << 1U) ^ ((value >> 63U) != 0 ? kPolynomial : 0);
    table[byte] = value;
  }
  return table;
}

constexpr std::array<std::uint64_t, 256> kChecksums = checksum_table();

/// Appends the lowest bytes of a number, the highest of them first.
void append(Bytes& to, std::uint64_t number, unsigned bytes) {
  for (unsigned left = bytes; left > 0; --left) {
    to.push_back(static_cast<unsigned char>(number >> (8U * (left - 1))));
  }
}

/// Appends a text, padded with zeros.
void append(Bytes& to, const std::string& text, std::size_t bytes) {
  const std::size_t length = std::min(text.size(), bytes);
  to.insert(to.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
  to.insert(to.end(), bytes - length, 0);
}

void append(Bytes& to, double value) {
  append(to, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4U);
}

}  // namespace

std::uint64_t igtl_checksum(std::span<const unsigned char> body) noexcept {
  std::uint64_t sum = 0;
  for (const unsigned char byte : body) sum = (sum << 8U) ^ kChecksums[(sum >> 56U) ^ byte];
  return sum;
}

void IgtlBytes::add(const std::string& type, const std::string& name, const Bytes& body) {
  constexpr std::int64_t kSecond = 1'000'000'000;  // ns
  const auto seconds = static_cast<std::uint64_t>(unix_ns_ / kSecond);
  const auto part = static_cast<std::uint64_t>(unix_ns_ % kSecond);
  append(bytes_, 1, 2U);  // version
  append(bytes_, type, std::size_t{12});
  append(bytes_, name, std::size_t{20});
  append(bytes_, seconds << 32U | (part << 32U) / static_cast<std::uint64_t>(kSecond), 8U);
  append(bytes_, body.size(), 8U);
  append(bytes_, igtl_checksum(body), 8U);
  bytes_.insert(bytes_.end(), body.begin(), body.end());
}

void IgtlBytes::add_transform(const std::string& name, const Pose& pose) {
  const Mat3 rotation = pose.rotation.toRotationMatrix();
  Bytes body;
  for (Eigen::Index column = 0; column < 3; ++column) {
    for (Eigen::Index row = 0; row < 3; ++row) append(body, rotation(row, column));
  }
  for (Eigen::Index row = 0; row < 3; ++row) append(body, 1e3 * pose.position(row));
  add("TRANSFORM", name, body);
}

void IgtlBytes::add_sensor(const std::string& name, const Vec3& values, std::uint64_t unit) {
  Bytes body = {3, 0};  // number of values, status
  append(body, unit, 8U);
  for (const double value : values) append(body, std::bit_cast<std::uint64_t>(value), 8U);
  add("SENSOR", name, body);
}

}  // namespace palpate::net

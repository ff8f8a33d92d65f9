#include "io/igtl/igtl_messages.h"

#include <algorithm>
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

void append(Bytes& to, float value) { append(to, std::bit_cast<std::uint32_t>(value), 4U); }

/// A position [m] in mm.
void append(Bytes& to, const Vec3& place) {
  for (const double metres : place) append(to, static_cast<float>(1e3 * metres));
}

}  // namespace

std::uint64_t igtl_checksum(std::span<const unsigned char> body) noexcept {
  std::uint64_t sum = 0;
  for (const unsigned char byte : body) sum = (sum << 8U) ^ kChecksums[(sum >> 56U) ^ byte];
  return sum;
}

void IgtlMessages::add(const std::string& type, const std::string& name, const Bytes& body) {
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

void IgtlMessages::add_transform(const std::string& name, const Pose& pose) {
  const Mat3 rotation = pose.rotation.toRotationMatrix();
  Bytes body;
  for (Eigen::Index column = 0; column < 3; ++column) {
    for (Eigen::Index row = 0; row < 3; ++row) append(body, static_cast<float>(rotation(row, column)));
  }
  append(body, pose.position);
  add("TRANSFORM", name, body);
}

void IgtlMessages::add_point(const std::string& name, const std::string& label, const Vec3& place,
                             bool shown) {
  Bytes body;
  append(body, label, std::size_t{64});
  append(body, "Contact", std::size_t{32});  // group
  const unsigned char opacity = shown ? 255 : 0;
  body.insert(body.end(), {255, 200, 0, opacity});
  append(body, place);
  append(body, 0.0F);                 // radius
  append(body, "", std::size_t{20});  // owner
  add("POINT", name, body);
}

void IgtlMessages::add_sensor(const std::string& name, std::span<const double> values, SensorUnit unit) {
  Bytes body = {static_cast<unsigned char>(values.size()), 0};  // status
  append(body, static_cast<std::uint64_t>(unit), 8U);
  for (const double value : values) append(body, std::bit_cast<std::uint64_t>(value), 8U);
  add("SENSOR", name, body);
}

void IgtlMessages::add_string(const std::string& name, const std::string& text) {
  constexpr std::uint64_t kUsAscii = 3;
  Bytes body;
  append(body, kUsAscii, 2U);
  append(body, text.size(), 2U);
  append(body, text, text.size());
  add("STRING", name, body);
}

void IgtlMessages::add_status(const std::string& name, StatusCode code, std::int64_t number,
                              const std::string& error, const std::string& text) {
  Bytes body;
  append(body, static_cast<std::uint64_t>(code), 2U);
  append(body, static_cast<std::uint64_t>(number), 8U);
  append(body, error, std::size_t{20});
  append(body, text, text.size() + 1);
  add("STATUS", name, body);
}

void IgtlMessages::add_surface(const std::string& name, std::span<const Vec3> vertices,
                               std::span<const std::array<std::int32_t, 3>> triangles) {
  constexpr std::size_t kVertex = 12;    // bytes
  constexpr std::size_t kTriangle = 16;  // bytes
  Bytes body;
  body.reserve(40 + kVertex * vertices.size() + kTriangle * triangles.size());
  append(body, vertices.size(), 4U);
  append(body, "", std::size_t{16});  // numbers and bytes of points and lines as cells
  append(body, triangles.size(), 4U);
  append(body, kTriangle * triangles.size(), 4U);
  append(body, "", std::size_t{12});  // number and bytes of strips, number of attributes
  for (const Vec3& vertex : vertices) append(body, vertex);
  for (const std::array<std::int32_t, 3>& triangle : triangles) {
    append(body, triangle.size(), 4U);
    for (const std::int32_t corner : triangle) append(body, static_cast<std::uint64_t>(corner), 4U);
  }
  add("POLYDATA", name, body);
}

}  // namespace palpate::net

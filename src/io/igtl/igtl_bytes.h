#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::net {

using Bytes = std::vector<unsigned char>;

/// [any] The checksum of a message's body: CRC-64 with the polynomial of ECMA-182, from 0.
[[nodiscard]] std::uint64_t igtl_checksum(std::span<const unsigned char> body) noexcept;

/// Units of SENSOR messages, as the protocol codes them.
inline constexpr std::uint64_t kIgtlNewton = 0x02c4'0000'0000'0000;
inline constexpr std::uint64_t kIgtlNewtonMetre = 0x02c4'1100'0000'0000;

/// Packs messages with one time stamp for a client, protocol version 1. All members: [any], one thread.
class IgtlBytes final {
 public:
  /// @param unix_ns time stamp of every message, since 1970
  explicit IgtlBytes(std::int64_t unix_ns) : unix_ns_(unix_ns) {}

  /// TRANSFORM: a pose in metres, sent in mm, single precision. @param name at most 20 characters
  void add_transform(const std::string& name, const Pose& pose);
  /// SENSOR: three numbers. @param unit one of the above
  void add_sensor(const std::string& name, const Vec3& values, std::uint64_t unit);

  [[nodiscard]] const Bytes& bytes() const noexcept { return bytes_; }

 private:
  void add(const std::string& type, const std::string& name, const Bytes& body);

  std::int64_t unix_ns_;
  Bytes bytes_;
};

}  // namespace palpate::net

#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::net {

using Bytes = std::vector<unsigned char>;

/// [any] The checksum of a message's body: CRC-64 with the polynomial of ECMA-182, from 0.
[[nodiscard]] std::uint64_t igtl_checksum(std::span<const unsigned char> body) noexcept;

/// Unit of the values of a SENSOR message, as the protocol codes it.
enum class SensorUnit : std::uint64_t {
  kNewton = 0x02c4'0000'0000'0000,
  kNewtonMetre = 0x02c4'1100'0000'0000,
  kMillimetre = 0xb044'0000'0000'0000,
  kSecond = 0x00c4'0000'0000'0000,
};

/// Code of a STATUS message, as the protocol defines it.
enum class StatusCode : std::uint16_t {
  kOk = 1,
  kUnknownError = 2,
  kTimeOut = 7,
  kNotReady = 13,
  kDisabled = 15,
  kHardwareFailure = 18,
  kShutDown = 19,
};

/// Packs OpenIGTLink messages with one time stamp (protocol version 1, which every client reads). Lengths are
/// given in metres and sent in mm. All members: [setup], one thread.
class IgtlMessages final {
 public:
  /// @param unix_ns time stamp of every message, since 1970
  explicit IgtlMessages(std::int64_t unix_ns) : unix_ns_(unix_ns) {}

  /// TRANSFORM: from the inner frame to the outer one, single precision. @param name at most 20 characters,
  /// as in all other messages
  void add_transform(const std::string& name, const Pose& pose);
  /// POINT: a list of one point. @param label at most 64 characters @param shown sent as the colour's opacity
  void add_point(const std::string& name, const std::string& label, const Vec3& place, bool shown);
  /// SENSOR. @param values at most 255, in `unit`
  void add_sensor(const std::string& name, std::span<const double> values, SensorUnit unit);
  void add_sensor(const std::string& name, const Vec3& values, SensorUnit unit) {
    add_sensor(name, std::span(values.data(), 3), unit);
  }
  /// STRING, US-ASCII, of at most 65535 characters.
  void add_string(const std::string& name, const std::string& text);
  /// STATUS. @param number subcode @param error its name, at most 20 characters
  void add_status(const std::string& name, StatusCode code, std::int64_t number, const std::string& error,
                  const std::string& text);
  /// POLYDATA: a surface, single precision. @param triangles indices of vertices
  void add_surface(const std::string& name, std::span<const Vec3> vertices,
                   std::span<const std::array<std::int32_t, 3>> triangles);

  [[nodiscard]] const Bytes& bytes() const noexcept { return bytes_; }

 private:
  void add(const std::string& type, const std::string& name, const Bytes& body);

  std::int64_t unix_ns_;
  Bytes bytes_;
};

}  // namespace palpate::net

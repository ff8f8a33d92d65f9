#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/igtl/igtl_bytes.h"
#include "palpate/mesh.h"
#include "palpate/pose.h"

namespace palpate::net {

/// Unit of the values of a SENSOR message.
enum class SensorUnit { kNewton, kNewtonMetre, kMillimetre, kSecond };

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
/// given in metres and sent in mm; the world frame is sent as RAS. All members: [setup], one thread.
class IgtlMessages final {
 public:
  /// @param unix_ns time stamp of every message, since 1970
  explicit IgtlMessages(std::int64_t unix_ns) : unix_ns_(unix_ns) {}

  /// TRANSFORM: from the inner frame to the world. @param name at most 20 characters, as in all other
  /// messages
  void add_transform(const std::string& name, const Pose& pose_W);
  /// POINT: a list of one point. @param label at most 64 characters @param shown sent as the colour's opacity
  void add_point(const std::string& name, const std::string& label, const Vec3& place_W, bool shown);
  /// SENSOR. @param values at most 255, in `unit`
  void add_sensor(const std::string& name, std::span<const double> values, SensorUnit unit);
  /// STRING, US-ASCII.
  void add_string(const std::string& name, const std::string& text);
  /// STATUS. @param number subcode @param error its name, at most 20 characters
  void add_status(const std::string& name, StatusCode code, std::int64_t number, const std::string& error,
                  const std::string& text);

  [[nodiscard]] const Bytes& bytes() const noexcept { return bytes_; }

 private:
  template <typename Message>
  void add(Message& message, const std::string& name);

  std::int64_t unix_ns_;
  Bytes bytes_;
};

/// A surface of constant triangles and moving vertices as POLYDATA messages. All members: [setup], one
/// thread.
class IgtlSurface final {
 public:
  IgtlSurface(std::string name, std::span<const geometry::Triangle> triangles);
  ~IgtlSurface();
  IgtlSurface(const IgtlSurface&) = delete;
  IgtlSurface& operator=(const IgtlSurface&) = delete;

  /// @param vertices in the world, m; sent in mm, single precision @param unix_ns time stamp, since 1970
  [[nodiscard]] Bytes message(std::span<const Vec3> vertices, std::int64_t unix_ns);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::net

#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/pose.h"

namespace palpate::net {

using Bytes = std::vector<unsigned char>;

/// What the values of a SENSOR message are.
enum class SensorUnit { kNewton, kNewtonMetre, kMillimetre, kSecond };

/// Code of a STATUS message; the protocol's own numbers.
enum class StatusCode : std::uint16_t {
  kOk = 1,
  kUnknownError = 2,
  kTimeOut = 7,
  kNotReady = 13,
  kDisabled = 15,
  kHardwareFailure = 18,
  kShutDown = 19,
};

/// OpenIGTLink messages of one moment, packed one after the other (protocol version 1, which every client
/// reads). Lengths come in metres and go out in mm; the frame is the world's, sent as RAS. All members:
/// [setup], one thread.
class IgtlMessages final {
 public:
  /// @param unix_ns time stamp of every message, since 1970
  explicit IgtlMessages(std::int64_t unix_ns) : unix_ns_(unix_ns) {}

  /// TRANSFORM: from the inner frame to the world. @param name of at most 20 letters, as for all others
  void add_transform(const std::string& name, const Pose& pose_W);
  /// POINT: a list of one. @param label of at most 64 letters @param shown sent as the colour's opacity
  void add_point(const std::string& name, const std::string& label, const Vec3& place_W, bool shown);
  /// SENSOR. @param values at most 255, in `unit`
  void add_sensor(const std::string& name, std::span<const double> values, SensorUnit unit);
  /// STRING, US-ASCII.
  void add_string(const std::string& name, const std::string& text);
  /// STATUS. @param number what the code does not say @param error of at most 20 letters
  void add_status(const std::string& name, StatusCode code, std::int64_t number, const std::string& error,
                  const std::string& words);

  [[nodiscard]] const Bytes& bytes() const noexcept { return bytes_; }

 private:
  template <typename Message>
  void add(Message& message, const std::string& name);

  std::int64_t unix_ns_;
  Bytes bytes_;
};

/// One surface as a POLYDATA message; its triangles stay, its vertices move. All members: [setup], one
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

#include "net/igtl_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"

namespace palpate::net {
namespace {

constexpr const char* kStatusNames = "PalpateStatus";

/// Subdivides a coarse mesh so that an indentation moves more than one vertex. The shape of the surface does
/// not change.
geometry::TriangleMesh finely_divided(geometry::TriangleMesh mesh) {
  while (!mesh.triangles.empty() && mesh.triangles.size() <= IgtlStream::kFewestTriangles) {
    mesh = geometry::subdivide(mesh);
  }
  return mesh;
}

/// Rounds to `digits` digits after the decimal point.
std::string with_digits(double value, int digits) {
  const double scale = std::pow(10.0, digits);
  return shortest(std::round(value * scale) / scale);
}

/// Describes the contact of one hand, as in "hand 0 at 1.234 s: presses 3.2 mm deep, 1.05 N".
std::string reading(const haptics::Snapshot& snapshot, std::size_t hand, double time) {
  const contact::ToolResult& result = snapshot.results[hand];
  std::string text = fmt::format("hand {} at {} s: ", hand, with_digits(time, 3));
  switch (result.phase) {
    case contact::Phase::kApproach:
      text += "touches nothing, " + with_digits(1e3 * result.distance, 1) + " mm away";
      break;
    case contact::Phase::kPress:
      text += "presses " + with_digits(1e3 * result.depth, 1) + " mm deep";
      break;
    case contact::Phase::kPull:
      text += "pulls " + with_digits(1e3 * result.depth, 1) + " mm far";
      break;
    case contact::Phase::kInsert:
      text += "is " + with_digits(1e3 * result.needle.length, 1) + " mm deep in layer " +
              std::to_string(result.needle.layer);
      break;
  }
  return fmt::format("{}, {} N", text, with_digits(snapshot.commands[hand].force.norm(), 2));
}

StatusCode code_of(haptics::Fault fault) {
  switch (fault) {
    case haptics::Fault::kNone:
      return StatusCode::kOk;
    case haptics::Fault::kNotFinite:
      return StatusCode::kUnknownError;
    case haptics::Fault::kDevice:
      return StatusCode::kHardwareFailure;
    case haptics::Fault::kStale:
    case haptics::Fault::kStalled:
      return StatusCode::kTimeOut;
    case haptics::Fault::kForceOff:
      return StatusCode::kDisabled;
    case haptics::Fault::kUnstable:
      return StatusCode::kUnknownError;
  }
  return StatusCode::kUnknownError;
}

std::size_t hands_of(const haptics::Snapshot& snapshot) {
  return std::min<std::size_t>(snapshot.hands, kMaxHands);
}

/// Message name with the number of a hand: "PalpateTool" for hand 0, "PalpateTool2" for hand 1.
std::string name_for_hand(const std::string& name, std::size_t hand) {
  return hand == 0 ? name : name + std::to_string(hand + 1);
}

}  // namespace

IgtlStream::IgtlStream(const scene::Scene& scene)
    : rate_Hz_(scene.rate_Hz),
      lps_(scene.organ_frame == scene::OrganFrame::kLps),
      deformer_(finely_divided(scene.organ),
                deform::prepare_response(scene.organ, scene.support, scene.store.get())) {}

/// A vector or point of the world as R, A, S.
Vec3 IgtlStream::in_ras(const Vec3& vector_W) const {
  return lps_ ? Vec3(-vector_W.x(), -vector_W.y(), vector_W.z()) : vector_W;
}

Pose IgtlStream::in_ras(const Pose& pose_W) const {
  if (!lps_) return pose_W;
  const Quat half_turn(0.0, 0.0, 0.0, 1.0);  // about z
  return {half_turn * pose_W.rotation, in_ras(pose_W.position)};
}

Bytes IgtlStream::poses(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const {
  IgtlMessages messages(unix_ns);
  for (std::size_t hand = 0; hand < hands_of(snapshot); ++hand) {
    const contact::ToolResult& result = snapshot.results[hand];
    const bool touches = result.phase != contact::Phase::kApproach;
    messages.add_transform(name_for_hand("PalpateTool", hand), in_ras(snapshot.tools[hand].pose_W));
    messages.add_point(name_for_hand("PalpateContact", hand), "contact", in_ras(result.contact_W), touches);
  }
  return messages.bytes();
}

Bytes IgtlStream::sensors(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const {
  IgtlMessages messages(unix_ns);
  const std::array<double, 1> time = {static_cast<double>(snapshot.tick) / rate_Hz_};
  messages.add_sensor("PalpateTime", time, SensorUnit::kSecond);
  for (std::size_t hand = 0; hand < hands_of(snapshot); ++hand) {
    const haptics::ForceCommand& command = snapshot.commands[hand];
    const std::array<double, 1> depth = {1e3 * snapshot.results[hand].depth};
    messages.add_sensor(name_for_hand("PalpateForce", hand), in_ras(command.force), SensorUnit::kNewton);
    messages.add_sensor(name_for_hand("PalpateTorque", hand), in_ras(command.torque),
                        SensorUnit::kNewtonMetre);
    messages.add_sensor(name_for_hand("PalpateDepth", hand), depth, SensorUnit::kMillimetre);
  }
  return messages.bytes();
}

Bytes IgtlStream::status(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const {
  IgtlMessages messages(unix_ns);
  const double time = static_cast<double>(snapshot.tick) / rate_Hz_;
  for (std::size_t hand = 0; hand < hands_of(snapshot); ++hand) {
    const haptics::Fault fault = snapshot.faults[hand];
    const bool faulty = fault != haptics::Fault::kNone;
    messages.add_string(name_for_hand("PalpateReading", hand), reading(snapshot, hand, time));
    messages.add_status(
        name_for_hand(kStatusNames, hand), code_of(fault), static_cast<std::int64_t>(fault),
        haptics::name_of(fault),
        faulty ? std::string(haptics::describe(fault)) + "; the force stays zero until it is reset"
               : "no fault");
  }
  return messages.bytes();
}

Bytes IgtlStream::surface(const haptics::Snapshot& snapshot, std::int64_t unix_ns) {
  Shape now{deform::indentations_of(snapshot.hand_results()), snapshot.organ_W, snapshot.reach};
  if (last_ != nullptr && now == *last_) return {};
  deformer_.deform(now.reach, now.indentations, vertices_);
  for (Vec3& vertex : vertices_) vertex = in_ras(now.organ_W * vertex);
  last_ = std::make_unique<Shape>(std::move(now));
  IgtlMessages messages(unix_ns);
  messages.add_surface("PalpateOrgan", vertices_, deformer_.rest().triangles);
  return messages.bytes();
}

Bytes status_without_run(bool ending, std::int64_t unix_ns) {
  IgtlMessages messages(unix_ns);
  if (ending) {
    messages.add_status(kStatusNames, StatusCode::kShutDown, 0, "ended", "palpate ends");
  } else {
    messages.add_status(kStatusNames, StatusCode::kNotReady, 0, "no-run", "nothing is being run");
  }
  return messages.bytes();
}

}  // namespace palpate::net

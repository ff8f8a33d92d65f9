#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "io/igtl/igtl_messages.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"

namespace palpate::net {

/// The messages of one run (docs/openigtlink.md). All members: [setup], one thread.
class IgtlStream final {
 public:
  /// The organ's triangles are divided into four until the surface has more triangles than this. The organ's
  /// vertices keep their indices.
  static constexpr std::size_t kFewestTriangles = 6000;

  /// @param scene not kept
  explicit IgtlStream(const scene::Scene& scene);

  /// Pose and contact of every hand.
  [[nodiscard]] Bytes poses(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const;
  /// Time of the run; force, torque and depth of every hand.
  [[nodiscard]] Bytes sensors(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const;
  /// STRING with these values as text, and STATUS with the fault of every hand.
  [[nodiscard]] Bytes status(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const;
  /// The deformed organ; empty when it has not changed since the last call.
  [[nodiscard]] Bytes surface(const haptics::Snapshot& snapshot, std::int64_t unix_ns);

 private:
  struct Shape {
    std::vector<deform::Indentation> indentations;
    Pose organ_W;
    model::FalloffRatios reach;

    bool operator==(const Shape&) const = default;
  };

  [[nodiscard]] Vec3 in_ras(const Vec3& vector_W) const;
  [[nodiscard]] Pose in_ras(const Pose& pose_W) const;

  double rate_Hz_;
  bool lps_;  // the world's x and y point to the patient's left and back
  deform::SurfaceDeformer deformer_;
  std::vector<Vec3> vertices_;
  std::unique_ptr<Shape> last_;  // null: nothing sent yet
};

/// [setup] The STATUS of hand 0 between runs, or when the program ends.
[[nodiscard]] Bytes status_without_run(bool ending, std::int64_t unix_ns);

}  // namespace palpate::net

#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "net/igtl_messages.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"

namespace palpate::net {

/// [any] The name under which something of a hand is sent: "PalpateTool" of hand 0, "PalpateTool2" of hand 1.
[[nodiscard]] std::string name_for_hand(const std::string& name, std::size_t hand);

/// What is sent of one run, as messages (docs/openigtlink.md). All members: [setup], one thread.
class IgtlStream final {
 public:
  /// The surface that is sent has more triangles than this: the organ's are divided, each into four, until it
  /// has. Vertices of the organ keep their numbers.
  static constexpr std::size_t kFewestTriangles = 6000;

  /// @param setup not kept
  explicit IgtlStream(const scene::Scene& setup);

  /// Pose and contact of every hand.
  [[nodiscard]] static Bytes poses(const haptics::Snapshot& snapshot, std::int64_t unix_ns);
  /// The run's time, and force, torque and depth of every hand.
  [[nodiscard]] Bytes sensors(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const;
  /// The same for people, and whether a hand has a fault.
  [[nodiscard]] Bytes words(const haptics::Snapshot& snapshot, std::int64_t unix_ns) const;
  /// The deformed organ; empty when it lies as it did the last time.
  [[nodiscard]] Bytes surface(const haptics::Snapshot& snapshot, std::int64_t unix_ns);

 private:
  struct Shape {
    std::vector<deform::Indentation> indentations;
    Pose organ_W;
    model::FalloffRatios reach;
  };
  [[nodiscard]] static bool same(const Shape& a, const Shape& b);

  double rate_Hz_;
  deform::SurfaceDeformer deformer_;
  IgtlSurface surface_;
  std::vector<Vec3> vertices_;
  std::unique_ptr<Shape> last_;  // null: none was sent
};

/// [setup] The STATUS of hand 0 between runs, or when the program ends.
[[nodiscard]] Bytes words_without_run(bool ending, std::int64_t unix_ns);

}  // namespace palpate::net

#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/pose.h"

namespace palpate::geometry {

/// Everything beyond a plane across the organ is held: it lies on a bed.
struct Bed {
  Vec3 direction = -Vec3::UnitZ();  // from the organ towards the bed, organ frame; not zero
  double share = 0.3;               // of the organ's extent along the direction, > 0 and <= 0.9
};

/// All faces that look away from a direction are held.
struct HeldFaces {
  Vec3 away_from = Vec3::UnitZ();  // organ frame; not zero
};

/// The surface within a radius of a point is held: a vessel, a ligament, a duct.
struct Attachment {
  Vec3 point = Vec3::Zero();  // organ frame [m]; the nearest point of the surface is the middle
  double radius = 5e-3;       // [m], > 0
};

/// What holds an organ in the body. Each part adds to the held surface.
struct Support {
  std::optional<Bed> bed;
  std::optional<HeldFaces> faces;
  std::vector<Attachment> attachments;  // at most kMaxAttachments
  std::vector<Attachment> painted;      // of a painted mesh, used as they are; at most kMaxPainted

  [[nodiscard]] bool empty() const noexcept {
    return !bed && !faces && attachments.empty() && painted.empty();
  }
};

inline constexpr std::size_t kMaxAttachments = 64;
inline constexpr std::size_t kMaxPainted = 8192;
inline constexpr double kDefaultBedShare = 0.3;
inline constexpr double kLargestBedShare = 0.9;
inline constexpr double kSmallestAttachment = 0.5e-3;  // m, radius
inline constexpr double kLargestAttachment = 0.2;      // m, radius
inline constexpr double kLeastHeld = 2e-3;             // share of the organ's area
inline constexpr double kMostHeld = 0.98;

/// [setup] Checks the numbers of a support. @throws ParameterError that names the first invalid field by its
/// key in a scene file (bed.share, attachment.radius_mm, ...), InputError when it is empty.
void validate(const Support& support);

/// [any] Whether a support holds the surface of an organ at places of it.
class HeldSurface final {
 public:
  /// [setup] @param organ closed or open @throws as validate()
  HeldSurface(const Support& support, const TriangleMesh& organ);
  /// [any] @param point on the surface [m] @param normal outward, any length
  [[nodiscard]] bool holds(const Vec3& point, const Vec3& normal) const noexcept;
  /// [any] Whether a point inside the organ is held: beyond the bed's plane.
  [[nodiscard]] bool holds_inside(const Vec3& point) const noexcept;

 private:
  using Cell = std::array<int, 3>;
  [[nodiscard]] Cell cell_of(const Vec3& point) const noexcept;

  Support support_;            // attachments moved to the surface
  double painted_edge_ = 0.0;  // of the cells by which painted places are found [m]; their largest radius
  std::vector<std::pair<Cell, std::uint32_t>> painted_;  // places by their cells, sorted
  double bed_from_ = 0.0;                                // coordinate along the bed's direction [m]
};

/// [setup] Share of the organ's area that is held, 0 to 1.
[[nodiscard]] double held_share(const Support& support, const TriangleMesh& organ);

/// [setup] Checks a support on an organ. @throws as validate(), InputError when it holds less than kLeastHeld
/// of the surface (the organ would drift or turn away) or more than kMostHeld (nothing could give way), or an
/// attachment is farther from the surface than its radius
void check_support(const Support& support, const TriangleMesh& organ);

}  // namespace palpate::geometry

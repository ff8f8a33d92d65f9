#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/analysis.h"

namespace palpate::report {

/// Displacement of the surface at one place of a line through a contact.
struct LinePlace {
  double distance = 0.0;      // r [m] along the rest surface; negative to the left of the contact
  double displacement = 0.0;  // u [m] along the contact's direction
};

/// A deformation along a line through a contact that a run is compared with.
struct ReferenceProfile {
  std::string source;             // "measured" or "finite elements"
  std::string origin;             // the file's name; where it comes from
  double depth = 0.0;             // D [m]
  std::vector<LinePlace> places;  // by distance
  // Direction of the line in the organ's frame, towards positive distances; empty: as the pictures show it.
  std::optional<Vec3> across_S{};
};

/// [any] The deformation in the demo's experiment of a task by finite elements (tools/update_support); empty
/// for a task without one.
[[nodiscard]] std::optional<ReferenceProfile> computed_profile(scene::Task task);

/// Fewest rows of a measured profile.
inline constexpr std::size_t kFewestPlaces = 5;

/// [setup] Reads a measured profile: CSV, columns by header name: r_mm, u_mm and optionally depth_mm, as
/// `palpate validate --profile` reads them. Only the rows of the largest depth_mm count; without that column
/// the depth is the largest u_mm. @throws InputError that names file, line, column and value.
[[nodiscard]] ReferenceProfile read_measured_profile(const std::filesystem::path& file);

/// The displayed surface along a line through the deepest contact of one hand, beside u(r) of docs/model.md,
/// section 3.
struct SurfaceLine {
  std::vector<LinePlace> places;  // by distance; empty: there is no contact
  double depth = 0.0;             // D [m] of the deepest contact
  double tip_radius = 0.0;        // R [m] of the tool there
  int contacts = 0;               // of the hand at that tick
  int contacts_of_others = 0;     // of other hands
};

/// [setup] The row whose depth a measured profile has: the first one that reaches it. Without a profile, and
/// when no row is as deep, the deepest row. @param measured may be null
[[nodiscard]] std::size_t row_of_profile(const HandAnalysis& hand, model::Direction direction,
                                         const ReferenceProfile* measured);

/// [setup] Follows the displayed surface of a snapshot to both sides of the deepest contact. The line lies in
/// the plane of the contact's direction and `across_S`, a direction in the organ's frame.
[[nodiscard]] SurfaceLine surface_line(const scene::Scene& scene, const haptics::Snapshot& snapshot,
                                       std::size_t hand, const Vec3& across_S);

/// [setup] Follows a plane's section of a surface from a point of a triangle to both sides, at most `limit`
/// [m] far along the rest surface, and at most half-way round. @param moved the displaced vertices
/// @param point_S on the triangle `start` @param direction_S unit, of the displacement @param across_S unit,
/// the side of positive distances; the plane is spanned by both
[[nodiscard]] std::vector<LinePlace> follow_section(const geometry::TriangleMesh& rest,
                                                    const std::vector<Vec3>& moved, std::size_t start,
                                                    const Vec3& point_S, const Vec3& direction_S,
                                                    const Vec3& across_S, double limit);

/// [any] Displacement [m] at a distance, linear between the places; NaN outside them.
[[nodiscard]] double displacement_at(const std::vector<LinePlace>& places, double distance) noexcept;

}  // namespace palpate::report

#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deform/field_change.h"
#include "core/deform/geodesic_front.h"
#include "core/deform/profile_table.h"
#include "core/deform/surface_blocks.h"
#include "core/deform/triangle_grid.h"
#include "palpate/surface.h"

namespace palpate::deform {

/// The moving surface: SurfaceDeformer's rules, at a cost that grows with the vertices in reach and
/// not with the mesh. Vertices and normals are kept from frame to frame, and only those in reach of a
/// contact, now or a frame ago, are computed again, in runs of 64. A run stays as it was drawn while what all
/// changes since then may have moved a vertex of it is bounded (FieldChange, from the least distance of its
/// vertices along the surface) by 0.045 mm, or by nothing at all within 8 mm of a contact: no vertex is then
/// off by more than 0.05 mm from where it would be computed. Not so when asked to settle: then all are
/// computed.
///
/// Distances along the surface are found by a front that runs on from frame to frame. While a contact moves,
/// a vertex's distance is its straight distance from the contact as it is now, and what the way along the
/// surface was longer than that from where the front began; a new front runs behind. Where a front has not
/// come yet nothing moves, and the profile is lowered so that it ends there; likewise where it has fallen to
/// `least_share` of the depth: kLeastShare, as pictures have it, halves the vertices in reach. At the contact
/// the depth stays D. Normals follow from the displacement's derivative, not from triangles.
class LiveSurface final {
 public:
  static constexpr float kLeastShare = 0.015F;
  static constexpr int kSettle = std::numeric_limits<int>::max();

  /// [setup] @param rest kept; may be open @param rounding as of SurfaceProfile::rounded_at
  /// @param least_share of the depth, at which the profile ends; below 0.9
  LiveSurface(geometry::TriangleMesh rest, const model::ReachParameters& reach, double rounding,
              float least_share = kLeastShare);
  ~LiveSurface();
  LiveSurface(const LiveSurface&) = delete;
  LiveSurface& operator=(const LiveSurface&) = delete;

  /// [setup] Moves the surface under these indentations and none else. For the picture's thread.
  /// @param steps that fronts may take now; kSettle: all they need, so that the result does not depend on
  /// what was before
  void update(std::span<const Indentation> indentations, int steps);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return rest_; }
  /// [any] Its vertices in single precision.
  [[nodiscard]] std::span<const Eigen::Vector3f> rest_vertices() const noexcept { return surface_.vertices; }
  [[nodiscard]] std::span<const Eigen::Vector3f> rest_normals() const noexcept { return rest_normals_; }
  [[nodiscard]] std::span<const LiveVertex> vertices() const noexcept { return vertices_; }
  /// [setup] Vertices that are not at rest.
  [[nodiscard]] std::vector<std::int32_t> moved() const;
  /// [any] Whether fronts are still on their way.
  [[nodiscard]] bool growing() const noexcept { return growing_; }

  /// A run of vertices.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// [setup] Runs that cover every vertex that changed since the last call.
  [[nodiscard]] const std::vector<Range>& take_changes();

  /// [setup] Runs that hold every vertex within `radius` [m] of the last update's indentation i.
  [[nodiscard]] const std::vector<Range>& near(std::size_t i, double radius);
  /// [any] Whether one is, along the surface, as far as is known.
  [[nodiscard]] bool is_near(std::size_t i, std::int32_t vertex, double radius) const noexcept;
  /// [any] A vertex to be moved further; counts as moved until the next update.
  LiveVertex& move(std::int32_t vertex);

 private:
  struct Contact;
  struct BlockState {
    bool moved = false;
    bool lowered = false;  // moved further, by move()
    bool changed = true;   // since the last take_changes()
    float off = 0.0F;      // how far a vertex may be from where it should be, at most [m]
  };
  void begin_frame();
  Contact& contact_for(const contact::SurfacePoint& place);
  void prepare(Contact& contact, const Indentation& indentation, const contact::SurfacePoint& place);
  int run_fronts(Contact& contact, int steps, bool settle);
  void lower_to_front(Contact& contact);
  void note_settled(Contact& contact);
  void note_change(Contact& contact);
  void find_changes();
  [[nodiscard]] float newly_off(std::size_t block);
  void move_blocks(bool settle);
  [[nodiscard]] Eigen::Vector3f normal_at(const contact::SurfacePoint& place) const;

  geometry::TriangleMesh rest_;
  TriangleGrid grid_;
  FrontSurface surface_;
  model::ReachParameters reach_;
  ProfileTable profile_;
  float least_share_;  // u/D
  float end_;          // r/R_6 where the profile ends
  std::vector<Eigen::Vector3f> rest_normals_;
  SurfaceBlocks blocks_;
  std::vector<LiveVertex> vertices_;
  std::vector<std::unique_ptr<Contact>> contacts_;
  std::vector<Contact*> now_;  // one an indentation; null: without depth
  std::uint64_t frame_ = 0;
  bool growing_ = false;
  std::vector<BlockState> state_;
  std::vector<Contact*> changing_;  // contacts that are there, or were a picture ago
  std::vector<NearChange> near_changes_;
  std::vector<Range> changes_;
  std::vector<Range> near_;
};

}  // namespace palpate::deform

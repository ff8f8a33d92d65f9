#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deform/field_change.h"
#include "core/deform/geodesic_front.h"
#include "core/deform/profile_table.h"
#include "core/deform/response_field.h"
#include "core/deform/surface_blocks.h"
#include "core/deform/triangle_search.h"
#include "palpate/surface.h"

namespace palpate::deform {

/// The displaced surface, by the rules of SurfaceDeformer, at a cost that grows with the vertices in reach
/// and not with the mesh. Positions and normals are kept between frames. Only vertices in reach of a contact,
/// now or in the last frame, are computed again, in blocks of 64; with an organ's response, all vertices are
/// in reach. A block is skipped while FieldChange, the changes of the response's nodes and NearFieldChange
/// bound the motion of its vertices by 0.045 mm, or by zero within 8 mm of a contact. So no vertex is off by
/// more than 0.05 mm. With kSettle all blocks are computed.
///
/// Geodesic distances come from a front that continues between frames. While a contact moves, a vertex's
/// distance is its straight distance from the contact plus the geodesic excess from the front's source; a new
/// front runs in the background. The profile is lowered so that it ends where the front ends, or at
/// `least_share` of the depth: kLeastShare, used for pictures, halves the vertices in reach. At the contact
/// the displacement stays D. Normals follow from the displacement's derivative, not from triangles.
class DeformedSurface final {
 public:
  static constexpr float kLeastShare = 0.015F;
  static constexpr int kSettle = std::numeric_limits<int>::max();

  /// [setup] @param rest is kept; may be open @param rounding as in DisplacementProfile::rounded_at
  /// @param least_share fraction of the depth at which the profile ends; below 0.9
  DeformedSurface(geometry::TriangleMesh rest, const model::FalloffRatios& reach, double rounding,
                  float least_share = kLeastShare);
  ~DeformedSurface();
  DeformedSurface(const DeformedSurface&) = delete;
  DeformedSurface& operator=(const DeformedSurface&) = delete;

  /// [setup] Moves the whole organ by its response from the next update() on; while something touches it,
  /// over kFadeUpdates updates. Null: the profile alone.
  void set_response(std::shared_ptr<const OrganResponse> response);

  /// [setup] Displaces the surface by these indentations only. For the rendering thread.
  /// @param steps largest number of vertices that fronts settle in this call; kSettle: no limit, so the
  /// result does not depend on earlier calls
  void update(std::span<const Indentation> indentations, int steps);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return rest_; }
  /// [any] The rest vertices in single precision.
  [[nodiscard]] std::span<const Eigen::Vector3f> rest_vertices() const noexcept { return surface_.vertices; }
  [[nodiscard]] std::span<const Eigen::Vector3f> rest_normals() const noexcept { return rest_normals_; }
  [[nodiscard]] std::span<const SurfaceVertex> vertices() const noexcept { return vertices_; }
  /// [setup] Vertices that are displaced.
  [[nodiscard]] std::vector<std::int32_t> moved() const;
  /// [any] Whether fronts still have to advance.
  [[nodiscard]] bool growing() const noexcept { return growing_; }
  /// Updates over which the profile gives way to a response that arrives during a contact.
  static constexpr int kFadeUpdates = 12;

  /// A range of vertices.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// [setup] Ranges with every vertex that changed since the last call.
  [[nodiscard]] const std::vector<Range>& take_changes();

  /// [setup] Ranges with every vertex within `radius` [m] of the last update's indentation i.
  [[nodiscard]] const std::vector<Range>& near(std::size_t i, double radius);
  /// [any] Whether a vertex is, along the surface, as far as the front has come.
  [[nodiscard]] bool is_near(std::size_t i, std::int32_t vertex, double radius) const noexcept;
  /// [any] Gives access to a vertex for a further displacement. Its block is computed again in the next
  /// update.
  SurfaceVertex& move(std::int32_t vertex);

 private:
  struct TrackedContact;
  struct BlockState {
    bool moved = false;
    bool lowered = false;  // displaced further by move()
    bool changed = true;   // since the last take_changes()
    float error = 0.0F;    // largest error of a vertex [m]
  };
  void begin_frame();
  // An indentation as it is drawn: its depth may be shared with others and is limited by the organ's
  // thickness.
  struct Drawn {
    contact::SurfacePoint place;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // of the rest surface, unit
    double depth = 0.0;                                // [m]; 0: nothing is drawn
    double local = 1.0;                                // share of the depth that the profile draws
  };
  [[nodiscard]] Drawn drawn_at(const Indentation& indentation, double share) const;
  TrackedContact& contact_for(const contact::SurfacePoint& place);
  void prepare(TrackedContact& contact, const Indentation& indentation, const Drawn& drawn);
  int run_fronts(TrackedContact& contact, int steps, bool settle);
  void lower_to_front(TrackedContact& contact);
  void update_least_distances(TrackedContact& contact);
  void update_change(TrackedContact& contact);
  void find_changes();
  [[nodiscard]] float added_error(std::size_t block);
  void move_blocks(bool settle);
  // Curvature of the rest surface [1/m], convex positive, within `radius` [m] of a point.
  [[nodiscard]] double curvature_at(const Vec3& point, const Vec3& inwards, double radius) const;
  void set_whole(std::span<const Indentation> indentations, std::span<Drawn> drawn, bool settle);
  // Bound of the motion of a block's vertices by the response [m]; infinity near a contact that changed.
  [[nodiscard]] float whole_change(std::size_t block) const;
  // @param at_rest the profile moves no vertex of the block
  void move_whole(std::size_t block, bool at_rest);
  [[nodiscard]] Eigen::Vector3f normal_at(const contact::SurfacePoint& place) const;

  geometry::TriangleMesh rest_;
  TriangleSearch search_;
  FrontSurface surface_;
  model::FalloffRatios reach_;
  ProfileTable profile_;
  float least_share_;  // u/D
  float end_;          // r/R_6 at which the profile ends
  std::vector<Eigen::Vector3f> rest_normals_;
  SurfaceBlocks blocks_;
  std::vector<SurfaceVertex> vertices_;
  std::vector<std::unique_ptr<TrackedContact>> contacts_;
  std::vector<TrackedContact*> now_;  // one per indentation; null: no depth
  std::uint64_t frame_ = 0;
  bool growing_ = false;
  std::vector<BlockState> state_;
  std::vector<TrackedContact*> changing_;  // contacts of this or the last frame
  std::vector<NearChange> near_changes_;
  std::vector<Range> changes_;
  std::vector<Range> near_;
  std::unique_ptr<ResponseField> whole_;  // null: the profile alone
  float whole_share_ = 1.0F;              // of the response
  // A node of the response, and the largest weight that it has for a vertex of a block.
  struct BlockNode {
    std::int32_t node = 0;
    float weight = 0.0F;
  };
  // Up to four vertices of a block in one piece of the response; the last one fills the other lanes.
  struct VertexGroup {
    Float4x3 within, place, normal;  // in the cell; at rest
    std::uint32_t piece = 0;
    std::array<std::uint32_t, kLanes> vertices{};
    std::size_t count = 0;
  };
  struct Member {
    std::uint32_t vertex = 0;
    ResponseField::Place place;
  };
  void gather_groups(std::size_t block);
  // @param members one to four, in one piece
  [[nodiscard]] VertexGroup group_of(std::span<const Member> members) const;
  std::vector<VertexGroup> groups_;
  std::vector<std::size_t> first_group_;  // per block: in groups_; one more at the end
  std::vector<BlockNode> block_nodes_;
  std::vector<std::size_t> first_node_;  // per block: in block_nodes_; one more at the end
};

}  // namespace palpate::deform

#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "palpate/deform/displacement.h"
#include "palpate/deform/geodesic_front.h"
#include "palpate/deform/triangle_grid.h"

namespace palpate::deform {

/// A vertex of a surface that moves, as the picture takes it. Organ frame.
struct LiveVertex {
  Eigen::Vector3f position;  // [m]
  Eigen::Vector3f normal;    // unit
  float moved = 0.0F;        // how far from its place at rest [m]; negative: inwards
};

/// The surface profile around contacts as a table, since every contact has the same up to scale: u(r)/D over
/// r/R_6 (model.md, section 3), and its slope.
class ProfileTable final {
 public:
  struct Value {
    float u = 0.0F;      // of D
    float slope = 0.0F;  // of D, over one R_6
  };
  /// [setup] @param rounding as of SurfaceProfile::rounded_at
  ProfileTable(const model::ReachParameters& reach, double rounding);
  /// [any] At r/R_6 >= 0; zero from end() on.
  [[nodiscard]] Value at(float y) const noexcept {
    const float place = y * per_entry_;
    const auto i = static_cast<std::size_t>(place);
    if (!(place >= 0.0F) || i + 1 >= values_.size()) return {};
    const float share = place - static_cast<float>(i);
    const Value& a = values_[i];
    const Value& b = values_[i + 1];
    return {a.u + share * (b.u - a.u), a.slope + share * (b.slope - a.slope)};
  }
  /// [any] r/R_6 from which u stays below `share` of D.
  [[nodiscard]] float where(float share) const noexcept;

 private:
  float per_entry_ = 1.0F;  // entries a unit of r/R_6
  std::vector<Value> values_;
};

/// SurfaceDeformer for moving pictures: the same rules, at a cost that grows with the vertices in reach and
/// not with the mesh. Vertices and normals are kept from frame to frame, and only those in reach of a
/// contact, now or a frame ago, are computed again.
///
/// Distances along the surface are found by a front that runs on from frame to frame. While a contact moves,
/// a vertex's distance is its straight distance from the contact as it is now, and what the way along the
/// surface was longer than that from where the front began; a new front runs behind. Where a front has not
/// come yet nothing moves, and the profile is lowered so that it ends there; likewise where it has fallen to
/// kLeastShare of the depth, which halves the vertices in reach. At the contact the depth stays D. Normals
/// follow from the displacement's derivative, not from triangles.
class LiveSurface final {
 public:
  static constexpr float kLeastShare = 0.015F;
  static constexpr int kSettle = std::numeric_limits<int>::max();

  /// [setup] @param rest kept; may be open @param rounding as of SurfaceProfile::rounded_at
  LiveSurface(geometry::TriangleMesh rest, const model::ReachParameters& reach, double rounding);
  ~LiveSurface();
  LiveSurface(const LiveSurface&) = delete;
  LiveSurface& operator=(const LiveSurface&) = delete;

  /// [setup] Moves the surface under these indentations and none else. For the picture's thread.
  /// @param steps that fronts may take now; kSettle: all they need, so that the result does not depend on
  /// what was before
  void update(std::span<const Indentation> indentations, int steps);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return rest_; }
  [[nodiscard]] std::span<const Eigen::Vector3f> rest_normals() const noexcept { return rest_normals_; }
  [[nodiscard]] std::span<const LiveVertex> vertices() const noexcept { return vertices_; }
  /// [any] Vertices that are not at rest.
  [[nodiscard]] std::span<const std::int32_t> moved() const noexcept { return moved_; }
  /// [any] Whether fronts are still on their way.
  [[nodiscard]] bool growing() const noexcept { return growing_; }

  /// [any] Vertices within about `radius` [m] along the surface of the last update's indentation i.
  [[nodiscard]] std::span<const std::int32_t> near(std::size_t i, double radius) const;
  /// [any] A vertex to be moved further; counts as moved until the next update.
  LiveVertex& move(std::int32_t vertex);

  /// A run of vertices.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// [setup] Runs that cover every vertex that changed since the last call.
  [[nodiscard]] const std::vector<Range>& take_changes();

 private:
  struct Contact;
  struct Sums;
  void begin_frame();
  Contact& contact_for(const SurfacePoint& place);
  void prepare(Contact& contact, const Indentation& indentation, const SurfacePoint& place);
  int run_fronts(Contact& contact, int steps, bool settle);
  void move_by(const Contact& contact);
  void add(const Contact& contact);
  void finish_sums();
  void mark(std::int32_t vertex);
  void mark_moved(std::int32_t vertex);
  [[nodiscard]] Eigen::Vector3f normal_at(const SurfacePoint& place) const;

  geometry::TriangleMesh rest_;
  TriangleGrid grid_;
  FrontSurface surface_;
  model::ReachParameters reach_;
  ProfileTable profile_;
  float end_;  // r/R_6 where the profile ends
  std::vector<Eigen::Vector3f> rest_normals_;
  std::vector<LiveVertex> vertices_;
  std::vector<std::int32_t> moved_;
  std::vector<char> is_moved_;
  std::vector<std::unique_ptr<Contact>> contacts_;
  std::vector<Contact*> now_;  // one an indentation; null: without depth
  std::vector<Sums> sums_;     // empty until contacts meet
  std::uint64_t frame_ = 0;
  bool growing_ = false;
  std::vector<char> changed_block_;
  std::vector<std::size_t> changed_blocks_;
  std::vector<Range> changes_;
};

}  // namespace palpate::deform

#pragma once
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/deform/deformed_surface.h"
#include "palpate/offscreen.h"
#include "palpate/tool.h"
#include "view/render/gl_objects.h"
#include "view/render/grasped_fold.h"
#include "view/render/tool_imprint.h"

namespace palpate::render {

/// Resolution of the displayed organ mesh.
enum class Detail {
  kStill,  // as fine as visible, finest around the contacts; a contact elsewhere refines the mesh again
  kLive,   // about 24,000 triangles, or as given; refined once
};

/// The displayed organ: smooth, refined and deformed.
class OrganPicture final {
 public:
  /// [setup] @param rest rest surface, organ frame, metres
  /// @param support what holds the organ: with it, the whole organ gives way. Its response is prepared in
  /// the background for Detail::kLive; until then, the surface near the contacts moves alone
  /// @param store for that response; null: none. Those of set_support() are not kept
  OrganPicture(const geometry::TriangleMesh& rest, const model::FalloffRatios& reach,
               Detail detail = Detail::kStill, const std::optional<geometry::Support>& support = {},
               const std::shared_ptr<const contact::OrganStore>& store = {});

  /// [setup] Updates the deformation for the current contacts. With Detail::kStill the result depends on this
  /// call only; with kLive the surface catches up within some pictures (DeformedSurface).
  /// @param imprints of the tools: the surface is lowered onto them @param folds of grasped tissue
  /// @return whether rest() and its triangles changed
  bool update(std::span<const deform::Indentation> indentations, std::span<const ToolImprint> imprints = {},
              std::span<const GraspedFold> folds = {});

  /// [setup] Changes what holds the organ: the profile shows until the new response, which is prepared in the
  /// background, is there; it then gives way over some pictures. @param support checked by
  /// geometry::check_support(); empty: the profile alone
  void set_support(std::optional<geometry::Support> support);
  [[nodiscard]] ResponseState response() const noexcept;

  /// [any] The refined rest surface. It passes within a few hundredths of an edge length of the given one.
  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return surface_->rest(); }
  /// [any] Current vertex positions and unit normals, organ frame. `moved` is negative where the surface is
  /// pressed inwards.
  [[nodiscard]] std::span<const deform::SurfaceVertex> vertices() const noexcept {
    return surface_->vertices();
  }
  /// [setup] Ranges of vertices that contain all changes since the last call.
  [[nodiscard]] const std::vector<deform::DeformedSurface::Range>& take_changes() {
    return surface_->take_changes();
  }

 private:
  void prepare(const geometry::Support& support, std::shared_ptr<const contact::OrganStore> store = {});
  bool divide_around(std::span<const deform::Indentation> indentations);
  void take_surface(geometry::TriangleMesh rest);
  void take_response();
  void lower_onto(const ToolImprint& imprint, std::span<const deform::Indentation> indentations);
  void raise_fold(const GraspedFold& fold, std::span<const deform::Indentation> indentations);
  void shift(std::int32_t vertex, const Eigen::Vector3f& direction, float by, const Eigen::Vector3f& slope);

  model::FalloffRatios reach_;
  Detail detail_;
  double crease_deg_;                                    // edges with a larger dihedral angle stay sharp
  std::shared_ptr<const geometry::TriangleMesh> organ_;  // as given; for responses
  geometry::TriangleMesh base_;
  std::vector<Vec3> centres_;  // where the surface is refined
  std::unique_ptr<deform::DeformedSurface> surface_;
  std::future<std::shared_ptr<const deform::OrganResponse>> awaited_;  // of kLive, until it is ready
  std::optional<geometry::Support> next_;  // prepared when the awaited one, which it replaces, is ready
  bool outdated_ = false;                  // the awaited response is of a support that was replaced
  bool failed_ = false;                    // too little is held
  std::shared_ptr<const deform::OrganResponse> response_;
};

/// Vertices that several triangles use, and the index of each triangle's corners.
struct IndexedCorners {
  std::vector<deform::SurfaceVertex> vertices;
  std::vector<std::uint32_t> corners;
};

/// [setup] Merges corners with exactly equal position and normal; keeps the order of the triangles.
[[nodiscard]] IndexedCorners indexed_corners(std::span<const deform::SurfaceVertex> corners);

/// An instrument for display: curved faces smoothed, sharp edges kept.
class ToolPicture final {
 public:
  /// [setup]
  explicit ToolPicture(const geometry::Tool& tool);

  [[nodiscard]] std::size_t parts() const noexcept { return parts_.size(); }
  /// [setup] Corners of a part's triangles (three per triangle), in the part's frame.
  [[nodiscard]] std::vector<deform::SurfaceVertex> corners(std::size_t part) const;
  /// [any] World pose of a part.
  [[nodiscard]] Pose part_pose(std::size_t part, const Pose& handle_W, double gripper) const;

 private:
  struct Part {
    geometry::ToolPart part;    // with its refined mesh
    std::vector<Vec3> normals;  // one per corner
  };
  std::vector<Part> parts_;
};

}  // namespace palpate::render

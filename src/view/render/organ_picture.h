#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/deform/live_surface.h"
#include "view/render/tool_imprint.h"

namespace palpate::render {

/// How finely an organ is divided for its picture.
enum class Detail {
  kStill,  // as finely as pays, finest around the contacts: a contact elsewhere divides it anew
  kLive,   // about 24,000 triangles or as given, once
};

/// The organ as it is drawn: smooth, finely divided, and deformed.
class OrganPicture final {
 public:
  /// [setup] @param rest organ frame, metres
  OrganPicture(const geometry::TriangleMesh& rest, const model::ReachParameters& reach,
               Detail detail = Detail::kStill);

  /// [setup] Takes new contacts. @return whether rest() and its triangles changed, too.
  /// @param imprints of the tools: the surface is lowered onto them
  /// A still picture depends on nothing before; a live one catches up within some pictures (LiveSurface).
  bool update(std::span<const deform::Indentation> indentations, std::span<const ToolImprint> imprints = {});

  /// [any] The finely divided rest surface. Passes within a few hundredths of an edge of the given one.
  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return surface_->rest(); }
  /// [any] Where its vertices are now, and the surface's unit normals there. Organ frame. `moved` is negative
  /// where the surface has gone inwards.
  [[nodiscard]] std::span<const deform::LiveVertex> vertices() const noexcept { return surface_->vertices(); }
  /// [setup] Runs of vertices that cover all that changed since the last call.
  [[nodiscard]] const std::vector<deform::LiveSurface::Range>& take_changes() {
    return surface_->take_changes();
  }

 private:
  bool divide_around(std::span<const deform::Indentation> indentations);
  void take_surface(geometry::TriangleMesh rest);
  void lower_onto(const ToolImprint& imprint, std::span<const deform::Indentation> indentations);

  model::ReachParameters reach_;
  Detail detail_;
  geometry::TriangleMesh base_;
  std::vector<Vec3> centres_;  // where the surface is finely divided
  std::unique_ptr<deform::LiveSurface> surface_;
};

}  // namespace palpate::render

#pragma once
#include <memory>
#include <span>
#include <vector>

#include "palpate/deform/displacement.h"
#include "palpate/render/tool_imprint.h"

namespace palpate::render {

/// The organ as it is drawn: smooth, finely divided, finest around the contacts, and deformed.
class OrganPicture final {
 public:
  /// [setup] @param rest organ frame, metres
  OrganPicture(const geometry::TriangleMesh& rest, const model::ReachParameters& reach);

  /// [setup] Takes new contacts. @return whether rest() and its triangles changed, too.
  /// @param imprints of the tools: the surface is lowered onto them
  bool update(std::span<const deform::Indentation> indentations, std::span<const ToolImprint> imprints = {});

  /// [any] The finely divided rest surface. Passes within a few hundredths of an edge of the given one.
  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return deformer_->rest(); }
  /// [any] Where its vertices are now, and the surface's unit normals there. Organ frame.
  [[nodiscard]] const std::vector<Vec3>& vertices() const noexcept { return vertices_; }
  [[nodiscard]] const std::vector<Vec3>& normals() const noexcept { return normals_; }

 private:
  bool divide_around(std::span<const deform::Indentation> indentations);

  model::ReachParameters reach_;
  geometry::TriangleMesh base_;
  std::vector<Vec3> centres_;  // where the surface is finely divided
  std::unique_ptr<deform::SurfaceDeformer> deformer_;
  std::vector<Vec3> rest_normals_;
  std::vector<Vec3> vertices_;
  std::vector<Vec3> normals_;
};

}  // namespace palpate::render

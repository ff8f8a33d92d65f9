#include "palpate/render/organ_picture.h"

#include <algorithm>
#include <limits>

#include "palpate/render/display_mesh.h"

namespace palpate::render {
namespace {

constexpr double kCreaseDeg = 50.0;
constexpr double kEdgesAcross = 120.0;    // edges along the organ's diagonal, before contact
constexpr double kShortestEdge = 0.8e-3;  // m, before contact
constexpr double kLongestEdge = 2.5e-3;   // m
constexpr double kEvenShare = 0.05;       // of the given mesh's mean edge: how far a vertex may be evened out
constexpr double kFineEdge = 0.6e-3;      // m, at contacts
constexpr double kFineRadius = 12e-3;     // m around a contact: finest
constexpr double kCoarsening = 0.08;      // m of edge a metre farther out
constexpr double kSameCentre = 4e-3;      // m: a contact this near to a finely divided place needs no other

constexpr double kRounding = 0.2;  // of the profile's corners; moves no vertex by over 4 % of the depth

}  // namespace

OrganPicture::OrganPicture(const geometry::TriangleMesh& rest, const model::ReachParameters& reach)
    : reach_(reach) {
  const double edge =
      std::clamp(geometry::bounds(rest).size().norm() / kEdgesAcross, kShortestEdge, kLongestEdge);
  const RefineRule rule{kCreaseDeg, [edge](const Vec3&, double length, double) { return length > edge; }};
  base_ = refine_smoothly(rest, rule);
  even_out(base_, kEvenShare * mean_edge(rest), kCreaseDeg);
  deformer_ = std::make_unique<deform::SurfaceDeformer>(base_);
  update({});
}

bool OrganPicture::divide_around(std::span<const deform::Indentation> indentations) {
  const auto divided = [this](const deform::Indentation& i) {
    return std::any_of(centres_.begin(), centres_.end(),
                       [&i](const Vec3& c) { return (c - i.point).norm() < kSameCentre; });
  };
  if (std::all_of(indentations.begin(), indentations.end(), divided)) return false;
  centres_.clear();
  for (const deform::Indentation& i : indentations) {
    if (!divided(i)) centres_.push_back(i.point);
  }
  const RefineRule rule{kCreaseDeg, [this](const Vec3& middle, double length, double) {
                          double nearest = std::numeric_limits<double>::infinity();
                          for (const Vec3& c : centres_) nearest = std::min(nearest, (middle - c).norm());
                          return length > kFineEdge + kCoarsening * std::max(0.0, nearest - kFineRadius);
                        }};
  deformer_ = std::make_unique<deform::SurfaceDeformer>(refine_smoothly(base_, rule));
  return true;
}

bool OrganPicture::update(std::span<const deform::Indentation> indentations,
                          std::span<const ToolImprint> imprints) {
  const bool changed = divide_around(indentations);
  if (changed || rest_normals_.empty()) rest_normals_ = vertex_normals(rest().vertices, rest().triangles);
  deformer_->deform(reach_, indentations, vertices_, kRounding);
  for (const ToolImprint& imprint : imprints) {
    for (std::size_t v = 0; v < vertices_.size(); ++v)
      vertices_[v] +=
          imprint.lowering(vertices_[v], rest().vertices[v], rest_normals_[v]) * imprint.direction();
  }
  normals_ = vertex_normals(vertices_, rest().triangles);
  return changed;
}

}  // namespace palpate::render

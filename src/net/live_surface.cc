#include "net/live_surface.h"

#include <cmath>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "net/live_protocol.h"
#include "palpate/units.h"

namespace palpate::net {
namespace {

using Json = nlohmann::ordered_json;

const geometry::TriangleMesh& checked(const geometry::TriangleMesh& organ) {
  if (organ.triangles.size() <= LiveSurface::kMaxTriangles) return organ;
  throw LiveError("refused",
                  fmt::format("surface: the organ has {} triangles, must have at most {} to be sent",
                              organ.triangles.size(), LiveSurface::kMaxTriangles));
}

void append(Json& list, const Vec3& point) {
  constexpr double kSteps = 1000.0;  // steps per millimetre
  for (int axis = 0; axis < 3; ++axis) {
    list.push_back(std::round(point[axis] / kMillimetre * kSteps) / kSteps);
  }
}

}  // namespace

LiveSurface::LiveSurface(const geometry::TriangleMesh& organ) : deformer_(checked(organ)) {}

Json LiveSurface::at_rest() const {
  Json vertices = Json::array();
  Json triangles = Json::array();
  for (const Vec3& vertex : deformer_.rest().vertices) append(vertices, vertex);
  for (const auto& triangle : deformer_.rest().triangles) {
    for (const auto corner : triangle) triangles.push_back(corner);
  }
  return {{"vertices_mm", vertices}, {"triangles", triangles}};
}

Json LiveSurface::moved(const model::FalloffRatios& reach,
                        const std::vector<deform::Indentation>& indentations) {
  deformer_.deform(reach, indentations, vertices_);
  Json moved = Json::array();
  Json vertices = Json::array();
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (vertices_[i] == deformer_.rest().vertices[i]) continue;
    moved.push_back(i);
    append(vertices, vertices_[i]);
  }
  return {{"moved", moved}, {"vertices_mm", vertices}};
}

}  // namespace palpate::net

// FCL: distance between the meshes of tool and organ.
#include <algorithm>
#include <limits>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

#include "bench/peers/peer_list.h"

namespace palpate::bench::peers {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

struct Scene {
  std::shared_ptr<Model> organ;
  std::vector<std::shared_ptr<Model>> parts;
};

std::shared_ptr<Model> model_of(const PalpatePeerMesh& mesh) {
  auto model = std::make_shared<Model>();
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (size_t v = 0; v < mesh.vertex_count; ++v)
    vertices.emplace_back(mesh.vertices[3 * v], mesh.vertices[3 * v + 1], mesh.vertices[3 * v + 2]);
  for (size_t t = 0; t < mesh.triangle_count; ++t) {
    triangles.emplace_back(static_cast<size_t>(mesh.triangles[3 * t]),
                           static_cast<size_t>(mesh.triangles[3 * t + 1]),
                           static_cast<size_t>(mesh.triangles[3 * t + 2]));
  }
  if (model->beginModel() != fcl::BVH_OK || model->addSubModel(vertices, triangles) != fcl::BVH_OK ||
      model->endModel() != fcl::BVH_OK) {
    return nullptr;
  }
  return model;
}

void* open_scene(const PalpatePeerMesh* organ, const PalpatePeerMesh* parts, size_t part_count) {
  auto scene = std::make_unique<Scene>();
  scene->organ = model_of(*organ);
  bool good = scene->organ != nullptr;
  for (size_t part = 0; part < part_count; ++part) {
    scene->parts.push_back(model_of(parts[part]));
    good = good && scene->parts.back() != nullptr;
  }
  return good ? scene.release() : nullptr;
}

double ask(void* opened, const double* poses, const double* /*point*/) {
  const auto* scene = static_cast<const Scene*>(opened);
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  double least = std::numeric_limits<double>::infinity();
  for (size_t part = 0; part < scene->parts.size(); ++part) {
    const double* pose = poses + 7 * part;
    fcl::Transform3d at = fcl::Transform3d::Identity();
    at.linear() = fcl::Quaterniond(pose[3], pose[4], pose[5], pose[6]).toRotationMatrix();
    at.translation() = fcl::Vector3d(pose[0], pose[1], pose[2]);
    const fcl::DistanceRequestd request(true);  // with nearest points
    fcl::DistanceResultd result;
    least = std::min(least,
                     fcl::distance(scene->parts[part].get(), at, scene->organ.get(), still, request, result));
  }
  return least;
}

void close_scene(void* opened) { delete static_cast<Scene*>(opened); }

}  // namespace

PalpatePeer fcl() { return {"FCL", "mesh-mesh distance, no force", 0, 0, open_scene, ask, close_scene}; }

}  // namespace palpate::bench::peers

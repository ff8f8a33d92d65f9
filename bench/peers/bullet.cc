// Bullet: one 1 ms step with the organ as a soft body and the tool's parts as moving convex bodies.
#include <limits>
#include <vector>

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "bench/peers/peer_list.h"

namespace palpate::bench::peers {
namespace {

// Bullet is designed for bodies of about a metre, so the scene is scaled by ten.
constexpr double kScale = 10.0;
constexpr btScalar kMargin = 0.005F;     // 0.5 mm
constexpr btScalar kVoxel = 0.05F;       // 5 mm; the default of 25 mm would miss a jaw, a finer one is slower
constexpr btScalar kStiffness = 0.5F;    // of the links, 0..1
constexpr btScalar kMass = 0.1F;         // kg
constexpr btScalar kPinnedShare = 0.3F;  // lower part of the organ that is fixed, as a fraction of its height
constexpr btScalar kStep = 1e-3F;        // s

btVector3 scaled(const double* p) {
  return {static_cast<btScalar>(kScale * p[0]), static_cast<btScalar>(kScale * p[1]),
          static_cast<btScalar>(kScale * p[2])};
}

struct Scene {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btConvexHullShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> parts;
  std::unique_ptr<btSoftBody> organ;

  Scene() = default;
  ~Scene() {
    for (const auto& part : parts) world.removeRigidBody(part.get());
    if (organ) world.removeSoftBody(organ.get());
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
};

/// Nodes, links along edges, and faces, as CreateFromTriMesh makes them, but without its quadratic cost.
std::unique_ptr<btSoftBody> soft_body(btSoftBodyWorldInfo& info, const PalpatePeerMesh& mesh) {
  std::vector<btVector3> nodes;
  for (size_t v = 0; v < mesh.vertex_count; ++v) nodes.push_back(scaled(mesh.vertices + 3 * v));
  const std::vector<btScalar> masses(nodes.size(), 1.0F);
  auto body =
      std::make_unique<btSoftBody>(&info, static_cast<int>(nodes.size()), nodes.data(), masses.data());
  for (size_t t = 0; t < mesh.triangle_count; ++t) {
    const int32_t* corner = mesh.triangles + 3 * t;
    for (int e = 0; e < 3; ++e) {  // in a closed surface each edge occurs once in each direction
      if (corner[e] < corner[(e + 1) % 3]) body->appendLink(corner[e], corner[(e + 1) % 3]);
    }
    body->appendFace(corner[0], corner[1], corner[2]);
  }
  body->randomizeConstraints();
  return body;
}

void add_organ(Scene& scene, const PalpatePeerMesh& mesh) {
  scene.organ = soft_body(scene.world.getWorldInfo(), mesh);
  btSoftBody& organ = *scene.organ;
  organ.m_materials[0]->m_kLST = kStiffness;
  organ.m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
  organ.getCollisionShape()->setMargin(kMargin);
  organ.setTotalMass(kMass, true);
  btVector3 low;
  btVector3 high;
  organ.getAabb(low, high);
  const btScalar pinned = low.z() + kPinnedShare * (high.z() - low.z());
  for (int i = 0; i < organ.m_nodes.size(); ++i) {
    if (organ.m_nodes[i].m_x.z() < pinned) organ.setMass(i, 0.0F);
  }
  scene.world.addSoftBody(&organ);
}

void add_part(Scene& scene, const PalpatePeerMesh& mesh) {
  auto shape = std::make_unique<btConvexHullShape>();
  for (size_t v = 0; v < mesh.vertex_count; ++v) shape->addPoint(scaled(mesh.vertices + 3 * v), false);
  shape->setMargin(kMargin);
  shape->recalcLocalAabb();
  auto body = std::make_unique<btRigidBody>(
      btRigidBody::btRigidBodyConstructionInfo(0.0F, nullptr, shape.get(), btVector3(0, 0, 0)));
  body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  body->setActivationState(DISABLE_DEACTIVATION);
  scene.world.addRigidBody(body.get());
  scene.shapes.push_back(std::move(shape));
  scene.parts.push_back(std::move(body));
}

void* open_scene(const PalpatePeerMesh* organ, const PalpatePeerMesh* parts, size_t part_count) {
  auto scene = std::make_unique<Scene>();
  scene->world.setGravity(btVector3(0, 0, 0));
  btSoftBodyWorldInfo& info = scene->world.getWorldInfo();
  info.m_gravity.setValue(0, 0, 0);
  info.m_sparsesdf.Initialize();
  info.m_sparsesdf.setDefaultVoxelsz(kVoxel);
  info.m_sparsesdf.Reset();  // applies the size
  add_organ(*scene, *organ);
  for (size_t part = 0; part < part_count; ++part) add_part(*scene, parts[part]);
  return scene.release();
}

double ask(void* opened, const double* poses, const double* /*point*/) {
  auto* scene = static_cast<Scene*>(opened);
  for (size_t part = 0; part < scene->parts.size(); ++part) {
    const double* pose = poses + 7 * part;
    const btQuaternion rotation(static_cast<btScalar>(pose[4]), static_cast<btScalar>(pose[5]),
                                static_cast<btScalar>(pose[6]), static_cast<btScalar>(pose[3]));
    const btTransform at(rotation, scaled(pose));
    scene->parts[part]->setWorldTransform(at);
    scene->parts[part]->setInterpolationWorldTransform(at);
  }
  scene->world.stepSimulation(kStep, 0);
  const bool touching = scene->organ->m_rcontacts.size() > 0;
  return touching ? 0.0 : std::numeric_limits<double>::quiet_NaN();
}

void close_scene(void* opened) { delete static_cast<Scene*>(opened); }

}  // namespace

PalpatePeer bullet() { return {"Bullet", "soft body, one 1 ms step", 0, 1, open_scene, ask, close_scene}; }

}  // namespace palpate::bench::peers

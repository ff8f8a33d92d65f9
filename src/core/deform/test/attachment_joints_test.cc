#include "core/deform/attachment_joints.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/deform/body_compliance.h"
#include "core/deform/organ_response.h"
#include "palpate/mesh.h"

namespace palpate::deform {
namespace {

// A block of 80 x 60 x 60 mm from the origin along x, on a square neck of 30 mm along -x.
constexpr double kNeck = 0.03;
constexpr double kBlock = 0.08;
constexpr double kBlockWidth = 0.06;
geometry::TriangleMesh block_on_a_neck(double thickness) {
  constexpr double kStep = 2.5e-3;
  geometry::TriangleMesh mesh = geometry::make_box(Vec3(kNeck + kBlock, thickness, thickness), kStep);
  for (Vec3& v : mesh.vertices) {
    v.x() += 0.5 * (kBlock - kNeck);
    if (v.x() < 0.5 * kStep) continue;
    v.x() -= 0.96 * kStep * (1.0 - v.x() / kBlock);  // the first step of the block is nearly flat
    v.tail<2>() *= kBlockWidth / thickness;
  }
  return mesh;
}

// Motion of the block's far end along a unit force across the neck, whose end is held.
double sway_of_block(double thickness, const Eigen::Matrix3d& turn) {
  geometry::TriangleMesh mesh = block_on_a_neck(thickness);
  for (Vec3& v : mesh.vertices) v = turn * v;
  geometry::Support support;
  support.attachments.push_back({turn * Vec3(-kNeck, 0.0, 0.0), 0.5 * thickness});
  const OrganResponse response(mesh, support);
  const OrganResponse::Load end =
      response.load_at(turn * Vec3(kBlock, 0.0, 0.0), turn * Vec3::UnitX(), kBlockWidth);
  const std::array<OrganResponse::Displacements, 3> under = response.under(end);
  const Eigen::Vector3f force = (turn * Vec3::UnitZ()).cast<float>();
  OrganResponse::Displacements field = response.none();
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < field.size(); ++n)
      field[n] += force[static_cast<Eigen::Index>(axis)] * under[axis][n];
  return response.work(end, force, field);
}

TEST(AttachmentJoints, ABlockOnANeckThinnerThanItsCellsSwaysLikeARigidBodyOnABeam) {
  for (const auto& [thickness, angle] :
       {std::pair(10e-3, 1.0), std::pair(12e-3, 1.0), std::pair(16e-3, 0.5)}) {
    // Timoshenko's beam, and a rigid disc with its second moment of area that turns on a half-space.
    const double inertia = std::pow(thickness, 4) / 12.0;
    const double shear = 5.0 / 6.0 * thickness * thickness / (2.0 * (1.0 + 0.45));
    const double radius = std::pow(4.0 * inertia / std::numbers::pi, 0.25);
    const double root = 3.0 * (1.0 - 0.45 * 0.45) / (4.0 * std::pow(radius, 3));
    const double beam = (std::pow(kNeck + kBlock, 3) - std::pow(kBlock, 3)) / (3.0 * inertia) +
                        kNeck / shear + kBlock * kBlock * root;
    const Vec3 axis = Vec3(0.3, 0.9, 0.4).normalized();
    EXPECT_NEAR(sway_of_block(thickness, Eigen::AngleAxisd(angle, axis).toRotationMatrix()) / beam, 1.0, 0.05)
        << thickness << ", turned by " << angle;
  }
}

TEST(AttachmentJoints, AreSofterWhereAnOrganHangsOnANeckAloneAndNowhereInACube) {
  geometry::Support support;
  support.attachments.push_back({Vec3(-kNeck, 0.0, 0.0), 6e-3});
  geometry::TriangleMesh block = block_on_a_neck(12e-3);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.0, Vec3(0.3, 0.9, 0.4).normalized()).toRotationMatrix();
  for (Vec3& v : block.vertices) v = turn * v;
  support.attachments[0].point = turn * support.attachments[0].point;
  const CellPieces pieces = finest_pieces(block);
  const Softening softening = softened_joints(pieces, block, support);
  ASSERT_FALSE(softening.empty());
  EXPECT_EQ(softening.forces.size(), 3 * pieces.nodes() * softening.shares.size());
  for (const double share : softening.shares) {
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0);
  }
  support.bed = geometry::Bed{Vec3::UnitX(), 0.3};
  EXPECT_TRUE(softened_joints(pieces, block, support).empty());
  support.bed.reset();
  support.faces = geometry::HeldFaces{Vec3::UnitZ()};
  EXPECT_TRUE(softened_joints(pieces, block, support).empty());
  support.faces.reset();
  const geometry::TriangleMesh cube = geometry::make_box(Vec3::Constant(0.12), 4e-3);
  support.attachments[0] = {Vec3(0.0, 0.0, -0.06), 0.02};
  EXPECT_TRUE(softened_joints(finest_pieces(cube), cube, support).empty());
}

}  // namespace
}  // namespace palpate::deform

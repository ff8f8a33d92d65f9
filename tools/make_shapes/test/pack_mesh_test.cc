#include "tools/make_shapes/pack_mesh.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "io/shapes/mesh_archive.h"
#include "io/shapes/test/shape_checks.h"
#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

TriangleMesh unpacked(const std::string& archive, const std::string& name) {
  return unpack_mesh({reinterpret_cast<const unsigned char*>(archive.data()), archive.size()}, name);
}

/// A square rod bent to a ring: genus 1.
TriangleMesh ring() {
  TriangleMesh mesh;
  constexpr std::int32_t kAround = 8;
  const auto corner = [](std::int32_t i, std::int32_t k) { return 4 * (i % kAround) + k % 4; };
  for (std::int32_t i = 0; i < kAround; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / kAround;
    for (const auto& [out, up] : {std::pair{0.02, 0.0}, {0.03, 0.0}, {0.03, 0.01}, {0.02, 0.01}}) {
      mesh.vertices.emplace_back(out * std::cos(angle), out * std::sin(angle), up);
    }
    for (std::int32_t k = 0; k < 4; ++k) {
      mesh.triangles.push_back({corner(i, k), corner(i + 1, k), corner(i + 1, k + 1)});
      mesh.triangles.push_back({corner(i, k), corner(i + 1, k + 1), corner(i, k + 1)});
    }
  }
  return mesh;
}

TEST(PackMesh, ExactMeshComesBackBitByBit) {
  std::string archive;
  pack_mesh(archive, "ball", make_ball(0.0123, 80), {});
  pack_mesh(archive, "ring", ring(), {});
  EXPECT_EQ(unpacked(archive, "ball").vertices, make_ball(0.0123, 80).vertices);
  EXPECT_EQ(unpacked(archive, "ring").triangles, ring().triangles);
}

TEST(PackMesh, MeshOnAGridKeepsItsShapeAndItsHandles) {
  std::string archive;
  pack_mesh(archive, "ring", ring(), {.grid = 19});  // which checks the distance of each vertex
  const TriangleMesh back = unpacked(archive, "ring");
  EXPECT_EQ(back.triangles.size(), ring().triangles.size());
  EXPECT_TRUE(test::is_closed(back));
  EXPECT_EQ(test::euler(back), 0);
  EXPECT_NEAR(signed_volume(back), signed_volume(ring()), 1e-9);
}

TEST(PackMesh, DivisionsMultiplyTheTrianglesByFour) {
  std::string archive;
  pack_mesh(archive, "ball", make_ball(0.03, 80), {.grid = 19, .divisions = 2});
  EXPECT_EQ(unpacked(archive, "ball").triangles.size(), 1280U);
}

TEST(PackMesh, MeshInTwoPiecesIsRefusedOnAGrid) {
  TriangleMesh two = make_ball(0.01, 20);
  const auto first = static_cast<std::int32_t>(two.vertices.size());
  for (const Triangle& t : make_ball(0.01, 20).triangles) {
    two.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  for (const Vec3& v : make_ball(0.01, 20).vertices) two.vertices.emplace_back(v + Vec3(0.05, 0.0, 0.0));
  std::string archive;
  EXPECT_THROW(pack_mesh(archive, "two", two, {.grid = 19}), InputError);
}

TEST(PackMesh, NameThatIsNotInTheArchiveIsRefused) {
  std::string archive;
  pack_mesh(archive, "ball", make_ball(0.03, 20), {});
  EXPECT_THROW((void)unpacked(archive, "bal"), std::runtime_error);
}

}  // namespace
}  // namespace palpate::geometry

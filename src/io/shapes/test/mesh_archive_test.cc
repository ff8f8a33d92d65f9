#include "io/shapes/mesh_archive.h"

#include <cstddef>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/base/content_hash.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/tool.h"

namespace palpate::geometry {
namespace {

// The golden hashes and the cache keys of prepared organs depend on every bit of the built-in meshes.
TEST(MeshArchive, GivesTheMeshesWhoseHashesTheMaintainersToolWrote) {
  std::ifstream list(PALPATE_SHAPES_LIST);
  std::string name;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::string hash;
  int meshes = 0;
  while (list >> name >> vertices >> triangles >> hash) {
    SCOPED_TRACE(name);
    ++meshes;
    const TriangleMesh mesh = unpack_mesh(built_in_meshes(), name);
    EXPECT_EQ(mesh.vertices.size(), vertices);
    EXPECT_EQ(mesh.triangles.size(), triangles);
    ContentHasher hasher;
    hasher.add(std::span(mesh.vertices)).add(std::span(mesh.triangles));
    EXPECT_EQ(hasher.hash().hexadecimal(), hash);
  }
  EXPECT_EQ(meshes, 27);  // four organs, four jaws and a shaft, each at three resolutions
}

TEST(MeshArchive, NameThatItDoesNotHaveIsRefused) {
  EXPECT_THROW((void)unpack_mesh(built_in_meshes(), "hear"), std::runtime_error);
}

TEST(MeshArchive, EveryNamedOrganAndToolIsReadWithItsParts) {
  for (const std::string& name : builtin_organ_names())
    EXPECT_FALSE(make_organ(name).triangles.empty()) << name;
  for (const std::string& name : builtin_tool_names()) {
    for (const ToolPart& part : make_tool(name).parts) EXPECT_FALSE(part.mesh.triangles.empty()) << name;
  }
}

}  // namespace
}  // namespace palpate::geometry

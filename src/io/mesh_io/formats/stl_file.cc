#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/scan.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kTriangle = 50;

/// Makes a triangle of each three corners.
ImportedMesh as_triangles(std::vector<Vec3> corners) {
  ImportedMesh imported;
  imported.mesh.vertices = std::move(corners);
  imported.mesh.triangles.reserve(imported.mesh.vertices.size() / 3);
  for (std::size_t n = 0; n + 2 < imported.mesh.vertices.size(); n += 3) {
    const auto first = static_cast<std::int32_t>(n);
    imported.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return imported;
}

/// Whether the first word that is not in a comment is "solid", in letters of either case.
bool begins_with_solid(const MeshFile& file) {
  for (MeshScan scan(file); scan.next_line();) {
    const std::string word = upper(scan.word());
    const bool is_comment = word.starts_with('#') || word.starts_with(';') || word.starts_with("//");
    if (!word.empty() && !is_comment) return word == "SOLID";
  }
  return false;
}

ImportedMesh read_text(const MeshFile& file) {
  MeshScan scan(file);
  std::vector<Vec3> corners;
  std::size_t facets = 0;
  std::size_t closed_facets = 0;
  bool ends = false;
  while (scan.next_line()) {
    const std::string word = upper(scan.word());
    if (word == "VERTEX") corners.push_back(scan.point(NumberType::kFloat, corners.size() + 1));
    facets += word == "FACET" ? 1 : 0;
    closed_facets += word == "ENDFACET" ? 1 : 0;
    if (!word.empty()) ends = word == "ENDSOLID";
  }
  if (closed_facets != facets || (facets > 0 && !ends)) {
    scan.refuse(fmt::format("truncated: a text STL of {} facets begun, {} ended{}", facets, closed_facets,
                            ends ? "" : ", and no endsolid at the end"));
  }
  if (corners.size() != 3 * facets) {
    scan.refuse(
        fmt::format("a text STL of {} facets has {} vertices: must be three each", facets, corners.size()));
  }
  return as_triangles(std::move(corners));
}

ImportedMesh read_binary(const MeshFile& file, std::size_t triangles) {
  MeshScan scan(file);
  scan.set_encoding(MeshScan::Encoding::kLittleEndian);
  scan.go_to(kHeader);
  std::vector<Vec3> corners;
  corners.reserve(3 * triangles);
  for (std::size_t n = 0; n < triangles; ++n) {
    scan.skip_bytes(12);  // its normal
    for (int k = 0; k < 3; ++k) corners.push_back(scan.point(NumberType::kFloat, corners.size() + 1));
    scan.skip_bytes(2);  // attributes
  }
  return as_triangles(std::move(corners));
}

}  // namespace

/// A file is binary if its size matches, since many binary files start with "solid"; then the first word
/// decides.
ImportedMesh read_stl(const MeshFile& file) {
  const std::string& bytes = file.bytes;
  const std::size_t declared = bytes.size() >= kHeader ? little_endian_32(bytes, 80) : 0;
  if (bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * declared) {
    return read_binary(file, declared);
  }
  const bool is_text = bytes.find('\0') == std::string::npos;
  if (is_text && begins_with_solid(file)) return read_text(file);
  constexpr const char* kOfText = "; a text STL begins with \"solid\" and has no zero bytes";
  if (bytes.size() < kHeader) {
    throw InputError(fmt::format("{}: truncated: a binary STL has at least 84 bytes, this has {}{}",
                                 to_text(file.path), bytes.size(), kOfText));
  }
  if (is_text) {
    throw InputError(
        fmt::format("{}: no STL: a binary one has zero bytes, this has none{}", to_text(file.path), kOfText));
  }
  throw InputError(
      fmt::format("{}: truncated or damaged: a binary STL of {} triangles has {} bytes, this has {}{}",
                  to_text(file.path), declared, kHeader + kTriangle * declared, bytes.size(),
                  begins_with_solid(file) ? kOfText : ""));
}

}  // namespace palpate::mesh_io

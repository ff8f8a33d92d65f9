#include <string>

#include <gtest/gtest.h>

#include "io/mesh_io/mesh_file.h"

namespace palpate::mesh_io {
namespace {

/// A binary STL of no triangles with this title.
std::string empty_stl(std::string title) {
  title.resize(80, ' ');
  return title + std::string(4, '\0');
}

TEST(DeclaredSpace, IsReadFromTheHeaderThat3DSlicerWrites) {
  const std::string title = "Visualization Toolkit generated SLA File. SPACE=LPS";
  EXPECT_EQ(declared_space({"a.stl", MeshFormat::kStl, empty_stl(title)}), "LPS");
  EXPECT_EQ(declared_space({"a.stl", MeshFormat::kStl, empty_stl(title + std::string(29, '\0'))}), "LPS");
  EXPECT_EQ(declared_space({"a.stl", MeshFormat::kStl, "solid " + title + "\nfacet normal 0 0 1\n"}), "LPS");
  EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# 3D Slicer output. SPACE=RAS\nv 0 0 0\n"}), "RAS");
  EXPECT_EQ(declared_space({"a.ply", MeshFormat::kPly, "ply\ncomment SPACE=lps\nend_header\n"}), "LPS");
  EXPECT_EQ(
      declared_space({"a.vtk", MeshFormat::kVtk,
                      "# vtk DataFile Version 4.2\n3D Slicer output. SPACE=LPS\nASCII\nPOINTS 3 float\n"}),
      "LPS");
}

TEST(DeclaredSpace, IsReadAsOtherProgramsWriteIt) {
  for (const std::string line : {"space=LPS", "SPACE = lps", "Space: LPS", "space: left-posterior-superior",
                                 "CoordinateSystem = LPS", "coordinate system: LPS, in mm"}) {
    EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# " + line + "\nv 0 0 0\n"}), "LPS") << line;
    EXPECT_EQ(declared_space({"a.stl", MeshFormat::kStl, empty_stl(line)}), "LPS") << line;
  }
  EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# space: right-anterior-superior\nv 0 0 0\n"}),
            "RAS");
  for (const std::string line : {"space: lpsx", "color space: sRGB", "space LPS", "coordinate system", "LPS"})
    EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# " + line + "\nv 0 0 0\n"}), "") << line;
}

TEST(DeclaredSpace, IsEmptyWithoutADeclarationBeforeTheCoordinates) {
  EXPECT_EQ(declared_space({"a.stl", MeshFormat::kStl, empty_stl("test")}), "");
  EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "v 0 0 0\nv 1 0 0\n# SPACE=LPS\n"}), "");
  EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# COLORSPACE=SRGB\nv 0 0 0\n"}), "");
  EXPECT_EQ(declared_space({"a.obj", MeshFormat::kObj, "# COLOR_SPACE=SRGB SPACE=LPS\nv 0 0 0\n"}), "LPS");
}

TEST(DeclaredSpace, IsReadFromTheFieldDataOfAVtkFile) {
  const std::string head = "# vtk DataFile Version 5.1\nvtk output\n";
  const std::string data = "\nDATASET POLYDATA\nFIELD FieldData 1\nSPACE 1 1 string\n";
  EXPECT_EQ(declared_space({"a.vtk", MeshFormat::kVtk, head + "ASCII" + data + "LPS\nPOINTS 0 float\n"}),
            "LPS");
  EXPECT_EQ(declared_space({"a.vtk", MeshFormat::kVtk, head + "BINARY" + data + "\xC3RAS\nPOINTS 0 float\n"}),
            "RAS");
  EXPECT_EQ(declared_space({"a.vtk", MeshFormat::kVtk, head + "ASCII" + data}), "");
}

}  // namespace
}  // namespace palpate::mesh_io

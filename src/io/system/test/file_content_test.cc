#include "io/system/file_content.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/input_file.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

using palpate::test::TemporaryFolder;
using testing::HasSubstr;
using testing::ThrowsMessage;

ContentFacts content(const std::string& bytes) {
  const TemporaryFolder folder;
  return find_content(folder.write("file", bytes));
}

std::string binary_stl() {
  std::string bytes(84 + 50, '\1');
  bytes.replace(80, 4, std::string("\1\0\0\0", 4));
  return bytes;
}

TEST(FileContent, IsFoundByTheFirstBytesWhateverTheName) {
  const std::pair<std::string, const char*> known[] = {
      {"\x89HDF\r\n\x1a\n more", "a recording (HDF5)"},
      {"\x89PNG\r\n", "a PNG picture"},
      {"\xff\xd8\xff\xe0", "a JPEG picture"},
      {std::string("II*\0\x08\0\0\0", 8), "a TIFF picture"},
      {std::string("MM\0*\0\0\0\x08", 8) + std::string(20'000, '\0'), "a TIFF picture"},
      {std::string("MM\x10\0\0\0", 6) + std::string(10, '\0'), "a mesh (3DS)"},
      {"MATLAB 5.0 MAT-file, Platform: PCWIN64", "a MATLAB file"},
      {"\x93NUMPY\x01", "a NumPy file"},
      {"#ROSBAG V2.0\n", "a ROS bag"},
      {"version https://git-lfs.github.com/spec/v1\n", "a pointer of Git LFS"},
      {"PK\x03\x04 sheet", "a ZIP archive or an Office document"},
      {"<!DOCTYPE html>\n<html>", "an HTML page, such as a report"},
      {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", "an XML file of VTK"},
      {"ply\nformat ascii 1.0\n", "a mesh (PLY)"},
      {"OFF\n4 4 6\n", "a mesh (OFF)"},
      {"# vtk DataFile Version 5.1\n", "a mesh (legacy VTK)"},
      {"\xEF\xBB\xBFsolid a\nfacet normal 0 0 1\n", "a mesh (text STL)"},
      {binary_stl(), "a mesh (binary STL)"},
      {"{\"asset\":{\"version\":\"2.0\"},\"meshes\":[]}", "a mesh (glTF)"},
      {"{\"ticks\": 3}", "a JSON document"},
      {"# by hand\no a\nv 0 0 0\nv 1 0 0\nf 1 2 3\n", "a mesh (OBJ)"},
      {std::string(128, '\0') + "DICM\2\0", "a DICOM image"},
      {"# mine\n[tissue]\nname = \"a\"\n", "a tissue file"},
      {"[scene]\nname = \"a\"\n[organ]\ntissue = \"b\"\n", "a scene"},
      {"[[tool]]\nmesh = \"a\"\n", "a scene"},
      {"[study]\nname = \"a\"\n", "a study file"},
      {"# made by hand\n\"time_s\";\"x_m\";\"y_m\";\"z_m\"\n0;0;0;0\n", "a tool path (CSV)"},
      {"displacement_mm,force_N\n0,0\n", "a measured curve (CSV)"},
      {"tick,time_s,hand,phase,depth_m\n0,0,0,approach,0\n", "the ticks of a recording as CSV"}};
  for (const auto& [bytes, name] : known) EXPECT_EQ(content(bytes).name, name) << bytes.substr(0, 40);
}

TEST(FileContent, IsUnknownOfOtherFiles) {
  for (const std::string& bytes : {std::string(), std::string("hello"), std::string("a,b\n1,2\n"),
                                   std::string("# nothing\n"), std::string(300, '\0')}) {
    EXPECT_EQ(content(bytes).content, FileContent::kUnknown) << bytes;
  }
  EXPECT_EQ(find_content("/no/such/file").content, FileContent::kUnknown);
}

TEST(FileContent, OfAnotherKindIsRefusedWithWhatReadsIt) {
  const TemporaryFolder folder;
  const std::filesystem::path tissue = folder.write("a.stl", "[tissue]\n");
  EXPECT_NO_THROW(refuse_other_content(tissue, FileContent::kTissue, "a tissue file"));
  EXPECT_THAT([&] { refuse_other_content(tissue, FileContent::kMesh, "a mesh file"); },
              ThrowsMessage<InputError>(tissue.string() +
                                        ": is a tissue file, must be a mesh file; --tissue FILE reads it"));
  EXPECT_NO_THROW(refuse_other_content(folder.write("b", "hello"), FileContent::kMesh, "a mesh file"));
}

TEST(FileContent, OfAFolderIsNamedWhereAFileIsRead) {
  const TemporaryFolder folder;
  (void)folder.write("study.toml", "[study]\n");
  EXPECT_THAT([&] { const InputFile file(folder.path(), kMeshInput); },
              ThrowsMessage<InputError>(HasSubstr(
                  "is a folder, must be a mesh file; it is the folder of a study: palpate study status")));
}

}  // namespace
}  // namespace palpate

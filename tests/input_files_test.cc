// Input files that are not regular files, or that never end.
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/refused_inputs.h"

namespace palpate::tests {
namespace {

/// Every command of the product that reads a file.
const Readers& readers() {
  static const Readers kReaders = {
      {"toml", {"run", "FILE", "--offline"}},
      {"toml", {"run", "--offline", "--tissue", "FILE"}},
      {"csv", {"run", "--offline", "--device", "scripted:FILE"}},
      {"h5", {"run", "--offline", "--device", "replay:FILE"}},
      {"stl", {"run", "--offline", "--organ", "FILE", "--organ-unit", "mm"}},
      {"vtk", {"run", "--offline", "--organ", "FILE", "--organ-unit", "mm"}},
      {"msh", {"run", "--offline", "--organ", "FILE", "--organ-unit", "mm"}},
      {"obj", {"run", "--offline", "--tool", "FILE", "--tool-unit", "mm"}},
      {"stl", {"inspect", "FILE", "--unit", "mm"}},
      {"toml", {"model", "--tissue", "FILE", "--depth-mm", "1"}},
      {"h5", {"replay", "FILE"}},
      {"h5", {"repair", "FILE"}},
      {"h5", {"export", "FILE", "--csv", "out.csv"}},
      {"h5", {"view", "FILE", "--screenshot", "out.png"}},
      {"html", {"serve", "--port", "0", "--page", "FILE"}},
      {"txt", {"serve", "--port", "0", "--token-file", "FILE"}},
  };
  return kReaders;
}

TEST(InputFiles, AFifoIsRefusedAtOnceByEveryReader) { expect_fifos_refused(readers()); }

TEST(InputFiles, ADeviceWithoutEndIsRefusedByEveryReader) { expect_endless_devices_refused(readers()); }

TEST(InputFiles, TwoGigabytesOfNothingAreRefusedByEveryReader) { expect_two_gigabytes_refused(readers()); }

TEST(InputFiles, AGltfBufferThatIsAFifoIsRefused) {
  const Folder folder;
  ASSERT_EQ(mkfifo((folder / "a.bin").c_str(), 0600), 0);
  std::ofstream(folder / "a.gltf")
      << R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 84}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})";
  expect_refused_in_time("a.bin", {"inspect", "a.gltf", "--unit", "m"}, folder,
                         "is a FIFO, must be a mesh file");
}

}  // namespace
}  // namespace palpate::tests

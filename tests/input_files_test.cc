// Input files that are not regular files, or that never end.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/program.h"

namespace palpate::tests {
namespace {

/// Outcome of the program if it ends within 20 s; otherwise it is killed.
Outcome outcome_in_time(const Folder& folder, const std::vector<std::string>& words) {
  Program program(folder.path(), words);
  for (int i = 0; i < 2000 && !program.ended(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (!program.ended()) program.signal(SIGKILL);
  return program.wait();
}

/// Every command that reads a file, with FILE for the file's name.
const std::vector<std::pair<std::string, std::vector<std::string>>>& readers() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> kReaders = {
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
      {"csv", {"fit", "FILE"}},
      {"csv", {"validate", "FILE", "--tissue", "liver"}},
      {"csv", {"validate", "--profile", "FILE", "--tissue", "liver", "--depth-mm", "5"}},
      {"html", {"serve", "--port", "0", "--page", "FILE"}},
      {"txt", {"serve", "--port", "0", "--token-file", "FILE"}},
  };
  return kReaders;
}

void expect_refused_in_time(const std::string& file, const std::vector<std::string>& words,
                            const Folder& folder, const std::string& why) {
  const Outcome outcome = outcome_in_time(folder, words);
  EXPECT_EQ(outcome.exit_code, 2) << words.front() << " " << file << ": " << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(why), std::string::npos) << words.front() << ": " << outcome.err;
}

std::vector<std::string> with_file(std::vector<std::string> words, const std::string& file) {
  for (std::string& word : words) {
    if (const std::size_t at = word.find("FILE"); at != std::string::npos) word.replace(at, 4, file);
  }
  return words;
}

TEST(InputFiles, AFifoIsRefusedAtOnceByEveryReader) {
  const Folder folder;
  for (const auto& [ending, words] : readers()) {
    const std::string name = "fifo." + ending;
    ASSERT_EQ(mkfifo((folder / name).c_str(), 0600), 0);
    expect_refused_in_time(name, with_file(words, name), folder, "is a FIFO, must be a");
    fs::remove(folder / name);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(InputFiles, ADeviceWithoutEndIsRefusedByEveryReader) {
  const Folder folder;
  for (const auto& [ending, words] : readers()) {
    const std::string name = "zero." + ending;
    fs::create_symlink("/dev/zero", folder / name);
    expect_refused_in_time(name, with_file(words, name), folder, "is a device, must be a");
    fs::remove(folder / name);
  }
}

TEST(InputFiles, TwoGigabytesOfNothingAreRefusedByEveryReader) {
  const Folder folder;
  for (const auto& [ending, words] : readers()) {
    const std::string name = "empty." + ending;
    std::ofstream(folder / name).put('\n');
    fs::permissions(folder / name, fs::perms::owner_read | fs::perms::owner_write);
    fs::resize_file(folder / name, std::uintmax_t{2} << 30);
    expect_refused_in_time(name, with_file(words, name), folder,
                           ending == "h5" ? "not an HDF5 file" : "has 2048 MiB");
    fs::remove(folder / name);
  }
}

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

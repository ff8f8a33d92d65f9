#include "learning/environment/generate.h"

#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "learning/environment/episode_file.h"

namespace palpate::learning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

GenerateSummary write(const std::filesystem::path& file, std::uint64_t seed = 1,
                      PolicyKind policy = PolicyKind::kScripted) {
  GenerateRequest request;
  request.scene.organ = "box";
  request.scene.no_noise = true;
  request.settings.steps = 30;
  request.policy = policy;
  request.episodes = 3;
  request.seed = seed;
  request.out = file;
  tasks::Communicator alone;
  return generate(request, alone, [](double, const std::string&) {});
}

template <typename Value>
std::vector<Value> read(const std::filesystem::path& file, const char* name, hid_t type,
                        std::vector<hsize_t>& shape) {
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(opened, name, H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  std::vector<Value> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(opened);
  return values;
}

TEST(Generate, AnHdf5FileHasARowForEachStepAndEpisode) {
  const test::TemporaryFolder folder;
  const GenerateSummary summary = write(folder / "e.h5");
  EXPECT_EQ(summary.steps, 90U);
  std::vector<hsize_t> shape;
  const auto seen = read<double>(folder / "e.h5", "observations", H5T_NATIVE_DOUBLE, shape);
  EXPECT_THAT(shape, ElementsAre(90, 9));
  (void)read<double>(folder / "e.h5", "actions", H5T_NATIVE_DOUBLE, shape);
  EXPECT_THAT(shape, ElementsAre(90, 3));
  const auto rewards = read<double>(folder / "e.h5", "rewards", H5T_NATIVE_DOUBLE, shape);
  EXPECT_THAT(shape, ElementsAre(90));
  double sum = 0.0;
  for (const double reward : rewards) sum += reward;
  EXPECT_NEAR(summary.mean_reward, sum / 90.0, 1e-12);
  EXPECT_THAT(read<std::int64_t>(folder / "e.h5", "episode_starts", H5T_NATIVE_INT64, shape),
              ElementsAre(0, 30, 60));
  const auto last = read<double>(folder / "e.h5", "final_observations", H5T_NATIVE_DOUBLE, shape);
  EXPECT_THAT(shape, ElementsAre(3, 9));
  EXPECT_NE(last[2], seen[9 * 29 + 2]);  // z after the last step
  const auto drawn = read<double>(folder / "e.h5", "parameters", H5T_NATIVE_DOUBLE, shape);
  EXPECT_THAT(shape, ElementsAre(3, 5));
  EXPECT_EQ(drawn[4], seen[8]) << "the target";
  EXPECT_NE(drawn[4], drawn[9]) << "of the next episode";
}

TEST(Generate, TheSameSeedGivesTheSameBytesAndAnotherOthers) {
  const test::TemporaryFolder folder;
  for (const std::string end : {".h5", ".npz"}) {
    (void)write(folder / ("a" + end));
    (void)write(folder / ("b" + end));
    (void)write(folder / ("c" + end), 2);
    const std::string first = text_of(folder / ("a" + end));
    EXPECT_GT(first.size(), 8U * 90U * 13U);
    EXPECT_TRUE(first == text_of(folder / ("b" + end))) << end;
    EXPECT_TRUE(first != text_of(folder / ("c" + end))) << end;
  }
}

// By the specifications of NumPy's format and of ZIP; unzip and numpy.load read it in the tests of Python.
TEST(EpisodeFile, AnNpzBeginsWithAStoredEntryWhoseHeaderHasTheShape) {
  const test::TemporaryFolder folder;
  EpisodeFile file(folder / "a.npz", {{"rows", Element::kNumber, 2}});
  const double values[4] = {1.0, 2.0, 3.0, 4.0};
  file.append(0, std::string_view(reinterpret_cast<const char*>(values), sizeof values));
  file.finish("{}");
  const std::string bytes = text_of(folder / "a.npz");
  EXPECT_EQ(bytes.substr(0, 4), std::string("PK\3\4"));
  EXPECT_EQ(bytes.substr(30, 8), "rows.npy");
  EXPECT_EQ(bytes.substr(38, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ(bytes.substr(48, 59), "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }");
  double third = 0.0;
  std::memcpy(&third, bytes.data() + 38 + 128 + 16, sizeof third);
  EXPECT_EQ(third, 3.0);
}

TEST(Generate, LeavesNothingBesideTheFile) {
  const test::TemporaryFolder folder;
  (void)write(folder / "e.npz");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Generate, RefusesARequestBeforeItRuns) {
  const auto refusal = [](const GenerateRequest& request) -> std::string {
    tasks::Communicator alone;
    try {
      (void)generate(request, alone, [](double, const std::string&) { FAIL(); });
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const test::TemporaryFolder folder;
  GenerateRequest request;
  request.scene.organ = "box";
  request.out = folder / "e.csv";
  EXPECT_THAT(refusal(request), HasSubstr("e.csv: must end in .h5 (HDF5) or .npz (NumPy)"));
  request.out = folder / "e.npz";
  request.episodes = 0;
  EXPECT_EQ(refusal(request), "episodes = 0: must be 1 to 10000000");
  request.episodes = 1'000'000;
  EXPECT_THAT(refusal(request),
              HasSubstr("more than the 4 GiB of an .npz file: write a .h5 file, or at most"));
  request.episodes = 1;
  request.out = folder / "nowhere/e.h5";
  EXPECT_THAT(refusal(request), HasSubstr("nowhere/e.h5: cannot be written: No such file"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace palpate::learning

#include "fit/sweep/sweep.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/scene.h"

namespace palpate::sweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string error_of_axis(const std::string& text) {
  try {
    (void)parse_axis("--set", text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A ball of 3 mm that presses 2 mm into a block, without noise, friction and damping, in 0.4 s and returns.
class Bench final {
 public:
  Bench() {
    write("block.obj", block());
    write("soft.toml",
          "[tissue]\nk1_N_per_m = 20.0\nbeta = 1.6\nq = 0.7\nrest_length_mm = 14.0\nmax_length_mm = 22.0\n"
          "min_length_mm = 6.0\nt1_us = 1.0\n[tissue.contact]\nfriction = 0.0\ndamping_N_s_per_m = 0.0\n");
    write("down.csv",
          "time_s,x_m,y_m,z_m\n0,0.001,0.002,0.005\n0.2,0.001,0.002,0.001\n0.4,0.001,0.002,0.005\n");
    write(
        "press.toml",
        "[organ]\nmesh = \"block.obj\"\nunit = \"mm\"\ntissue = \"soft.toml\"\n[tool]\nmesh = \"sphere:3\"\n"
        "[device]\nkind = \"scripted\"\npath = \"down.csv\"\n[noise]\nenabled = false\n");
  }

  [[nodiscard]] SweepRequest request(const std::vector<std::string>& settings) const {
    SweepRequest request;
    request.scene.scene = folder_ / "press.toml";
    for (const std::string& text : settings) request.axes.push_back(parse_axis("--set", text));
    request.record = folder_ / "results.jsonl";
    return request;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] const test::TemporaryFolder& folder() const { return folder_; }

 private:
  static std::string block() {
    std::string text;
    for (const char* z : {"-40", "0"}) {
      for (const char* y : {"-30", "30"}) {
        for (const char* x : {"-30", "30"}) text += std::string("v ") + x + ' ' + y + ' ' + z + '\n';
      }
    }
    return text +
           "f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 "
           "6\n"
           "f 4 8 6\n";
  }

  test::TemporaryFolder folder_;
};

SweepResult swept(const SweepRequest& request) {
  tasks::Communicator alone;
  return run_sweep(request, alone, {});
}

double quantity(const SweepRow& row, const std::string& name) {
  for (std::size_t i = 0; i < session::kRunQuantities.size(); ++i) {
    if (name == session::kRunQuantities[i].name) return row.quantities.at(i);
  }
  throw std::runtime_error("no quantity " + name);
}

TEST(Axis, HasValuesEvenlySpacedFromEndToEnd) {
  EXPECT_THAT(parse_axis("--set", "tissue.k1_N_per_m=10:40:7").values,
              ElementsAre("10", "15", "20", "25", "30", "35", "40"));
  EXPECT_THAT(parse_axis("--set", "device.mass_kg=0.1:0.7:7").values,
              ElementsAre("0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"));
  EXPECT_THAT(parse_axis("--set", "scene.seed=1:3:3").values, ElementsAre("1", "2", "3"));
  EXPECT_THAT(parse_axis("--set", "scene.seed=0:1000000:3").values, ElementsAre("0", "500000", "1000000"));
}

TEST(Axis, IsSpacedInTheLogarithmWhenAsked) {
  EXPECT_THAT(parse_axis("--set", "tissue.k1_N_per_m=1:1000:4:log").values,
              ElementsAre("1", "10", "100", "1000"));
  EXPECT_THAT(parse_axis("--set", "path.speed=0.25:4:5:log").values,
              ElementsAre("0.25", "0.5", "1", "2", "4"));
}

TEST(Axis, TakesAListOfNumbersTruthsOrTexts) {
  EXPECT_THAT(parse_axis("--set", "path.speed=2,0.5").values, ElementsAre("2", "0.5"));
  EXPECT_THAT(parse_axis("--set", "noise.enabled=true,false").values, ElementsAre("true", "false"));
  const Axis tissue = parse_axis("--set", "organ.tissue=liver,heart");
  EXPECT_THAT(tissue.values, ElementsAre("liver", "heart"));
  EXPECT_FALSE(tissue.number());
}

TEST(Axis, TakesAKeyWithoutItsUnit) {
  EXPECT_EQ(parse_axis("--set", "tissue.k1=10").key, "tissue.k1_N_per_m");
  EXPECT_EQ(parse_axis("--set", "device.damping=1").key, "device.damping_N_s_per_m");
  EXPECT_EQ(parse_axis("--set", "device.grip=light").key, "device.grip");  // must not match grip_N_per_m
}

TEST(Axis, AWrongKeyIsReportedTheRightOne) {
  EXPECT_EQ(error_of_axis("tissue.k2=1"), "--set tissue.k2: a scene has no such key, did you mean tissue.q?");
  EXPECT_EQ(
      error_of_axis("friction=1"),
      "--set friction: a scene has no such key, did you mean device.friction_N or tissue.contact.friction?");
  EXPECT_EQ(error_of_axis("path.sped=1"),
            "--set path.sped: a scene has no such key, did you mean path.speed?");
  EXPECT_THAT(error_of_axis("safety.max_slew=1"),
              HasSubstr("did you mean safety.max_slew_N_per_ms or safety.max_slew_N_m_per_ms?"));
  EXPECT_THAT(error_of_axis("quite-else=1"), HasSubstr("docs/file-formats.md lists the keys"));
}

TEST(Axis, AValueOutOfTheKeysRangeIsRefused) {
  EXPECT_EQ(error_of_axis("tissue.k1_N_per_m=-1,2"),
            "--set tissue.k1_N_per_m = -1: must be > 0 and <= 1e+09");
  EXPECT_EQ(error_of_axis("path.speed=1:1000:2"),
            "--set path.speed = 1000: must be a number >= 0.01 and <= 100");
  EXPECT_EQ(error_of_axis("scene.seed=1:2:3"), "--set scene.seed = 1.5: must be a whole number >= 0");
  EXPECT_EQ(error_of_axis("device.fit=yes"), "--set device.fit = yes: must be true or false");
}

TEST(Axis, RefusesWhatIsNoRangeAndNoList) {
  for (const char* text : {"path.speed", "path.speed=", "path.speed=1:2", "path.speed=2:1:3",
                           "path.speed=1:2:1", "path.speed=1:2:2.5", "path.speed=1:2:3:lin",
                           "path.speed=0:2:3:log", "path.speed=1:inf:3", "path.speed=1:2:3:log:4"}) {
    EXPECT_THAT(error_of_axis(text), HasSubstr("must be KEY=LOW:HIGH:N")) << text;
  }
  EXPECT_THAT(error_of_axis("path.speed=1,2,1"), HasSubstr("has the value 1 twice"));
}

TEST(Sweep, RunsAllCombinationsTheLastAxisFastest) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"tissue.k1=10,20", "path.speed=1,2,4"}));
  std::vector<std::vector<std::string>> settings;
  for (const SweepRow& row : result.rows) settings.push_back(row.settings);
  EXPECT_THAT(settings, ElementsAre(ElementsAre("10", "1"), ElementsAre("10", "2"), ElementsAre("10", "4"),
                                    ElementsAre("20", "1"), ElementsAre("20", "2"), ElementsAre("20", "4")));
  EXPECT_EQ(result.scene, "press");
  EXPECT_EQ(result.failed() + result.missed() + result.with_fault(), 0U);
}

TEST(Sweep, EachRunHasItsOwnValues) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"tissue.k1=10,20", "path.speed=1,4"}));
  const auto force = [&result](std::size_t run) { return quantity(result.rows[run], "peak_tissue_force_N"); };
  EXPECT_NEAR(force(2), 2.0 * force(0), 1e-9);  // an elastic force is proportional to stiffness
  EXPECT_NEAR(force(1), force(0), 1e-2 * force(0));
  EXPECT_NEAR(quantity(result.rows[0], "contact_time_s"), 0.2, 0.003);  // 2 of 4 mm, in both directions
  EXPECT_NEAR(quantity(result.rows[1], "contact_time_s"), 0.05, 0.003);
}

TEST(Sweep, AnElasticPressGivesItsWorkBack) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"tissue.contact.damping=0,5"}));
  const auto of = [&result](std::size_t run, const char* name) { return quantity(result.rows[run], name); };
  EXPECT_GT(of(0, "loading_work_mJ"), 0.0);
  EXPECT_LT(of(0, "loading_work_mJ"), of(0, "peak_tissue_force_N") * 2.0);  // the force rises over the 2 mm
  EXPECT_LT(std::abs(of(0, "dissipated_energy_mJ")), 0.02 * of(0, "loading_work_mJ"));
  // a damper of 5 N s/m at 0.02 m/s over 2 mm inwards; it never pulls on the way back
  EXPECT_GT(of(1, "dissipated_energy_mJ"), 0.5 * 5.0 * 0.02 * 2.0);
  EXPECT_LT(of(1, "dissipated_energy_mJ"), 1.1 * 5.0 * 0.02 * 4.0);
}

TEST(Sweep, AMissedContactIsSaid) {
  const Bench bench;
  bench.write("above.csv", "time_s,x_m,y_m,z_m\n0,0.001,0.002,0.009\n0.2,0.001,0.002,0.008\n");
  const SweepResult result = swept(bench.request({"device.path=down.csv,above.csv"}));
  EXPECT_FALSE(result.rows[0].missed_contact);
  EXPECT_TRUE(result.rows[1].missed_contact);
  EXPECT_EQ(result.missed(), 1U);
  EXPECT_EQ(quantity(result.rows[1], "peak_force_N"), 0.0);
}

TEST(Sweep, ARunThatFailsKeepsItsRowWithTheReasonAndTheSweepGoesOn) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"organ.tissue=soft.toml,lost.toml,liver"}));
  ASSERT_EQ(result.rows.size(), 3U);
  EXPECT_EQ(result.failed(), 1U);
  EXPECT_THAT(result.rows[1].ended, StartsWith("failed: "));
  EXPECT_THAT(result.rows[1].ended, HasSubstr("lost.toml"));
  EXPECT_EQ(result.rows[2].ended, "done");
  const std::string csv = sweep_csv(result);
  EXPECT_THAT(csv, StartsWith("run,organ.tissue,peak_force_N,"));
  EXPECT_THAT(csv, HasSubstr("\n1,lost.toml,,,,,,,,,,,,failed: "));
}

TEST(Sweep, ABrokenOffSweepGoesOnToTheSameBytes) {
  const Bench bench;
  const SweepRequest request = bench.request({"tissue.k1=10:40:4"});
  const SweepResult whole = swept(request);
  write_sweep_hdf5(whole, bench.folder() / "whole.h5");
  std::istringstream lines(text_of(request.record));
  std::string kept;
  std::size_t count = 0;
  for (std::string line; count < 2 && std::getline(lines, line);) {
    if (line.empty()) continue;
    kept += line + '\n';
    ++count;
  }
  std::ofstream(request.record, std::ios::trunc) << kept << "{\"key\":\"cut";
  const SweepResult resumed = swept(request);
  write_sweep_hdf5(resumed, bench.folder() / "resumed.h5");
  EXPECT_EQ(resumed.resumed, 2U);
  EXPECT_EQ(sweep_csv(resumed), sweep_csv(whole));
  EXPECT_EQ(text_of(bench.folder() / "resumed.h5"), text_of(bench.folder() / "whole.h5"));
}

TEST(Sweep, ARunThatFailedIsTriedAgain) {
  const Bench bench;
  const SweepRequest request = bench.request({"device.workspace_scale=1", "device.clutch_button=1,99"});
  EXPECT_EQ(swept(request).failed(), 1U);
  const SweepResult again = swept(request);
  EXPECT_EQ(again.failed(), 1U);
  EXPECT_EQ(again.resumed, 1U);
}

TEST(Sweep, ARunThatFailedOnAFileSucceedsOnceTheFileIsThere) {
  const Bench bench;
  const SweepRequest request = bench.request({"organ.tissue=liver,late.toml"});
  EXPECT_EQ(swept(request).failed(), 1U);
  std::filesystem::copy(bench.folder() / "soft.toml", bench.folder() / "late.toml");
  const SweepResult again = swept(request);
  EXPECT_EQ(again.failed(), 0U);
  EXPECT_EQ(again.resumed, 1U);
}

TEST(Sweep, ARunIsMadeAgainWhenItsFileChanged) {
  const Bench bench;
  bench.write("other.toml", text_of(bench.folder() / "soft.toml"));
  const SweepRequest request = bench.request({"organ.tissue=liver,other.toml"});
  const SweepResult before = swept(request);
  bench.write("other.toml", text_of(bench.folder() / "soft.toml").replace(8 + 13, 4, "40.0"));
  const SweepResult after = swept(request);
  EXPECT_EQ(after.resumed, 1U);
  EXPECT_NEAR(quantity(after.rows[1], "peak_tissue_force_N"),
              2.0 * quantity(before.rows[1], "peak_tissue_force_N"), 1e-9);
}

TEST(Sweep, TheFilesOfAValueAreThoseThatExistAndABufferOfAMesh) {
  const Bench bench;
  const SweepRequest request = bench.request({"tool.mesh=sphere:3,a.gltf,lost.stl", "path.speed=1"});
  bench.write("a.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 3}]})");
  bench.write("1", "a file of the number's name");
  const auto files = [&request](std::size_t axis, std::size_t value) {
    return files_of(request, request.axes[axis], request.axes[axis].values[value]);
  };
  EXPECT_THAT(files(0, 0), testing::IsEmpty());
  EXPECT_THAT(files(0, 1), ElementsAre(bench.folder() / "a.gltf", bench.folder() / "a.bin"));
  EXPECT_THAT(files(0, 2), testing::IsEmpty());
  EXPECT_THAT(files(1, 0), testing::IsEmpty());
}

TEST(Sweep, ARecordOfAnotherSceneIsRefusedInWords) {
  const Bench bench;
  const SweepRequest request = bench.request({"tissue.k1=10,20"});
  (void)swept(request);
  bench.write("down.csv", "time_s,x_m,y_m,z_m\n0,0.001,0.002,0.005\n0.2,0.001,0.002,0.002\n");
  EXPECT_THAT([&] { (void)swept(request); },
              testing::ThrowsMessage<InputError>(HasSubstr("results.jsonl: holds runs of another sweep")));
  EXPECT_THROW((void)swept(bench.request({"tissue.k1=10,30"})), InputError);
}

TEST(Sweep, RefusesADeviceThatMovesByItself) {
  const Bench bench;
  SweepRequest request = bench.request({"tissue.k1=10,20"});
  request.scene.device = "mouse";
  EXPECT_THAT([&] { (void)swept(request); },
              testing::ThrowsMessage<InputError>(
                  "device mouse: a sweep needs a scripted, emulated or replay device"));
}

TEST(Sweep, RefusesMoreRunsThanItsLimit) {
  const Bench bench;
  EXPECT_THAT(
      [&] {
        (void)swept(bench.request({"tissue.k1=1:2:1000", "tissue.q=0.1:0.9:101"}));
      },
      testing::ThrowsMessage<InputError>("--set: more than 100000 runs; give fewer values"));
}

TEST(Sweep, ALargeWholeNumberIsExactInTheHdf5File) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"scene.seed=9007199254740993"}));
  const std::string file = bench.folder() / "results.h5";
  write_sweep_hdf5(result, file);
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t seeds = H5Dopen2(opened, "scene.seed", H5P_DEFAULT);
  std::uint64_t seed = 0;
  EXPECT_GE(H5Dread(seeds, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &seed), 0);
  EXPECT_EQ(seed, 9007199254740993U);  // not representable as double
  H5Dclose(seeds);
  H5Fclose(opened);
}

TEST(Sweep, ItsHdf5FileHasAColumnADataset) {
  const Bench bench;
  const SweepResult result = swept(bench.request({"tissue.k1=10,20", "organ.tissue=soft.toml,lost.toml"}));
  const std::string file = bench.folder() / "results.h5";
  write_sweep_hdf5(result, file);
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto numbers = [opened](const char* name) {
    std::vector<double> values(4);
    const hid_t column = H5Dopen2(opened, name, H5P_DEFAULT);
    EXPECT_GE(H5Dread(column, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
    H5Dclose(column);
    return values;
  };
  EXPECT_THAT(numbers("tissue.k1_N_per_m"), ElementsAre(10, 10, 20, 20));
  EXPECT_EQ(numbers("peak_force_N")[2], quantity(result.rows[2], "peak_force_N"));
  EXPECT_TRUE(std::isnan(numbers("peak_force_N")[3]));
  std::vector<std::uint64_t> counts(4);
  const hid_t faults = H5Dopen2(opened, "faults", H5P_DEFAULT);
  EXPECT_GE(H5Dread(faults, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, counts.data()), 0);
  H5Dclose(faults);
  EXPECT_THAT(counts, ElementsAre(0, 18446744073709551615U, 0, 18446744073709551615U));
  EXPECT_THAT(numbers("missed_contact"), ElementsAre(0, 255, 0, 255));
  EXPECT_GT(H5Lexists(opened, "organ.tissue", H5P_DEFAULT), 0);
  EXPECT_GT(H5Lexists(opened, "ended", H5P_DEFAULT), 0);
  H5Fclose(opened);
  EXPECT_THROW(write_sweep_hdf5(result, "/nowhere/results.h5"), InputError);
}

}  // namespace
}  // namespace palpate::sweep

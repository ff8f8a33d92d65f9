// Updates of tissue, noise and inclusions during a run: recorded, read, exported and replayed bit for bit.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numeric>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/contact/largest_stiffness.h"
#include "core/contact/test/prepared_once.h"
#include "io/record/flight_recorder.h"
#include "io/record/recording_frames.h"
#include "io/record/recording_writer.h"
#include "io/record/test/sample_recording.h"
#include "io/record/update_columns.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/recording.h"
#include "run/realtime/loop.h"

namespace palpate::record {
namespace {

using contact::test::prepared_once;

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kBallRadius = 3e-3;  // m

scene::Scene block_and_ball() {
  scene::Scene scene;
  scene.name = "block and ball";
  scene.seed = 9;
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  scene.tissue = model::tissue_preset("gallbladder");
  scene.tools.push_back(
      {"ball", {{.name = "ball", .mesh = geometry::make_ball(kBallRadius, 80)}}, kBallRadius});
  scene.devices.emplace_back();
  scene.inclusions.resize(2);
  scene.inclusions[1].inclusion = {Vec3(0.002, 0.0, 0.012), 3e-3, 20.0, 1e-3, 0.5};  // 8 mm deep, it pulses
  return scene;
}

/// Offers a random tissue or noise, as a user at the sliders would.
void offer_something(haptics::ParameterUpdates& changes, std::mt19937_64& dice) {
  const auto share = [&dice] { return static_cast<double>(dice() >> 11U) * 0x1p-53; };
  if (dice() % 3 == 0) {
    (void)changes.offer(haptics::LiveInclusion{
        1, {0.01 * share() - 0.005, 0.004 * share(), 0.010 + 0.005 * share()}, 0.1 + 99.0 * share()});
    return;
  }
  if (dice() % 3 == 0) {
    (void)changes.offer(haptics::LiveNoise{dice() % 2 == 0, 1e-4 * share(), 1e-3 + 5e-3 * share()});
    return;
  }
  const char* const names[] = {"gallbladder", "heart", "liver", "kidney"};
  model::TissueParameters tissue = model::tissue_preset(names[dice() % 4]);
  tissue.k1 *= 0.5 + share();
  tissue.contact.damping = 0.2 * share();
  tissue.contact.friction = share();
  if (dice() % 2 == 0) tissue.law = model::LawKind::kSmooth;
  if (tissue.law == model::LawKind::kSmooth) {
    tissue.source = model::SourceParameters{"ball", 4e-3};
    tissue.size_exponent = 0.5;
  }
  for (std::uint64_t terms = dice() % 4; terms > 0; --terms) {
    tissue.relaxation.push_back({0.3 * share() + 1e-3, 0.01 + share()});
  }
  (void)changes.offer(tissue);
}

/// Presses, slides and lifts in turn; offers updates at random ticks.
class RestlessDevice final : public haptics::Device {
 public:
  RestlessDevice(haptics::ParameterUpdates& changes, std::uint64_t seed) : changes_(changes), dice_(seed) {}
  haptics::DeviceState read(std::uint64_t, double time) noexcept override {
    if (dice_() % 40 == 0) offer_something(changes_, dice_);
    haptics::DeviceState state;
    state.position_D =
        Vec3(0.01 * std::sin(3.0 * time), 0.002, kBallRadius - 0.003 + 0.005 * std::cos(9.0 * time));
    return state;
  }
  bool write(const haptics::ForceCommand&) noexcept override { return true; }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return 0; }

 private:
  haptics::ParameterUpdates& changes_;
  std::mt19937_64 dice_;
};

/// A run with an update about every 40 ticks.
Recording restless_run(std::uint64_t seed, std::uint64_t ticks, bool by_flight_recorder = false) {
  const TemporaryFolder folder;
  const scene::Scene scene = block_and_ball();
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  haptics::SimulationState state(world);
  const std::unique_ptr<haptics::ParameterUpdates> changes = scene::make_parameter_updates(scene, world);
  RestlessDevice device(*changes, seed);
  haptics::Device* const devices[] = {&device};
  haptics::RunControl control(changes.get());
  const realtime::LoopOptions options{.ticks = ticks, .offline = true, .control = &control};
  if (by_flight_recorder) {
    FlightRecorder flight(scene);
    flight.write(folder / "a.h5", realtime::run_loop(world, state, devices, {&flight}, options));
  } else {
    Recorder recorder(folder / "a.h5", scene, true);
    recorder.finish(realtime::run_loop(world, state, devices, {&recorder}, options));
  }
  return read_recording(folder / "a.h5");
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(ParameterUpdatesRecorded, ReplayIsTheSameBitForBitWithChangesAtRandomTicks) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Recording recording = restless_run(seed, 2000);
    ASSERT_GT(recording.changes.size(), 20U);
    const ReplayResult result = replay(recording, {}, prepared_once());
    EXPECT_EQ(result.rows_compared, 2000U);
    EXPECT_EQ(result.rows_different, 0U) << result.first_difference;
    EXPECT_EQ(result.hash, hash_rows(recording.rows));
  }
}

TEST(ParameterUpdatesRecorded, TheChangesAreWhatTheForceCameFrom) {
  Recording recording = restless_run(4, 1500);
  for (haptics::ParameterUpdate& change : recording.changes) change.tissue.k1 *= 1.5;
  EXPECT_GT(replay(recording, {}, prepared_once()).rows_different, 300U);
}

TEST(ParameterUpdatesRecorded, RowsSayAtWhichTicksAndTheChangesStandInOrder) {
  const Recording recording = restless_run(5, 1000);
  std::vector<std::uint64_t> by_rows;
  for (const haptics::TickRow& row : recording.rows) {
    if ((row.events & haptics::kParameterUpdated) != 0) by_rows.push_back(row.tick);
  }
  std::vector<std::uint64_t> by_changes;
  for (const haptics::ParameterUpdate& change : recording.changes) {
    by_changes.push_back(change.tick);
    EXPECT_EQ(change.number, by_changes.size());
  }
  EXPECT_EQ(by_rows, by_changes);
}

TEST(ParameterUpdatesRecorded, ARecordingThatLacksAChangeIsNotRunAgain) {
  Recording recording = restless_run(6, 500);
  const std::string tick = std::to_string(recording.changes[1].tick);
  recording.changes.erase(recording.changes.begin() + 1);
  try {
    (void)replay(recording, {}, prepared_once());
    FAIL() << "it was run again";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("lacks the change of tissue or noise at tick " + tick));
  }
}

TEST(ParameterUpdatesRecorded, AChangeThatTheRowsDoNotKnowIsRefused) {
  Recording recording = restless_run(6, 500);
  for (haptics::TickRow& row : recording.rows) row.events = 0;
  EXPECT_THROW((void)replay(recording, {}, prepared_once()), InputError);
}

TEST(ParameterUpdatesRecorded, BadValuesInAFileAreRefusedByName) {
  Recording recording = restless_run(6, 500);
  recording.changes[0].tissue.beta = -2.0;
  try {
    (void)replay(recording, {}, prepared_once());
    FAIL() << "it was run again";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("beta"));
  }
}

TEST(ParameterUpdatesRecorded, SnapshotsCarryTheReachAndNumberInForce) {
  Recording recording = restless_run(7, 400);
  recording.changes[0].tissue.reach.bar_ratio = 2.5;
  recording.changes[0].tissue.reach.depth_exponent = 0.4;
  recording.changes[0].what = haptics::kTissueChanged;
  const std::uint64_t tick = recording.changes[0].tick;
  const std::vector<haptics::Snapshot> snapshots = snapshots_at(recording, {tick - 1, tick}, prepared_once());
  EXPECT_EQ(snapshots[0].change, 0U);
  EXPECT_EQ(snapshots[0].reach.bar_ratio, 1.8);
  EXPECT_EQ(snapshots[0].reach.depth_exponent, 0.5);
  EXPECT_EQ(snapshots[1].change, 1U);
  EXPECT_EQ(snapshots[1].reach.bar_ratio, 2.5);
  EXPECT_EQ(snapshots[1].reach.depth_exponent, 0.4);
}

bool same_scene(const haptics::Snapshot& a, const haptics::Snapshot& b) {
  return a.tick == b.tick && a.change == b.change &&
         a.tools[0].pose_W.position == b.tools[0].pose_W.position &&
         a.results[0].depth == b.results[0].depth && a.results[0].contact_W == b.results[0].contact_W &&
         a.commands[0].force == b.commands[0].force;
}

TEST(RecordingFrames, AreTheSameInAnyOrderAndByAnyWay) {
  const Recording recording = restless_run(8, 3000);
  std::vector<std::uint64_t> all(3000);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<haptics::Snapshot> expected = snapshots_at(recording, all, prepared_once());
  RecordingFrames frames(recording, prepared_once());
  for (const std::uint64_t tick : {2999U, 511U, 512U, 513U, 100U, 0U, 2048U, 2047U, 1U, 2999U, 2998U}) {
    EXPECT_TRUE(same_scene(frames.at(tick), expected[tick])) << tick;
  }
  RecordingFrames by_steps(recording, prepared_once());
  int steps = 0;
  while (!by_steps.approach(2500, 300)) ++steps;
  EXPECT_EQ(steps, 8) << "2501 ticks in pieces of 300";
  EXPECT_TRUE(same_scene(by_steps.at(2500), expected[2500]));
  EXPECT_FALSE(by_steps.approach(600, 88)) << "from the place before tick 512 on";
  EXPECT_TRUE(by_steps.approach(600, 1));
  EXPECT_THROW((void)by_steps.approach(3000, 1), InputError);
  EXPECT_THROW((void)by_steps.at(3000), InputError);
}

TEST(RecordingFrames, ATickThatCannotBeRunLeavesTheOthers) {
  Recording recording = restless_run(8, 1000);
  std::vector<std::uint64_t> all(700);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<haptics::Snapshot> expected = snapshots_at(recording, all, prepared_once());
  ASSERT_EQ(recording.rows[700].events & haptics::kParameterUpdated, 0U);
  recording.rows[700].events |= haptics::kParameterUpdated;
  RecordingFrames frames(recording, prepared_once());
  for (int times = 0; times < 2; ++times) {
    EXPECT_THROW((void)frames.at(700), InputError) << "it used a change that is not there";
    EXPECT_THROW((void)frames.at(900), InputError) << "it comes after it";
    EXPECT_TRUE(same_scene(frames.at(699), expected[699]));
    EXPECT_TRUE(same_scene(frames.at(20), expected[20]));
  }
}

TEST(RecordingFrames, TheDeepestTickIsThatOfTheHandAskedFor) {
  Recording recording = restless_run(8, 4);
  for (haptics::TickRow& row : recording.rows) row.depth = 0.0;
  recording.rows[1].depth = 1e-3;
  recording.rows[3].depth = 2e-3;
  const RecordingFrames frames(recording, prepared_once());
  EXPECT_EQ(frames.deepest(), 3U);
  EXPECT_EQ(frames.deepest(1), 0U) << "there is no such hand";
}

TEST(ParameterUpdatesRecorded, TheFlightRecorderKeepsThem) {
  const Recording recording = restless_run(8, 1000, true);
  EXPECT_EQ(recording.rows.size(), 1000U);
  EXPECT_GT(recording.changes.size(), 10U);
}

TEST(ParameterUpdatesRecorded, ExportIsOneLineAChangeWithNamesInQuotes) {
  const TemporaryFolder folder;
  Recording recording = restless_run(9, 500);
  haptics::ParameterUpdate& first = recording.changes.front();
  first = haptics::parameter_update(recording.scene.tissue, {true, 5e-5, 5e-3}, haptics::kTissueChanged);
  first.tick = 12;
  first.number = 1;
  first.tissue.law = model::LawKind::kSmooth;
  first.name = {'a', ',', '"'};
  export_changes_csv(recording, folder / "c.csv");
  const std::vector<std::string> lines = lines_of(folder / "c.csv");
  ASSERT_EQ(lines.size(), recording.changes.size() + 1);
  EXPECT_THAT(lines[0], StartsWith("tick,number,what,law,k1_N_per_m,beta,q,rest_length_m,"));
  EXPECT_EQ(lines[1],
            "12,1,tissue,smooth,18,1.6,0.7,0.014,0.022,0.006,1e-06,0,0,0,0,0,0,0,1.1,0.43,1.8,0.58,0.5,"
            "0.2,0,0,0.5,0.01,8,0.015,1,5e-05,0.005,0,0,0,0,0,0,0,0,0,\"a,\"\"\"");
  EXPECT_EQ(changes_csv_path("x/run.csv"), std::filesystem::path("x/run-changes.csv"));
  EXPECT_THROW(export_changes_csv(recording, folder / "nowhere/c.csv"), InputError);
}

/// A recording of one row with these updates. @return the reader's error; empty: none
std::string refusal_of(const std::vector<haptics::ParameterUpdate>& changes,
                       const std::function<void(hid_t)>& spoil) {
  const TemporaryFolder folder;
  {
    Recorder recorder(folder / "a.h5", block_and_ball(), true);
    recorder.on_start(1);
    for (const haptics::ParameterUpdate& change : changes) recorder.on_update(change);
    recorder.on_row(haptics::TickRow{});
    recorder.finish({});
  }
  if (spoil) {
    const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, "changes", H5P_DEFAULT);
    spoil(file);
    H5Fclose(file);
  }
  try {
    (void)read_recording(folder / "a.h5");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

void make_list_of_numbers(hid_t file) {
  const hsize_t count = 3;
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  H5Dclose(H5Dcreate2(file, "changes", H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
}

void make_list_with_one_column(hid_t file) {
  const hsize_t count = 1;
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t type = H5Tcreate(H5T_COMPOUND, 8);
  H5Tinsert(type, "tick", 0, H5T_NATIVE_INT64);
  H5Dclose(H5Dcreate2(file, "changes", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Tclose(type);
  H5Sclose(space);
}

TEST(ParameterUpdatesRecorded, ChangesThatAreNoneAreRefusedAndAFileFromBeforeThemIsRead) {
  haptics::ParameterUpdate change =
      haptics::parameter_update(block_and_ball().tissue, {}, haptics::kTissueChanged);
  change.tick = 5;
  change.number = 1;
  EXPECT_EQ(refusal_of({change}, {}), "");
  EXPECT_THAT(refusal_of({change, change}, {}), HasSubstr("row 1 of /changes is out of order"));
  EXPECT_EQ(refusal_of({change}, [](hid_t) {}), "") << "as if from before there were changes";
  EXPECT_THAT(refusal_of({change}, make_list_of_numbers), HasSubstr("/changes has no columns"));
  EXPECT_THAT(refusal_of({change}, make_list_with_one_column), HasSubstr("/changes has no column number"));
}

TEST(ParameterUpdatesRecorded, ANumberThatNoUpdateHasIsRefusedByName) {
  const auto defect = [](auto UpdateRow::*number, auto value) {
    haptics::ParameterUpdate change =
        haptics::parameter_update(block_and_ball().tissue, {}, haptics::kInclusionChanged);
    UpdateRow row = record::row_of(change);
    row.*number = value;
    return defect_of(row);
  };
  constexpr std::uint64_t kBeyond32Bits = (std::uint64_t{1} << 32) + 1;  // truncated, it would be 1
  EXPECT_EQ(defect(&UpdateRow::law, 1U), "");
  EXPECT_EQ(defect(&UpdateRow::law, 7U), "has law 7, want 0 or 1");
  EXPECT_EQ(defect(&UpdateRow::what, 16U), "has what 16, want bits up to 15");
  EXPECT_EQ(defect(&UpdateRow::noise_enabled, 2U), "has noise_enabled 2, want 0 or 1");
  EXPECT_EQ(defect(&UpdateRow::inclusion, 8U), "");
  EXPECT_EQ(defect(&UpdateRow::inclusion, 9U), "has inclusion 9, want at most 8");
  EXPECT_EQ(defect(&UpdateRow::inclusion, kBeyond32Bits), "has inclusion 4294967297, want at most 8");
  EXPECT_EQ(defect(&UpdateRow::inclusion, 0U), "has inclusion 0, want the number of the one that changes");
  EXPECT_EQ(defect(&UpdateRow::stimulus_interval, kBeyond32Bits),
            "has stimulus_interval 4294967297, want 0, 1 or 2");
}

TEST(ParameterUpdatesRecorded, AnUpdateWithALawThatDoesNotExistIsRefusedAsTheFilesRow) {
  haptics::ParameterUpdate change =
      haptics::parameter_update(block_and_ball().tissue, {}, haptics::kTissueChanged);
  change.tick = 5;
  change.number = 1;
  change.tissue.law = static_cast<model::LawKind>(7);
  EXPECT_THAT(refusal_of({change}, {}), HasSubstr("row 0 of /changes has law 7, want 0 or 1"));
}

/// Writes updates without one of the columns, as recordings from before its parameter existed have them.
void write_without(std::string_view left_out, hid_t file,
                   const std::vector<haptics::ParameterUpdate>& changes) {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(UpdateRow));
  for (const Column& column : update_columns()) {
    if (column.name == left_out) continue;
    const hid_t native = column.type == ColumnType::kU32   ? H5T_NATIVE_UINT32
                         : column.type == ColumnType::kU64 ? H5T_NATIVE_UINT64
                                                           : H5T_NATIVE_DOUBLE;
    H5Tinsert(type, column.name, column.offset, native);
  }
  const hdf5::Handle name = hdf5::text_type(haptics::ParameterUpdate::kNameBytes);
  H5Tinsert(type, kUpdateName, offsetof(UpdateRow, name), name.id());
  H5Tpack(type);
  const hsize_t count = changes.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t set = H5Dcreate2(file, "changes", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  std::vector<UpdateRow> rows(changes.size());
  std::transform(changes.begin(), changes.end(), rows.begin(),
                 [](const haptics::ParameterUpdate& change) { return record::row_of(change); });
  H5Dwrite(set, update_row_type().id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  H5Dclose(set);
  H5Sclose(space);
  H5Tclose(type);
}

/// The updates that are read from a recording whose file lacks a column.
std::vector<haptics::ParameterUpdate> read_without(std::string_view column,
                                                   const std::vector<haptics::ParameterUpdate>& changes) {
  const TemporaryFolder folder;
  {
    Recorder recorder(folder / "a.h5", block_and_ball(), true);
    recorder.on_start(1);
    recorder.finish({});
  }
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, "changes", H5P_DEFAULT);
  write_without(column, file, changes);
  H5Fclose(file);
  return read_recording(folder / "a.h5").changes;
}

TEST(ParameterUpdatesRecorded, ANumberThatAnOldFileLacksHasItsDefault) {
  const std::vector<haptics::ParameterUpdate> expected = restless_run(6, 500).changes;
  ASSERT_GT(expected.size(), 3U);
  std::vector<haptics::ParameterUpdate> others = expected;
  for (haptics::ParameterUpdate& change : others) {
    change.tissue.reach.depth_exponent = 0.4;
    change.tissue.contact.tangential_damping = 0.75;
  }
  std::vector<haptics::ParameterUpdate> old = read_without("depth_exponent", others);
  ASSERT_EQ(old.size(), expected.size());
  EXPECT_EQ(old[2].tissue.reach.depth_exponent, 0.5);
  EXPECT_EQ(old[2].tissue.contact.tangential_damping, 0.75);
  old = read_without("tangential_damping_N_s_per_m", others);
  ASSERT_EQ(old.size(), expected.size());
  EXPECT_EQ(old[2].tissue.reach.depth_exponent, 0.4);
  EXPECT_EQ(old[2].tissue.contact.tangential_damping, 0.0);
  for (haptics::ParameterUpdate& change : old) change.tissue.reach.depth_exponent = 0.5;
  EXPECT_EQ(old, expected) << "everything else is as recorded";
  EXPECT_THROW((void)read_without("friction", others), InputError) << "always was a parameter";
}

TEST(ParameterUpdatesRecorded, RemarksOfTheStabilityCheckComeBackWithAnOffer) {
  scene::Scene scene = block_and_ball();
  scene.devices[0].kind = "emulated";
  scene.devices[0].dynamics = {0.1, 0.1, 1e-5};
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  const std::unique_ptr<haptics::ParameterUpdates> changes = scene::make_parameter_updates(scene, world);
  model::TissueParameters stiff = scene.tissue;
  stiff.k1 *= 100.0;
  const haptics::ParameterUpdates::Accepted accepted = changes->offer(stiff);
  EXPECT_THAT(accepted.warnings, testing::Contains(HasSubstr("the device may tremble")));
}

TEST(ParameterUpdatesRecorded, AnInclusionThatBecomesTooHardForTheDeviceIsWarnedOf) {
  scene::Scene scene = block_and_ball();
  scene.devices[0].kind = "emulated";
  scene.inclusions = {{"lump", true, {Vec3(0.0, 0.0, 0.014), 4e-3, 1.0}}};  // 6 mm deep
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  const auto damping_needed = [&](double ratio) {
    const contact::TissueLaws laws(scene.tissue, 1.0 / scene.rate_Hz);
    const contact::StiffnessReach reach{model::Direction::kPress, scene.safety.max_force, 15e-3};
    std::vector<model::Inclusion> inclusions = world.contact.inclusions();
    inclusions[0].ratio = ratio;
    return 0.5 / scene.rate_Hz * contact::largest_stiffness(world.contact, laws, inclusions, 0, reach) +
           scene.tissue.contact.damping;
  };
  const double stone = damping_needed(100.0);
  const double uniform = damping_needed(1.0);
  scene.devices[0].dynamics = {0.5 * (uniform + stone), 100.0, 1e-6};
  EXPECT_THAT(scene::stability_remarks(scene, world), testing::IsEmpty());
  const std::unique_ptr<haptics::ParameterUpdates> changes = scene::make_parameter_updates(scene, world);
  const auto warnings_with = [&](double ratio) {
    return changes->offer(haptics::LiveInclusion{0, {0.0, 0.0, 0.014}, ratio}).warnings;
  };
  const auto trembles = testing::Contains(HasSubstr("the device may tremble"));
  EXPECT_THAT(warnings_with(100.0), trembles);
  EXPECT_THAT(changes->offer(scene.tissue).warnings, trembles) << "a later tissue has the hard inclusion";
  EXPECT_THAT(warnings_with(1.0), testing::IsEmpty());
}

TEST(RadiusRemarks, NameAnIndenterOfAnotherSizeThanTheTip) {
  scene::Scene scene = block_and_ball();
  const haptics::SimulationWorld world = scene::make_world(scene, prepared_once());
  EXPECT_THAT(scene::radius_remarks(scene, world), testing::IsEmpty()) << "the tissue does not say";
  scene.tissue.source = model::SourceParameters{"ball", 0.6 * kBallRadius};
  EXPECT_THAT(scene::radius_remarks(scene, world), testing::IsEmpty()) << "less than twofold";
  scene.tissue.source->radius = 0.4 * kBallRadius;
  EXPECT_THAT(scene::radius_remarks(scene, world),
              testing::ElementsAre(AllOf(HasSubstr("1.2 mm radius"), HasSubstr("'ball' has 3 mm"))));
  scene.tissue.source->radius = 2.5 * kBallRadius;
  EXPECT_THAT(scene::radius_remarks(scene, world), testing::SizeIs(1));
  scene.tissue.source->radius = 4.0 * kBallRadius;
  scene.tissue.size_exponent = 0.5;  // (1/4)^0.5 = 0.5
  EXPECT_THAT(scene::radius_remarks(scene, world),
              testing::ElementsAre(testing::EndsWith("; size_exponent = 0.5 multiplies it by 0.5")));
}

}  // namespace
}  // namespace palpate::record

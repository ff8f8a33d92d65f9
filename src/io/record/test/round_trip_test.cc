#include <bit>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/tissue_fields.h"
#include "io/record/scene_json.h"
#include "io/record/test/sample_recording.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::HasSubstr;

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> out;
  for (const double value : values) out.push_back(std::bit_cast<std::uint64_t>(value));
  return out;
}

void add_pose(const Pose& pose, std::vector<double>& out) {
  const Quat& q = pose.rotation;
  out.insert(out.end(),
             {pose.position.x(), pose.position.y(), pose.position.z(), q.w(), q.x(), q.y(), q.z()});
}

/// All numbers of a scene except those of the meshes, in one list.
std::vector<double> numbers(const scene::Scene& s) {
  const model::TissueParameters& t = s.tissue;
  std::vector<double> out = {s.rate_Hz,
                             t.source ? t.source->radius : -1,
                             s.noise.gain,
                             s.noise.threshold,
                             s.noise.rate_Hz,
                             s.safety.max_force,
                             s.safety.max_slew,
                             s.safety.max_torque,
                             s.safety.max_torque_slew};
  for (const model::TissueField& field : model::kTissueFields) out.push_back(field.at.get(t).value_or(-1));
  for (const model::RelaxationTerm& term : t.relaxation) out.insert(out.end(), {term.g, term.tau});
  add_pose(s.organ_pose, out);
  for (const geometry::Tool& tool : s.tools) {
    out.push_back(tool.tip_radius.value_or(-1));
    for (const geometry::ToolPart& part : tool.parts) {
      out.insert(out.end(), {part.pivot.x(), part.pivot.y(), part.pivot.z(), part.axis.x(), part.axis.y(),
                             part.axis.z(), part.open_angle});
    }
  }
  for (const scene::DeviceSetup& device : s.devices) {
    out.push_back(device.interpolation == scene::PathInterpolation::kCubic ? 1.0 : 0.0);
    out.push_back(device.path_speed);
    out.push_back(device.workspace_scale);
    out.push_back(device.dynamics.damping.value_or(-1));
    out.push_back(device.dynamics.friction.value_or(-1));
    out.push_back(device.dynamics.resolution.value_or(-1));
    out.push_back(device.clutch_button ? static_cast<double>(*device.clutch_button) : -1.0);
    add_pose(device.base, out);
  }
  return out;
}

/// All texts, flags and integers of a scene.
std::vector<std::string> words(const scene::Scene& s) {
  std::vector<std::string> out = {s.name,
                                  model::to_string(s.tissue.law),
                                  s.task == scene::Task::kPull ? "pull" : "press",
                                  std::to_string(s.seed),
                                  s.organ_name,
                                  s.tissue.name,
                                  s.tissue.source ? s.tissue.source->indenter : "",
                                  std::to_string(s.noise.enabled),
                                  std::to_string(s.noise.seed)};
  for (const geometry::Tool& tool : s.tools) {
    out.push_back(tool.name);
    for (const geometry::ToolPart& part : tool.parts) out.push_back(part.name + std::to_string(part.is_jaw));
  }
  for (const scene::DeviceSetup& device : s.devices) out.push_back(device.kind + device.path);
  out.insert(out.end(), s.repairs.begin(), s.repairs.end());
  out.insert(out.end(), s.remarks.begin(), s.remarks.end());
  return out;
}

void expect_same_mesh(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) EXPECT_EQ(a.vertices[i], b.vertices[i]);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(RoundTrip, SceneComesBackToTheBit) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 3, 2);
  const scene::Scene want = sample_setup(2);
  const scene::Scene got = read_recording(folder / "a.h5").scene;
  EXPECT_EQ(words(got), words(want));
  EXPECT_EQ(bits(numbers(got)), bits(numbers(want)));
  expect_same_mesh(got.organ, want.organ);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t p = 0; p < 2; ++p) {
      expect_same_mesh(got.tools.at(t).parts.at(p).mesh, want.tools[t].parts[p].mesh);
    }
  }
}

TEST(RoundTrip, OptionalValuesThatAreNotGivenStayNotGiven) {
  scene::Scene scene = sample_setup(1);
  scene.tissue.source.reset();
  scene.tissue.contact.tangential_stiffness.reset();
  scene.tools[0].tip_radius.reset();
  const scene::Scene got = scene_from_json(scene_to_json(scene));
  EXPECT_FALSE(got.tissue.source.has_value());
  EXPECT_FALSE(got.tissue.contact.tangential_stiffness.has_value());
  EXPECT_FALSE(got.tools[0].tip_radius.has_value());
}

TEST(RoundTrip, TheSupportOfTheOrganKeepsItsBits) {
  scene::Scene scene = sample_setup(1);
  EXPECT_FALSE(scene_from_json(scene_to_json(scene)).support);
  geometry::Support support;
  support.bed = geometry::Bed{Vec3(0.1 / 3, 2, -0.7), 0.1 / 3};
  support.attachments = {{Vec3(1e-3 / 3, 0, 1), 7e-3 / 3}, {Vec3(0, 0, -0.2), 5e-3}};
  scene.support = support;
  const scene::Scene got = scene_from_json(scene_to_json(scene));
  ASSERT_TRUE(got.support && got.support->bed);
  EXPECT_FALSE(got.support->faces);
  EXPECT_EQ(got.support->bed->direction, support.bed->direction);
  EXPECT_EQ(got.support->bed->share, support.bed->share);
  ASSERT_EQ(got.support->attachments.size(), 2U);
  EXPECT_EQ(got.support->attachments[0].point, support.attachments[0].point);
  EXPECT_EQ(got.support->attachments[0].radius, support.attachments[0].radius);
  EXPECT_TRUE(got.support->painted.empty());
  scene.support->painted = {{Vec3(1e-3 / 3, 0, 1), 2e-3 / 3}, {Vec3(0, 1e-3 / 7, 0), 2e-3}};
  const scene::Scene painted = scene_from_json(scene_to_json(scene));
  ASSERT_EQ(painted.support->painted.size(), 2U);
  EXPECT_EQ(painted.support->painted[1].point, scene.support->painted[1].point);
}

TEST(RoundTrip, MotionsOfTheOrganKeepTheirBits) {
  scene::Scene scene = sample_setup(1);
  model::OrganMotionParameters motion;
  motion.kind = model::OrganMotionKind::kHeartbeat;
  motion.amplitude = 0.1 / 3;
  motion.direction_W = Vec3(1, 2, 3).normalized();
  motion.rotation = -0.1 / 7;
  motion.axis_W = Vec3(3, -2, 1).normalized();
  motion.period = 60.0 / 70.0;
  motion.phase = 1.0 / 3.0;
  scene.organ_motion = {motion, model::OrganMotionParameters{}};
  const scene::Scene got = scene_from_json(scene_to_json(scene));
  ASSERT_EQ(got.organ_motion.size(), 2U);
  EXPECT_EQ(got.organ_motion[0].kind, motion.kind);
  EXPECT_EQ(got.organ_motion[0].amplitude, motion.amplitude);
  EXPECT_EQ(got.organ_motion[0].direction_W, motion.direction_W);
  EXPECT_EQ(got.organ_motion[0].rotation, motion.rotation);
  EXPECT_EQ(got.organ_motion[0].axis_W, motion.axis_W);
  EXPECT_EQ(got.organ_motion[0].period, motion.period);
  EXPECT_EQ(got.organ_motion[0].phase, motion.phase);
  EXPECT_EQ(got.organ_motion[1].kind, model::OrganMotionKind::kBreathing);
}

TEST(RoundTrip, ARecordingFromBeforeOrgansMovedHasAnOrganThatLiesStill) {
  std::string text = scene_to_json(sample_setup(1));
  const std::string motion = "\"motion\"";
  ASSERT_NE(text.find(motion), std::string::npos);
  text.replace(text.find(motion), motion.size(), "\"was_not\"");
  EXPECT_TRUE(scene_from_json(text).organ_motion.empty());
}

TEST(RoundTrip, AnEmulatedHandComesBackWithItsFaults) {
  scene::Scene scene = sample_setup(2);
  scene::DeviceSetup& device = scene.devices[1];
  device.kind = "emulated";
  device.emulated.mass = 0.1 / 3;
  device.emulated.grip = {123.4, 5.6 / 7};
  for (const scene::EmulatedFaultName& known : scene::emulated_fault_names()) {
    device.emulated.faults.push_back({known.kind, 1.0 / 3, 0.1, 7e-3});
  }
  const scene::Scene got = scene_from_json(scene_to_json(scene));
  const scene::EmulatedHand& hand = got.devices[1].emulated;
  EXPECT_EQ(hand.mass, 0.1 / 3);
  EXPECT_EQ(hand.grip.stiffness, 123.4);
  EXPECT_EQ(hand.grip.damping, 5.6 / 7);
  ASSERT_EQ(hand.faults.size(), scene::emulated_fault_names().size());
  for (std::size_t i = 0; i < hand.faults.size(); ++i) {
    EXPECT_EQ(hand.faults[i].kind, scene::emulated_fault_names()[i].kind);
    EXPECT_EQ(hand.faults[i].time, 1.0 / 3);
    EXPECT_EQ(hand.faults[i].duration, 0.1);
    EXPECT_EQ(hand.faults[i].age, 7e-3);
  }
  EXPECT_TRUE(got.devices[0].emulated.faults.empty()) << "an old recording, or another device, has none";
}

TEST(RoundTrip, AFaultOfAnUnknownKindIsRefused) {
  scene::Scene scene = sample_setup(1);
  scene.devices[0].kind = "emulated";
  scene.devices[0].emulated.faults.push_back({});
  std::string text = scene_to_json(scene);
  text.replace(text.find("\"freeze\""), 8, "\"flood!\"");
  EXPECT_THROW((void)scene_from_json(text), InputError);
}

TEST(RoundTrip, LawAndRelaxationComeBack) {
  scene::Scene scene = sample_setup(1);
  scene.tissue.law = model::LawKind::kSmooth;
  scene.tissue.relaxation = {{0.1, 0.1 + 0.2}, {0.3, 7.0}};
  const model::TissueParameters got = scene_from_json(scene_to_json(scene)).tissue;
  EXPECT_EQ(got.law, model::LawKind::kSmooth);
  ASSERT_EQ(got.relaxation.size(), 2U);
  EXPECT_EQ(got.relaxation[0].g, 0.1);
  EXPECT_EQ(got.relaxation[0].tau, 0.1 + 0.2);
}

/// The tissue of a recorded scene without these keys, as older recordings have it.
model::TissueParameters tissue_without(const scene::Scene& scene, const std::vector<std::string>& keys) {
  std::string text = scene_to_json(scene);
  for (const std::string& key : keys) {
    const std::size_t at = text.find("\"" + key + "\"");
    EXPECT_NE(at, std::string::npos) << key;
    text.replace(at + 1, key.size(), "was_not_" + key);
  }
  return scene_from_json(text).tissue;
}

TEST(RoundTrip, ARecordingFromBeforeThereWereLawsHasThePapersWithoutRelaxation) {
  scene::Scene scene = sample_setup(1);
  scene.tissue.law = model::LawKind::kSmooth;
  scene.tissue.relaxation = {{0.1, 0.3}};
  const model::TissueParameters got = tissue_without(scene, {"law", "relaxation"});
  EXPECT_EQ(got.law, model::LawKind::kLayered);
  EXPECT_TRUE(got.relaxation.empty());
}

TEST(RoundTrip, ANumberThatAnOldRecordingLacksHasItsDefault) {
  scene::Scene scene = sample_setup(1);
  scene.tissue.reach.depth_exponent = 0.4;
  scene.tissue.contact.tangential_damping = 0.75;
  EXPECT_EQ(tissue_without(scene, {"depth_exponent"}).reach.depth_exponent, 0.5);
  EXPECT_EQ(tissue_without(scene, {"tangential_damping_N_s_per_m"}).contact.tangential_damping, 0.0);
  EXPECT_ANY_THROW((void)tissue_without(scene, {"grip_limit_N"})) << "always was a parameter";
}

TEST(RoundTrip, AMotionOfAnotherKindIsRefused) {
  scene::Scene scene = sample_setup(1);
  scene.organ_motion.emplace_back();
  std::string text = scene_to_json(scene);
  text.replace(text.find("breathing"), 9, "digesting");
  EXPECT_THROW((void)scene_from_json(text), InputError);
}

TEST(RoundTrip, SceneWithAMissingKeyIsRefusedWithItsName) {
  std::string text = scene_to_json(sample_setup(1));
  text.replace(text.find("grip_limit_N"), 12, "grop_limit_N");
  try {
    (void)scene_from_json(text);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("grip_limit_N"));
  }
}

TEST(RoundTrip, SceneThatIsNoJsonOrHasAnotherTaskIsRefused) {
  EXPECT_THROW((void)scene_from_json("{"), InputError);
  EXPECT_THROW((void)scene_from_json("[1]"), InputError);
  std::string text = scene_to_json(sample_setup(1));
  text.replace(text.find("\"pull\""), 6, "\"push\"");
  EXPECT_THROW((void)scene_from_json(text), InputError);
}

class RoundTripRows : public ::testing::TestWithParam<std::pair<std::uint64_t, std::size_t>> {};

TEST_P(RoundTripRows, ComeBackToTheBit) {
  const auto [ticks, hands] = GetParam();
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", ticks, hands);
  const Recording recording = read_recording(folder / "a.h5");
  ASSERT_EQ(recording.rows.size(), ticks * hands);
  for (std::size_t i = 0; i < recording.rows.size(); ++i) {
    ASSERT_TRUE(same_bits(recording.rows[i], sample_row(i / hands, static_cast<std::uint32_t>(i % hands))))
        << i;
  }
}

// No row, one, a chunk (1024) and its neighbours, more than the ring (8192), hands that do not divide a
// chunk.
INSTANTIATE_TEST_SUITE_P(Sizes, RoundTripRows,
                         ::testing::Values(std::pair{0, 1}, std::pair{1, 1}, std::pair{1023, 1},
                                           std::pair{1024, 1}, std::pair{1025, 1}, std::pair{60000, 1},
                                           std::pair{5000, 3}));

TEST(RoundTrip, FactsComeBack) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 10, 1);
  const RunFacts facts = read_recording(folder / "a.h5").facts;
  EXPECT_TRUE(facts.complete);
  EXPECT_TRUE(facts.offline);
  EXPECT_EQ(facts.started_unix_ns, kStarted);
  EXPECT_EQ(facts.missed_deadlines, 7U);
  EXPECT_EQ(facts.longest_gap_ns, 123456);
  EXPECT_TRUE(facts.realtime_priority);
  EXPECT_TRUE(facts.memory_locked);
  EXPECT_TRUE(facts.polled);
  EXPECT_EQ(facts.tick_time.p50_ns, 500);
  EXPECT_EQ(facts.lateness.max_ns, 900);
  ASSERT_EQ(facts.tick_histogram.size(), 1U);
  EXPECT_EQ(facts.tick_histogram[0].upper, 500);
  EXPECT_EQ(facts.tick_histogram[0].count, 1U);
  ASSERT_EQ(facts.late_histogram.size(), 1U);
  EXPECT_EQ(facts.late_histogram[0].upper, 900);
  EXPECT_EQ(facts.watchdog_stops, 3U);
  EXPECT_EQ(facts.remarks, (std::vector<std::string>{"no priority: not allowed", "second remark"}));
  EXPECT_FALSE(facts.version.empty());
  EXPECT_FALSE(facts.compiler.empty());
  EXPECT_FALSE(facts.machine.empty());
}

TEST(RoundTrip, ARecordingFromBeforeThereWereHistogramsIsReadWithoutThem) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 10, 1);
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  EXPECT_GE(H5Ldelete(file, "run/tick_histogram_ns", H5P_DEFAULT), 0);
  EXPECT_GE(H5Ldelete(file, "run/watchdog_stops", H5P_DEFAULT), 0);
  H5Fclose(file);
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_EQ(recording.rows.size(), 10U);
  EXPECT_TRUE(recording.facts.tick_histogram.empty());
  EXPECT_EQ(recording.facts.late_histogram.size(), 1U);
  EXPECT_EQ(recording.facts.watchdog_stops, 0U);
  EXPECT_EQ(recording.facts.tick_time.p50_ns, 500);
}

TEST(RoundTrip, AHistogramThatIsNoneIsLeftOut) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 10, 1);
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t dataset = H5Dopen2(file, "run/late_histogram_ns", H5P_DEFAULT);
  const hsize_t shape[2] = {2, 2};
  const std::int64_t falling[4] = {900, 1, 800, 1};
  EXPECT_GE(H5Dset_extent(dataset, shape), 0);
  EXPECT_GE(H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, falling), 0);
  H5Dclose(dataset);
  H5Fclose(file);
  EXPECT_TRUE(read_recording(folder / "a.h5").facts.late_histogram.empty());
}

TEST(Recorder, FileAppearsOnlyWhenTheRunBegins) {
  const TemporaryFolder folder;
  Recorder recorder(folder / "a.h5", sample_setup(1), false);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  recorder.on_start(kStarted);
  for (int i = 0; i < 1000 && !std::filesystem::exists(folder / "a.h5"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "a.h5"));
  recorder.finish({});
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(Recorder, RunThatNeverBeginsLeavesNothing) {
  const TemporaryFolder folder;
  {
    Recorder recorder(folder / "a.h5", sample_setup(1), false);
    recorder.finish({});
  }
  { const Recorder recorder(folder / "b.h5", sample_setup(1), false); }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Recorder, OlderFileStaysUntilTheRunBeginsAndIsReplacedThen) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "old";
  { const Recorder recorder(folder / "a.h5", sample_setup(1), true); }
  EXPECT_EQ(contents(folder / "a.h5"), "old");
  record_sample(folder / "a.h5", 2, 1);
  EXPECT_EQ(read_recording(folder / "a.h5").rows.size(), 2U);
}

TEST(Recorder, WithoutFinishTheFileIsWholeButNotComplete) {
  const TemporaryFolder folder;
  {
    Recorder recorder(folder / "a.h5", sample_setup(1), true);
    recorder.on_start(kStarted);
    recorder.on_row(sample_row(0, 0));
  }
  EXPECT_TRUE(opens_plainly(folder / "a.h5"));
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_EQ(recording.rows.size(), 1U);
  EXPECT_FALSE(recording.facts.complete);
}

TEST(Recorder, FolderThatIsNotThereIsRefusedWithTheFilesName) {
  const TemporaryFolder folder;
  try {
    const Recorder recorder(folder / "none/a.h5", sample_setup(1), true);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("none/a.h5"));
  }
  EXPECT_THROW(Recorder("/", sample_setup(1), true), InputError);
}

TEST(Recorder, RecordingCanBeReadWhileItGrows) {
  const TemporaryFolder folder;
  Recorder recorder(folder / "a.h5", sample_setup(1), true);
  recorder.on_start(kStarted);
  for (std::uint64_t tick = 0; tick < 20000; ++tick) recorder.on_row(sample_row(tick, 0));
  std::size_t rows = 0;
  for (int i = 0; i < 1000 && rows < 20000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (std::filesystem::exists(folder / "a.h5")) rows = read_recording(folder / "a.h5").rows.size();
  }
  EXPECT_EQ(rows, 20000U);
  EXPECT_THROW((void)repair_recording(folder / "a.h5"), InputError);
  recorder.finish({});
  EXPECT_EQ(read_recording(folder / "a.h5").rows.size(), 20000U);
}

}  // namespace
}  // namespace palpate::record

// The C interface gives the same rows as `palpate run --offline`, bit for bit.
#include <cfenv>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include "palpate/recording.h"

#include "bindings/c/test/c_session.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

// NOLINTBEGIN(bugprone-suspicious-memory-comparison): compares bits, with -0 and NaN

/// One experiment, as arguments of the program and as options of the interface.
struct Experiment {
  const char* name;
  std::vector<std::string> words;
  const char* scene_file;  // null: the built-in scene of `task`
  const char* task;
};

const Experiment kExperiments[] = {
    {"Press", {}, nullptr, nullptr},
    {"Pull", {"--task", "pull"}, nullptr, "pull"},
    {"TwoHands", {PALPATE_EXAMPLES "/bimanual.toml"}, PALPATE_EXAMPLES "/bimanual.toml", nullptr},
};

record::Recording program_run(const std::vector<std::string>& words) {
  const Folder folder;
  std::vector<std::string> all = {"run", "--offline", "--headless", "--record", "run.h5"};
  all.insert(all.end(), words.begin(), words.end());
  const Outcome outcome = run(folder, all);
  if (outcome.exit_code != 0) throw std::runtime_error(outcome.err);
  return record::read_recording(folder / "run.h5");
}

template <std::size_t kSize>
bool same(const std::array<double, kSize>& a, const double (&b)[kSize]) {
  return std::memcmp(a.data(), b, sizeof b) == 0;
}
bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Name of the first field that differs between result and row; empty: none.
std::string difference(const haptics::TickRow& row, const palpate_result& result) {
  if (row.tick != result.tick || !same(row.time, result.time)) return "tick";
  if (!same(row.force, result.force)) return "force";
  if (!same(row.torque, result.torque)) return "torque";
  if (!same(row.gripper_force, result.gripper_force)) return "gripper_force";
  if (!same(row.tissue_force, result.tissue_force)) return "tissue_force";
  if (!same(row.noise_force, result.noise_force)) return "noise_force";
  if (!same(row.friction, result.friction)) return "friction";
  if (!same(row.distance, result.distance)) return "distance";
  if (!same(row.depth, result.depth)) return "depth";
  if (!same(row.contact, result.contact)) return "contact";
  if (!same(row.normal, result.normal)) return "normal";
  if (!same(row.tool, result.tool_position)) return "tool_position";
  if (!same(row.tool_q, result.tool_orientation)) return "tool_orientation";
  if (!same(row.gripper, result.gripper)) return "gripper";
  if (!same(row.energy, result.energy)) return "energy";
  if (!same(row.engagement, result.engagement)) return "engagement";
  if (row.phase != result.phase) return "phase";
  if (row.cutoff_layer != result.cutoff_layer) return "cutoff_layer";
  if (row.saturated != result.saturated) return "saturated";
  if (row.status != result.status) return "status";
  return row.fault == result.fault ? "" : "fault";
}

palpate_sample sample_in(const haptics::TickRow& row) {
  palpate_sample sample = fresh<palpate_sample>();
  std::copy(row.device.begin(), row.device.end(), sample.position);
  std::copy(row.device_q.begin(), row.device_q.end(), sample.orientation);
  std::copy(row.device_velocity.begin(), row.device_velocity.end(), sample.velocity);
  sample.gripper = row.device_gripper;
  sample.age = row.device_age;
  sample.buttons = row.buttons;
  sample.fault = row.device_fault;
  return sample;
}

palpate_options options_of(const Experiment& experiment) {
  palpate_options options = unheld();
  options.scene_file = experiment.scene_file;
  options.task = experiment.task;
  return options;
}

class SameRows : public testing::TestWithParam<Experiment> {};

TEST_P(SameRows, AsTheProgramsBitForBit) {
  const record::Recording recording = program_run(GetParam().words);
  Session session(options_of(GetParam()));
  ASSERT_GT(recording.rows.size(), 5000U);
  ASSERT_EQ(recording.rows.size(), session.info.scripted_ticks * session.info.hands);
  bool touched = false;
  for (std::size_t first = 0; first < recording.rows.size(); first += session.info.hands) {
    for (std::size_t hand = 0; hand < session.info.hands; ++hand) {
      session.samples[hand] = sample_in(recording.rows[first + hand]);
    }
    session.tick();
    for (std::size_t hand = 0; hand < session.info.hands; ++hand) {
      const haptics::TickRow& row = recording.rows[first + hand];
      ASSERT_EQ(difference(row, session.results[hand]), "") << "tick " << row.tick << " hand " << hand;
      touched = touched || row.phase != 0;
    }
  }
  EXPECT_TRUE(touched);
}

TEST_P(SameRows, AlsoWithTheScriptedSamplesThatTheInterfaceGives) {
  const record::Recording recording = program_run(GetParam().words);
  Session session(options_of(GetParam()));
  for (const haptics::TickRow& row : recording.rows) {
    if (row.hand == 0) session.run(row.tick, row.tick + 1);
    ASSERT_EQ(difference(row, session.results[row.hand]), "") << "tick " << row.tick;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SameRows, testing::ValuesIn(kExperiments),
                         [](const auto& info) { return std::string(info.param.name); });

// An emulated hand that holds the device, so that its samples depend on the previous forces.
TEST(HeldDevice, HasTheRowsOfTheProgramsOwnEmulatedHand) {
  const Folder folder;
  std::ofstream(folder / "held.toml")
      << "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"curved-forceps\"\n"
         "[device]\nkind = \"emulated\"\n";
  const record::Recording recording = program_run({folder / "held.toml"});
  const std::string scene = folder / "held.toml";
  palpate_options options = fresh<palpate_options>();
  options.scene_file = scene.c_str();
  Session session(options);
  EXPECT_EQ(session.info.held, 1U);
  for (const haptics::TickRow& row : recording.rows) {
    session.samples[0] = sample_in(row);
    session.tick();
    ASSERT_EQ(difference(row, session.results[0]), "") << "tick " << row.tick;
  }
  EXPECT_EQ(session.results[0].engagement, 1.0);
}

// Game engines flush denormal numbers to zero, and some change the rounding mode.
TEST(FloatEnvironment, OfTheProgramAroundChangesNoBitAndIsAsItWasAfterwards) {
  Session plain(unheld());
  Session strange(unheld());
  constexpr std::uint64_t kTicks = 2500;
  for (std::uint64_t number = 0; number < kTicks; ++number) {
    plain.run(number, number + 1);
    const unsigned before = _mm_getcsr();
    std::fesetround(FE_UPWARD);
    _mm_setcsr(_mm_getcsr() | 0x8040U);  // flush to zero, denormals are zero
    const unsigned strange_bits = _mm_getcsr() & ~0x3FU;
    strange.run(number, number + 1);
    const unsigned after = _mm_getcsr() & ~0x3FU;
    std::fesetround(FE_TONEAREST);
    _mm_setcsr(before);
    ASSERT_EQ(after, strange_bits);
    ASSERT_EQ(std::memcmp(plain.results.data(), strange.results.data(), sizeof(palpate_result)), 0) << number;
  }
  EXPECT_GT(plain.results[0].depth, 0.0);
}

TEST(Restart, GivesTheSameRowsAgain) {
  Session session(unheld());
  constexpr std::uint64_t kTicks = 2000;
  session.run(0, kTicks);
  const palpate_result first = session.results[0];
  require(palpate_restart(session.get()));
  session.run(0, kTicks);
  EXPECT_EQ(std::memcmp(&first, session.results.data(), sizeof first), 0);
}

// NOLINTEND(bugprone-suspicious-memory-comparison)

}  // namespace
}  // namespace palpate::tests

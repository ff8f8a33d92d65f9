// Inclusions through the C interface.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/recording.h"

#include "bindings/c/test/c_session.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;

constexpr const char* kScene =
    "[organ]\nmesh = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n"
    "[[organ.inclusion]]\npreset = \"nodule\"\n"
    "[[organ.inclusion]]\nname = \"secret\"\nradius_mm = 2\nstiffness_ratio = 20\ndepth_mm = 15\n"
    "visible = false\n";

palpate_options with_inclusions() {
  palpate_options options = unheld();
  options.scene_text = kScene;
  return options;
}

palpate_inclusion inclusion_of(const Session& session, std::size_t index) {
  palpate_inclusion inclusion = fresh<palpate_inclusion>();
  require(palpate_get_inclusion(session.get(), index, &inclusion));
  return inclusion;
}

/// The tissue's force at the end of the way in.
double force_after(Session& session, std::uint64_t first, std::uint64_t last) {
  session.run(first, last);
  return session.results[0].tissue_force;
}

constexpr std::uint64_t kDeep = 2400;

TEST(Inclusions, OfTheSceneAreListedWithTheHiddenOnes) {
  Session session(with_inclusions());
  ASSERT_EQ(palpate_inclusion_count(session.get()), 2U);
  const palpate_inclusion nodule = inclusion_of(session, 0);
  EXPECT_STREQ(nodule.name, "nodule");
  EXPECT_EQ(nodule.visible, 1);
  EXPECT_GT(nodule.radius, 1e-3);
  const palpate_inclusion secret = inclusion_of(session, 1);
  EXPECT_STREQ(secret.name, "secret");
  EXPECT_EQ(secret.visible, 0);
  EXPECT_EQ(secret.radius, 2e-3);
  EXPECT_EQ(secret.stiffness_ratio, 20.0);
  Session plain(unheld());
  EXPECT_EQ(palpate_inclusion_count(plain.get()), 0U);
  EXPECT_EQ(palpate_inclusion_count(nullptr), 0U);
}

TEST(Inclusions, ThatSoftenDuringTheRunLowerTheForceAndTheChangeIsReplayed) {
  const Folder folder;
  const std::string file = folder / "run.h5";
  Session stiff(with_inclusions());
  const double force = force_after(stiff, 0, kDeep);
  Session session(recorded(with_inclusions(), file));
  session.run(0, kDeep / 2);
  palpate_inclusion nodule = inclusion_of(session, 0);
  nodule.stiffness_ratio = 0.1;
  require(palpate_set_inclusion(session.get(), 0, &nodule));
  EXPECT_EQ(inclusion_of(session, 0).stiffness_ratio, 0.1);
  EXPECT_LT(force_after(session, kDeep / 2, kDeep), 0.9 * force);
  ASSERT_EQ(session.close(), PALPATE_OK) << palpate_last_error();
  const record::Recording recording = record::read_recording(file);
  ASSERT_EQ(recording.changes.size(), 1U);
  EXPECT_EQ(recording.changes[0].tick, kDeep / 2);
  EXPECT_EQ(recording.changes[0].inclusion.ratio, 0.1);
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

TEST(Inclusions, AreThoseOfTheSceneAgainAfterARestart) {
  Session session(with_inclusions());
  const double force = force_after(session, 0, kDeep);
  palpate_inclusion nodule = inclusion_of(session, 0);
  const double ratio = nodule.stiffness_ratio;
  nodule.stiffness_ratio = 0.1;
  require(palpate_set_inclusion(session.get(), 0, &nodule));
  require(palpate_restart(session.get()));
  EXPECT_EQ(inclusion_of(session, 0).stiffness_ratio, ratio);
  EXPECT_EQ(force_after(session, 0, kDeep), force);
}

TEST(Inclusions, ThatAreInvalidAreRefusedAndNothingChanges) {
  Session session(with_inclusions());
  palpate_inclusion nodule = inclusion_of(session, 0);
  EXPECT_EQ(palpate_set_inclusion(session.get(), 2, &nodule), PALPATE_ERROR_USE);
  EXPECT_THAT(palpate_last_error(), HasSubstr("palpate_inclusion_count"));
  EXPECT_EQ(palpate_get_inclusion(session.get(), 2, &nodule), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_set_inclusion(nullptr, 0, &nodule), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_set_inclusion(session.get(), 0, nullptr), PALPATE_ERROR_USE);
  palpate_inclusion hard = nodule;
  hard.stiffness_ratio = 101.0;
  EXPECT_EQ(palpate_set_inclusion(session.get(), 0, &hard), PALPATE_ERROR_INPUT);
  EXPECT_THAT(palpate_last_error(), HasSubstr("stiffness_ratio = 101"));
  palpate_inclusion outside = nodule;
  outside.position[2] += 0.5;
  EXPECT_EQ(palpate_set_inclusion(session.get(), 0, &outside), PALPATE_ERROR_INPUT);
  EXPECT_THAT(palpate_last_error(), HasSubstr("outside the organ"));
  palpate_inclusion other_version = nodule;
  other_version.struct_size += 8;
  EXPECT_EQ(palpate_set_inclusion(session.get(), 0, &other_version), PALPATE_ERROR_USE);
  EXPECT_EQ(inclusion_of(session, 0).stiffness_ratio, nodule.stiffness_ratio);
  EXPECT_EQ(inclusion_of(session, 0).position[2], nodule.position[2]);
}

}  // namespace
}  // namespace palpate::tests

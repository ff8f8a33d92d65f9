#include "io/scene/builtin_scenes.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::scene {
namespace {

TEST(BuiltinScenes, HaveTheTextOfTheirFiles) {
  for (const BuiltinScene& one : builtin_scenes()) {
    std::ifstream file(std::string(PALPATE_REPOSITORY "/") + std::string(one.file));
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(one.toml, text) << one.file;
  }
}

TEST(BuiltinScenes, HaveANameOfTheirOwnAndOneLine) {
  std::set<std::string_view> names;
  for (const BuiltinScene& one : builtin_scenes()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_FALSE(one.title.empty());
    EXPECT_LE(one.line.size(), 90U);
    EXPECT_THAT(std::string(one.line), ::testing::EndsWith("."));
  }
  EXPECT_EQ(names.size(), 8U);
}

TEST(BuiltinScenes, GiveEachHandTheRequestedDevice) {
  for (const BuiltinScene& one : builtin_scenes()) {
    const Scene scene = load(request_of(one, "mouse"));
    ASSERT_EQ(scene.devices.size(), one.name == "bimanual" ? 2U : 1U) << one.name;
    for (const DeviceSetup& device : scene.devices) EXPECT_EQ(device.kind, "mouse") << one.name;
  }
}

TEST(BuiltinScenes, OfPressPullAndInsertAreTheDefaultScenes) {
  for (const char* const task : {"press", "pull", "insert"}) {
    Overrides by_default;
    by_default.task = task;
    const Scene expected = load(by_default);
    const auto builtin = std::find_if(builtin_scenes().begin(), builtin_scenes().end(),
                                      [task](const BuiltinScene& one) { return one.name == task; });
    ASSERT_NE(builtin, builtin_scenes().end());
    const Scene scene = load(request_of(*builtin, "scripted"));
    EXPECT_EQ(scene.name, expected.name);
    EXPECT_EQ(scene.task, expected.task);
    EXPECT_EQ(scene.organ_name, expected.organ_name);
    EXPECT_EQ(scene.tools[0].name, expected.tools[0].name);
    EXPECT_EQ(scene.tissue, expected.tissue);
  }
}

}  // namespace
}  // namespace palpate::scene

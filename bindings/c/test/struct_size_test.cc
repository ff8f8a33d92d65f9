// Programs that were compiled with an older palpate.h pass shorter structs. A struct may end wherever the
// fields of a newer header may begin: at every eighth byte.
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

#include "bindings/c/test/c_session.h"

namespace palpate::tests {
namespace {

using ::testing::HasSubstr;

/// Sizes of older structs: at least one field.
template <typename Struct>
std::vector<std::size_t> older_sizes() {
  std::vector<std::size_t> sizes;
  for (std::size_t size = 2 * sizeof(std::size_t); size < sizeof(Struct); size += 8) sizes.push_back(size);
  return sizes;
}

/// `count` structs of `size` bytes each, one behind the other, and guards behind the last.
template <typename Struct>
class Older final {
 public:
  Older(std::span<const Struct> whole, std::size_t size)
      : size_(size), memory_(whole.size() * size / 8 + sizeof(Struct) / 8, kGuards) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      Struct one = whole[i];
      one.struct_size = size;
      std::memcpy(bytes() + i * size, &one, size);
    }
  }
  Older(const Struct& whole, std::size_t size) : Older(std::span(&whole, 1), size) {}

  [[nodiscard]] Struct* get() { return reinterpret_cast<Struct*>(memory_.data()); }
  [[nodiscard]] const std::byte* bytes() const { return reinterpret_cast<const std::byte*>(memory_.data()); }

  /// Expects the fields of `whole` as far as they go, and untouched guards.
  void expect(std::span<const Struct> whole) const {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      Struct one = whole[i];
      one.struct_size = size_;
      EXPECT_EQ(std::memcmp(bytes() + i * size_, &one, size_), 0)
          << "struct " << i << " of " << size_ << " bytes";
    }
    for (std::size_t word = whole.size() * size_ / 8; word < memory_.size(); ++word) {
      EXPECT_EQ(memory_[word], kGuards) << "behind structs of " << size_ << " bytes";
    }
  }
  void expect(const Struct& whole) const { expect(std::span(&whole, 1)); }

 private:
  static constexpr std::uint64_t kGuards = 0xEEEEEEEEEEEEEEEE;
  std::byte* bytes() { return reinterpret_cast<std::byte*>(memory_.data()); }
  std::size_t size_;
  std::vector<std::uint64_t> memory_;
};

/// Expects that `call` fills older structs with the fields that they have.
template <typename Struct, typename Call>
void expect_filled(const Call& call) {
  Struct whole = fresh<Struct>();
  require(call(&whole));
  for (const std::size_t size : older_sizes<Struct>()) {
    Older<Struct> older(fresh<Struct>(), size);
    require(call(older.get()));
    older.expect(whole);
  }
}

/// A session of the bimanual example.
Session two_hands() {
  palpate_options options = unheld();
  options.scene_file = PALPATE_EXAMPLES "/bimanual.toml";
  return Session(options);
}

TEST(OlderStruct, OfOptionsHasTheDefaultsOfTheFieldsThatItLacks) {
  const test::TemporaryFolder cache;  // the oldest options cannot switch the cache off
  setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  palpate_options options = unheld();
  options.surface_edge = 2e-3;
  for (const std::size_t size : older_sizes<palpate_options>()) {
    Older<palpate_options> older(options, size);
    palpate_simulation* simulation = nullptr;
    require(palpate_open(older.get(), &simulation));
    palpate_info info = fresh<palpate_info>();
    require(palpate_get_info(simulation, &info));
    EXPECT_EQ(info.held, size > offsetof(palpate_options, no_hand) ? 0U : 1U) << size;
    EXPECT_EQ(info.vertices == 1057, size <= offsetof(palpate_options, surface_edge)) << size;
    palpate_close(simulation);
  }
}

TEST(OlderStruct, OfASampleIsAtRestInWhatItLacks) {
  Session session(unheld());
  const std::uint64_t middle = session.info.scripted_ticks / 2;
  session.run(0, middle);
  palpate_sample moving = session.samples[0];
  for (double& number : moving.orientation) number = 0.5;
  moving.velocity[0] = moving.gripper = 0.5;
  moving.age = 1e-3;
  moving.buttons = 1;
  for (const std::size_t size : older_sizes<palpate_sample>()) {
    palpate_sample resting = fresh<palpate_sample>();
    resting.orientation[0] = 1.0;
    std::memcpy(reinterpret_cast<std::byte*>(&resting) + sizeof(std::size_t),
                reinterpret_cast<const std::byte*>(&moving) + sizeof(std::size_t),
                size - sizeof(std::size_t));
    const bool cuts_quaternion =
        size > offsetof(palpate_sample, orientation) && size < offsetof(palpate_sample, velocity);
    palpate_result expected = fresh<palpate_result>();
    palpate_result found = fresh<palpate_result>();
    require(palpate_restart(session.get()));
    require(palpate_tick(session.get(), &resting, &expected, 1));
    require(palpate_restart(session.get()));
    Older<palpate_sample> older(moving, size);
    require(palpate_tick(session.get(), older.get(), &found, 1));
    EXPECT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << size;
    EXPECT_EQ(found.fault == 0, !cuts_quaternion) << size;
  }
}

TEST(OlderStruct, OfResultsOfTwoHandsAreFilledAsFarAsTheyGo) {
  const Session session = two_hands();
  for (const std::size_t size : older_sizes<palpate_result>()) {
    std::vector<palpate_sample> samples(2, fresh<palpate_sample>());
    std::vector<palpate_result> whole(2, fresh<palpate_result>());
    for (const std::uint32_t hand : {0U, 1U}) {
      require(palpate_scripted_sample(session.get(), hand, 0, &samples[hand]));
    }
    require(palpate_restart(session.get()));
    require(palpate_tick(session.get(), samples.data(), whole.data(), 2));
    ASSERT_NE(whole[0].tool_position[0], whole[1].tool_position[0]);
    require(palpate_restart(session.get()));
    Older<palpate_result> results(std::vector(2, fresh<palpate_result>()), size);
    Older<palpate_sample> older_samples(samples, offsetof(palpate_sample, velocity));
    require(palpate_tick(session.get(), older_samples.get(), results.get(), 2));
    results.expect(whole);
  }
}

TEST(OlderStruct, ThatAFunctionFillsIsFilledAsFarAsItGoes) {
  palpate_options options = unheld();
  options.scene_file = PALPATE_EXAMPLES "/liver-nodule.toml";
  const Session session(options);
  expect_filled<palpate_info>([&](palpate_info* to) { return palpate_get_info(session.get(), to); });
  expect_filled<palpate_sample>(
      [&](palpate_sample* to) { return palpate_scripted_sample(session.get(), 0, 500, to); });
  expect_filled<palpate_part>([&](palpate_part* to) { return palpate_tool_part(session.get(), 0, 0, to); });
  expect_filled<palpate_picture>(
      [&](palpate_picture* to) { return palpate_surface_update(session.get(), to); });
  expect_filled<palpate_inclusion>(
      [&](palpate_inclusion* to) { return palpate_get_inclusion(session.get(), 0, to); });
  palpate_law* law = nullptr;
  require(palpate_law_open("liver", "press", 1000.0, &law));
  expect_filled<palpate_response>([&](palpate_response* to) { return palpate_law_force_at(law, 3e-3, to); });
  palpate_law_close(law);
}

TEST(OlderStruct, OfAnInclusionKeepsTheStiffnessRatioThatItLacks) {
  palpate_options options = unheld();
  options.scene_file = PALPATE_EXAMPLES "/liver-nodule.toml";
  const Session session(options);
  palpate_inclusion inclusion = fresh<palpate_inclusion>();
  require(palpate_get_inclusion(session.get(), 0, &inclusion));
  const double ratio = inclusion.stiffness_ratio;
  const double moved = inclusion.position[2] - 1e-3;
  inclusion.position[2] = moved;
  inclusion.stiffness_ratio = 2.0 * ratio;
  Older<palpate_inclusion> older(inclusion, offsetof(palpate_inclusion, stiffness_ratio));
  require(palpate_set_inclusion(session.get(), 0, older.get()));
  require(palpate_get_inclusion(session.get(), 0, &inclusion));
  EXPECT_EQ(inclusion.position[2], moved);
  EXPECT_EQ(inclusion.stiffness_ratio, ratio);
}

TEST(NewerStruct, OrOneOfNoHeaderIsRefused) {
  const Session session(unheld());
  for (const std::size_t size :
       {std::size_t{0}, sizeof(std::size_t), sizeof(palpate_info) - 4, sizeof(palpate_info) + 8}) {
    palpate_info info{};
    info.struct_size = size;
    EXPECT_EQ(palpate_get_info(session.get(), &info), PALPATE_ERROR_USE) << size;
    EXPECT_THAT(palpate_last_error(), HasSubstr("palpate_info.struct_size = " + std::to_string(size)));
    EXPECT_EQ(info.hands, 0U);
  }
}

TEST(NewerStruct, InOneOfTwoHandsIsRefusedWithoutATick) {
  Session session = two_hands();
  session.script(0);
  session.samples[1].struct_size -= 8;
  EXPECT_EQ(palpate_tick(session.get(), session.samples.data(), session.results.data(), 2),
            PALPATE_ERROR_USE);
  session.samples[1].struct_size += 8;
  session.tick();
  EXPECT_EQ(session.results[0].tick, 0U);
}

}  // namespace
}  // namespace palpate::tests

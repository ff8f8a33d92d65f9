#include "io/system/cache_folder.h"

#include <chrono>
#include <cstdlib>
#include <optional>

#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

/// Sets an environment variable and restores it.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    set(value);
  }
  ~Variable() { set(old_ ? old_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) const {
    if (value == nullptr) {
      unsetenv(name_);
    } else {
      setenv(name_, value, 1);
    }
  }
  const char* name_;
  std::optional<std::string> old_;
};

fs::path folder_of(const char* cache, const char* xdg, const char* home) {
  const Variable a("PALPATE_CACHE", cache);
  const Variable b("XDG_CACHE_HOME", xdg);
  const Variable c("HOME", home);
  return user_cache_folder();
}

TEST(StateFolder, IsTheUsersOwnByTheEnvironmentOrUnderHome) {
  const Variable off("PALPATE_CACHE", "off");
  const Variable home("HOME", "/people/ada");
  {
    const Variable given("XDG_STATE_HOME", "/var/state");
    EXPECT_EQ(user_state_folder(), "/var/state/palpate") << "the cache being off is no matter";
  }
  const Variable relative("XDG_STATE_HOME", "state");
  EXPECT_EQ(user_state_folder(), "/people/ada/.local/state/palpate");
  const Variable homeless("HOME", nullptr);
  EXPECT_EQ(user_state_folder(), "");
}

TEST(ConfigFolder, IsTheUsersOwnByTheEnvironmentOrUnderHome) {
  const Variable home("HOME", "/people/ada");
  {
    const Variable given("XDG_CONFIG_HOME", "/etc/ada");
    EXPECT_EQ(user_config_folder(), "/etc/ada/palpate");
  }
  const Variable relative("XDG_CONFIG_HOME", "config");
  EXPECT_EQ(user_config_folder(), "/people/ada/.config/palpate") << "never below the current folder";
  const Variable homeless("HOME", nullptr);
  EXPECT_EQ(user_config_folder(), "");
}

TEST(CacheFolder, IsTheUsersByTheXdgRule) {
  EXPECT_EQ(folder_of(nullptr, "/x/cache", "/h"), "/x/cache/palpate");
  EXPECT_EQ(folder_of(nullptr, nullptr, "/h"), "/h/.cache/palpate");
  EXPECT_EQ(folder_of(nullptr, "", "/h"), "/h/.cache/palpate");
  EXPECT_EQ(folder_of(nullptr, "relative", "/h"),
            "/h/.cache/palpate");  // relative: ignored
  EXPECT_TRUE(folder_of(nullptr, nullptr, nullptr).empty());
}

TEST(CacheFolder, IsNoneWhenTurnedOff) {
  EXPECT_TRUE(folder_of("off", "/x/cache", "/h").empty());
  EXPECT_EQ(folder_of("on", "/x/cache", "/h"), "/x/cache/palpate");
}

void age(const fs::path& file, int minutes) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::minutes(minutes));
}

TEST(TrimCache, RemovesTheOldestUntilTheRestFits) {
  const TemporaryFolder folder;
  for (int i = 0; i < 5; ++i)
    age(folder.write(std::to_string(i) + ".organ", std::string(100, 'x')), i == 2 ? 90 : 10 + i);
  (void)folder.write("other", std::string(1000, 'x'));
  trim_cache(folder.path(), ".organ", 300);
  EXPECT_TRUE(fs::exists(folder / "0.organ"));
  EXPECT_TRUE(fs::exists(folder / "1.organ"));
  EXPECT_TRUE(fs::exists(folder / "3.organ"));
  EXPECT_FALSE(fs::exists(folder / "2.organ"));
  EXPECT_FALSE(fs::exists(folder / "4.organ"));
  EXPECT_TRUE(fs::exists(folder / "other"));
}

TEST(TrimCache, RemovesWhatKilledWritersLeftButNotWhatIsBeingWritten) {
  const TemporaryFolder folder;
  age(folder.write("a.organ.AbCdEf", "x"), 61);
  age(folder.write("b.organ.AbCdEf", "x"), 59);
  age(folder.write("c.other.AbCdEf", "x"), 61);
  trim_cache(folder.path(), ".organ", 300);
  EXPECT_FALSE(fs::exists(folder / "a.organ.AbCdEf"));
  EXPECT_EQ(folder.entries(), 2U);
}

TEST(TrimCache, OfAFolderThatIsNotThereIsNoError) { trim_cache("/absent/folder", ".organ", 0); }

}  // namespace
}  // namespace palpate

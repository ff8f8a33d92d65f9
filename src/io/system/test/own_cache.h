#pragma once
// A cache of prepared organs for all tests of a process, for tests that prepare the same organ often.
#include <cstdlib>
#include <optional>
#include <string_view>

#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

namespace palpate::test {

/// Sets XDG_CACHE_HOME to a folder that is removed after the last test, where CTest has not set one for all
/// suites (palpate_add_suites).
class OwnCache final : public testing::Environment {
 public:
  void SetUp() override {
    const char* set = std::getenv("PALPATE_CACHE");  // NOLINT(concurrency-mt-unsafe): one thread
    if (set != nullptr && std::string_view(set) == "shared") return;
    setenv("XDG_CACHE_HOME", folder_.emplace().path().c_str(), 1);
    unsetenv("PALPATE_CACHE");
  }
  void TearDown() override { folder_.reset(); }

 private:
  std::optional<TemporaryFolder> folder_;
};

inline testing::Environment* const own_cache = testing::AddGlobalTestEnvironment(new OwnCache);

}  // namespace palpate::test

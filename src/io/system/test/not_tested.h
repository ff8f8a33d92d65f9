#pragma once
// Tests that cannot run on this machine: CTest reports their suite as skipped, not as passed.
#include <cstdlib>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

namespace palpate::test {

/// Exit status of a test program without failures of which some test could not run: SKIP_RETURN_CODE of
/// cmake/palpate_suites.cmake.
inline constexpr int kNotTestedStatus = 77;

/// Ends the program with kNotTestedStatus, unless a test has failed.
class NotTestedListener final : public testing::EmptyTestEventListener {
 public:
  void OnTestProgramEnd(const testing::UnitTest& program) override {
    if (program.Passed()) std::exit(kNotTestedStatus);  // NOLINT(concurrency-mt-unsafe)
  }
};

/// Reports that the calling test cannot run; it must then return.
inline void not_tested(const std::string& reason) {
  std::cerr << "not tested: " << reason << '\n';
  static const bool once = [] {
    testing::UnitTest::GetInstance()->listeners().Append(new NotTestedListener);
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace palpate::test

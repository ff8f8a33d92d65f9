#pragma once
// Outputs that cannot be written or that equal inputs, for tests of every command that writes a file.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/program.h"

namespace palpate::tests {

/// Expects an error with both flags, and unchanged files.
inline void expect_refused_untouched(const Folder& folder, const std::vector<std::string>& words,
                                     const std::string& input, const std::string& flag,
                                     const std::string& other) {
  const std::string before = text_of(folder / input);
  const std::vector<std::string> names = folder.names();
  const Outcome outcome = run(folder, words);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_THAT(outcome.err,
              testing::AllOf(testing::HasSubstr(flag), testing::HasSubstr("is the same file as " + other)));
  EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
  EXPECT_EQ(text_of(folder / input), before);
  EXPECT_EQ(folder.names(), names);
}

/// Runs commands whose last word is a flag for an output, with outputs that cannot be created.
inline void expect_unusable_outputs_refused(const Folder& folder,
                                            const std::vector<std::vector<std::string>>& commands) {
  const std::vector<std::string> names = folder.names();
  for (std::vector<std::string> command : commands) {
    const bool makes_folder = command.back() == "--report";
    // Nobody can create a file or folder in /proc, not even root. A report creates the folders of its path.
    command.emplace_back(makes_folder ? "/proc/none/out" : "none/out.x");
    const std::string flag = command[command.size() - 2] + " " + command.back();
    const Outcome outcome = run(folder, command);
    EXPECT_EQ(outcome.exit_code, 2) << flag << ": " << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(makes_folder ? command.back()
                                                             : flag + ": the folder none does not exist"));
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(outcome.out, "") << flag;
    EXPECT_EQ(folder.names(), names) << flag;
  }
}

}  // namespace palpate::tests

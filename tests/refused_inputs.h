#pragma once
// Input files that are not regular files, or that never end, for tests of every command that reads a file.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/program.h"

namespace palpate::tests {

/// Commands that read a file: its extension, and the arguments with FILE for its name.
using Readers = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// Outcome of the program if it ends within 20 s; otherwise it is killed.
inline Outcome outcome_in_time(const Folder& folder, const std::vector<std::string>& words) {
  Program program(folder.path(), words);
  for (int i = 0; i < 2000 && !program.ended(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (!program.ended()) program.signal(SIGKILL);
  return program.wait();
}

inline void expect_refused_in_time(const std::string& file, const std::vector<std::string>& words,
                                   const Folder& folder, const std::string& why) {
  const Outcome outcome = outcome_in_time(folder, words);
  EXPECT_EQ(outcome.exit_code, 2) << words.front() << " " << file << ": " << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(why), std::string::npos) << words.front() << ": " << outcome.err;
}

inline std::vector<std::string> with_file(std::vector<std::string> words, const std::string& file) {
  for (std::string& word : words) {
    if (const std::size_t at = word.find("FILE"); at != std::string::npos) word.replace(at, 4, file);
  }
  return words;
}

inline void expect_fifos_refused(const Readers& readers) {
  const Folder folder;
  for (const auto& [ending, words] : readers) {
    const std::string name = "fifo." + ending;
    ASSERT_EQ(mkfifo((folder / name).c_str(), 0600), 0);
    expect_refused_in_time(name, with_file(words, name), folder, "is a FIFO, must be a");
    fs::remove(folder / name);
  }
  EXPECT_TRUE(folder.names().empty());
}

inline void expect_endless_devices_refused(const Readers& readers) {
  const Folder folder;
  for (const auto& [ending, words] : readers) {
    const std::string name = "zero." + ending;
    fs::create_symlink("/dev/zero", folder / name);
    expect_refused_in_time(name, with_file(words, name), folder, "is a device, must be a");
    fs::remove(folder / name);
  }
}

inline void expect_two_gigabytes_refused(const Readers& readers) {
  const Folder folder;
  for (const auto& [ending, words] : readers) {
    const std::string name = "empty." + ending;
    std::ofstream(folder / name).put('\n');
    fs::permissions(folder / name, fs::perms::owner_read | fs::perms::owner_write);
    fs::resize_file(folder / name, std::uintmax_t{2} << 30);
    expect_refused_in_time(name, with_file(words, name), folder,
                           ending == "h5" ? "not an HDF5 file" : "has 2048 MiB");
    fs::remove(folder / name);
  }
}

}  // namespace palpate::tests

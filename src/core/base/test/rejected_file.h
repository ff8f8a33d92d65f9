#pragma once
#include <string>

#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::test {

/// The one-line message with which `read` rejects a file of this name and content, beginning at the file's
/// name.
template <typename Read>
std::string rejection_of(const std::string& name, const std::string& content, const Read& read) {
  const TemporaryFolder folder;
  const auto file = folder.write(name, content);
  try {
    read(file);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with(file.string())) << message;
    return message.substr(folder.path().string().size() + 1);
  }
  ADD_FAILURE() << "accepted: " << content.substr(0, 200);
  return "";
}

}  // namespace palpate::test

#pragma once
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::scene::test {

using palpate::test::TemporaryFolder;

/// The message of the InputError that `act` throws, which must be one line; "" when it throws none.
inline std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

}  // namespace palpate::scene::test

#pragma once
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace palpate::test {

/// Whether a file contains a text, such as a table of the documentation that is generated from code.
inline testing::AssertionResult file_contains(const std::string& file, const std::string& text) {
  std::stringstream content;
  content << std::ifstream(file).rdbuf();
  if (content.str().find(text) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << file << " must contain:\n" << text;
}

}  // namespace palpate::test

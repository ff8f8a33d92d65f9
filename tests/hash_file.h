#pragma once
// Hashes by name, as printed and as committed: one "NAME HASH" per line, # begins a comment.
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

namespace palpate::tests {

inline std::string hexadecimal(std::uint64_t value) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// The hashes of a file by name; empty when the file cannot be read.
inline std::map<std::string, std::string> hashes_in(const char* file) {
  std::map<std::string, std::string> hashes;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t blank = line.find(' ');
    hashes[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return hashes;
}

/// Prints a hash and compares it with the committed one. @param file nullptr: no comparison
/// @return whether both are equal, or there was no comparison
inline bool check_hash(const std::string& name, const std::string& hash, const char* file) {
  std::cout << name << ' ' << hash << std::endl;
  if (file == nullptr) return true;
  const std::map<std::string, std::string> expected = hashes_in(file);
  const auto found = expected.find(name);
  if (found != expected.end() && found->second == hash) return true;
  std::cerr << name << ' ' << hash << " differs from " << file << ": "
            << (found == expected.end() ? "no such line" : found->second) << '\n';
  return false;
}

}  // namespace palpate::tests

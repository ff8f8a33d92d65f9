#pragma once
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "palpate/error.h"

namespace palpate::study {

// A small valid study with each kind of task. Tests replace parts of it.
inline const std::string kStudyText = R"([study]
name = "small"
scene = "box"
[safety]
max_force_N = 6.0
max_noise_N = 0.1
[[condition]]
name = "off"
share = 0
[[condition]]
name = "on"
share = 0.6
[[task]]
name = "curve"
kind = "force-detection"
signal = { from_task = "weak" }
shares = [0, 0.5, 2]
trials = 4
[[task]]
name = "weak"
kind = "force-detection"
force_mN = { from = 5, to = 500 }
trials = 5
[[task]]
name = "threshold"
kind = "noise-threshold"
sigma_mN = { from = 1, to = 100 }
sets_share_of = "threshold"
trials = 6
[[task]]
name = "stiff"
kind = "stiffness"
ratio = { least = 1.02, largest = 3.3 }
conditions = ["off", "on"]
trials = 7
[[task]]
name = "lump"
kind = "inclusion"
ratio = { least = 1.1, largest = 8 }
depth_mm = 6
trials = 8
[[task]]
name = "hold"
kind = "force-control"
target_N = [1, 2]
repeats = 3
conditions = ["off", "on"]
[analysis]
primary = { task = "stiff", contrast = "on - off" }
inverted_u = { task = "curve", rise = [[0.5], [0]], fall = [[2], [0.5]] }
)";

/// The text with its only occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos) return "not unique: " + from;
  return text.replace(at, from.size(), to);
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The message of the InputError that a call throws.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace palpate::study

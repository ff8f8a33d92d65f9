#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "run/tasks/communicator.h"

#include "learning/environment/environment.h"
#include "learning/environment/policy.h"

namespace palpate::learning {

struct GenerateRequest {
  scene::Overrides scene;  // as the user gave it: with_defaults() is applied
  Settings settings;
  PolicyKind policy = PolicyKind::kScripted;
  std::uint64_t episodes = 100;
  std::uint64_t seed = 1;
  std::filesystem::path out;    // .h5 or .npz
  bool creates_folder = false;  // of the file, if it is missing
  contact::Preparation preparation{};
};

struct GenerateSummary {
  std::uint64_t steps = 0;       // of all episodes
  std::uint64_t terminated = 0;  // episodes, in a search: with the lump found
  double mean_reward = 0.0;      // of a step
};

/// Called on rank 0 with the completed fraction, 0..1, and a description of the current step.
using Progress = std::function<void(double, const std::string&)>;

/// [setup] Runs episodes with a policy, distributed over the ranks, and writes them to one file
/// (docs/file-formats.md). The bytes depend only on the request, not on the number of ranks. All ranks must
/// make this call. @return on rank 0
/// @throws InputError on all ranks for a bad request, or when the file cannot be written
[[nodiscard]] GenerateSummary generate(const GenerateRequest& request, tasks::Communicator& ranks,
                                       const Progress& progress);

}  // namespace palpate::learning

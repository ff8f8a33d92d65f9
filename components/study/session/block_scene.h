#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/inclusion.h"
#include "palpate/scene.h"

#include "study/session/study.h"

namespace palpate::study {

/// A block of a session: one haptic run.
struct BlockNumber {
  std::uint32_t participant = 0;
  int session = 1;
  int block = 1;
};

/// [setup] The scene of a study with its limits, without noise. @param device as --device; empty: the scene's
/// @throws InputError
[[nodiscard]] scene::Scene study_scene(const Study& study, const std::string& device);

/// [setup] The scene of one block of a task; the noise's seed is the block's. @param lumps places of the
/// inclusion of an inclusion task, the same for everybody @throws InputError
[[nodiscard]] scene::Scene block_scene(const Study& study, const StudyTask& task, const BlockNumber& block,
                                       const std::string& device, std::vector<model::Inclusion>& lumps);

}  // namespace palpate::study

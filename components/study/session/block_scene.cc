#include "study/session/block_scene.h"

#include <algorithm>

#include "core/base/random.h"
#include "io/scene/search.h"

namespace palpate::study {
namespace {

constexpr std::uint32_t kNoisePart = 0x7400'0000;  // of the random numbers: seeds of the blocks' noise
constexpr int kLumpPlaces = 16;

/// Places of the inclusion of an inclusion task, below the upper side of the organ.
std::vector<model::Inclusion> lump_places(const scene::Scene& scene, const StudyTask& task) {
  std::vector<model::Inclusion> places;
  for (int i = 0; i < kLumpPlaces; ++i) {
    scene::Scene copy = scene;
    copy.inclusions.clear();
    copy.seed = scene.seed + static_cast<std::uint64_t>(i);
    scene::SearchTable table;
    table.lumps = 1;
    table.lump.radius = task.radius;
    table.lump.ratio = 1.0;
    table.depth = task.depth > 0.0 ? task.depth : task.radius + 1e-3;
    table.where = "task." + task.name;
    scene::hide_inclusions(table, copy);
    places.push_back(copy.inclusions.front().inclusion);
  }
  return places;
}

}  // namespace

scene::Scene study_scene(const Study& study, const std::string& device) {
  scene::Overrides request = scene_of(study);
  if (!device.empty()) request.device = device;
  scene::Scene scene = scene::load(request);
  scene.safety.max_force = std::min(scene.safety.max_force, study.max_force);
  scene.noise.enabled = false;
  return scene;
}

scene::Scene block_scene(const Study& study, const StudyTask& task, const BlockNumber& block,
                         const std::string& device, std::vector<model::Inclusion>& lumps) {
  scene::Scene scene = study_scene(study, device);
  const auto part =
      static_cast<std::uint32_t>(block.session) << 12U | static_cast<std::uint32_t>(block.block);
  scene.seed = Random(study.seed, block.participant, kNoisePart + part).below(std::size_t{1} << 52U);
  scene.noise.seed = scene.seed;
  const TissueChange tissue = stimulus_of(task, 0.0, false).tissue;
  tissue.apply_to(scene.tissue);
  if (tissue.inclusion) {
    scene::Scene places = scene;
    places.seed = study.seed;  // all participants have the same places
    lumps = lump_places(places, task);
    scene.inclusions.clear();
    scene.inclusions.push_back({"lump", false, lumps.front()});
  }
  return scene;
}

}  // namespace palpate::study

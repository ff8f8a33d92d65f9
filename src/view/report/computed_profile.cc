#include <array>
#include <span>
#include <string>

#include "palpate/units.h"
#include "view/report/surface_line.h"

namespace palpate::report {
namespace {

#include "view/report/computed_profiles.inc"

ReferenceProfile made(const std::string& tool, const std::array<double, 3>& across_S,
                      std::span<const std::array<double, 2>> places) {
  ReferenceProfile profile;
  profile.source = "finite elements";
  profile.origin =
      tool + ", linear elastic, small strains, Poisson's ratio 0.45, held at all faces away from the tool";
  profile.depth = kComputedDepth * kMillimetre;
  for (const auto& [distance, displacement] : places)
    profile.places.push_back({distance * kMillimetre, displacement * kMillimetre});
  profile.across_S = Vec3(across_S[0], across_S[1], across_S[2]);
  return profile;
}

}  // namespace

std::optional<ReferenceProfile> computed_profile(scene::Task task) {
  if (task == scene::Task::kPress)
    return made("a ball of 1.5 mm radius for the tip", kPressAcross, kPressPlaces);
  if (task == scene::Task::kPull) return made("a disc of 1.7 mm radius pulled", kPullAcross, kPullPlaces);
  return std::nullopt;
}

}  // namespace palpate::report

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/scene/scene_file.h"
#include "io/system/file_exists.h"
#include "palpate/builtin.h"
#include "palpate/error.h"

#include "study/session/study.h"

namespace palpate::study {
namespace {

/// The scene of a run without a scene file, in which settings are allowed.
scene::SceneText text_of_organ(const std::string& organ) {
  return {fmt::format("[scene]\nname = \"{0}\"\n[organ]\nmesh = \"{0}\"\n[tool]\nmesh = \"curved-forceps\"\n",
                      organ),
          {}};
}

}  // namespace

scene::Overrides scene_of(const Study& study) {
  scene::Overrides request;
  const std::filesystem::path file = study.file.parent_path() / study.scene;
  double limit = scene::SafetySetup{}.max_force;
  if (regular_file_exists(file)) {
    request.scene = file;
    limit = scene::read_scene_file(file).safety.max_force;
  } else {
    const std::vector<std::string>& known = geometry::builtin_organ_names();
    if (std::find(known.begin(), known.end(), study.scene) == known.end()) {
      const std::string near = nearest_word(study.scene, known);
      throw InputError(
          fmt::format("{}: study.scene = \"{}\": must be a scene file, relative to the study file, or {}{}",
                      study.file.string(), study.scene, scene::alternatives(known),
                      near.empty() ? "" : "; did you mean " + near + "?"));
    }
    request.organ = study.scene;
    request.scene_text = text_of_organ(study.scene);
  }
  if (study.max_force < limit) request.settings.push_back({"safety.max_force_N", shortest(study.max_force)});
  return request;
}

}  // namespace palpate::study

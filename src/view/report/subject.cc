#include "view/report/subject.h"

namespace palpate::report {

render::Subject subject_of(const scene::Scene& scene) {
  return {scene.organ,
          scene.tools,
          scene.tissue.reach,
          scene.tissue.name,
          scene::visible_inclusions(scene.inclusions),
          scene.support};
}

}  // namespace palpate::report

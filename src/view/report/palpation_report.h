#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/offscreen.h"
#include "palpate/scene.h"
#include "run/palpation/insertion_score.h"
#include "run/palpation/score.h"

namespace palpate::report {

/// [setup] The felt factor of the stiffness over the organ, the true one and their legend side by side, seen
/// from above with lumps and marks. @param height pixels @throws std::runtime_error without OpenGL
[[nodiscard]] render::Image draw_felt_stiffness(const scene::Scene& scene, const palpation::Scorer& scorer,
                                                int height = 700);

/// The scale of the maps: nearly all felt factors, at least from 1 to 1.2.
struct FactorRange {
  double low = 1.0;
  double high = 1.2;
};
[[nodiscard]] FactorRange range_of(const palpation::FeltMap& map);
/// [any] The felt factors of all vertices of the map's surface.
[[nodiscard]] std::vector<float> felt_factors(const palpation::FeltMap& map);
/// [any] The marks of a score and the lumps' places, at most render::kMaxMarks.
[[nodiscard]] std::vector<render::SurfaceMark> marks_of(const palpation::Score& score);

/// [setup] Writes `folder`/report.html (self-contained): the score with the definition of each measure, the
/// maps, lumps and marks. @param command the command line @return path of report.html @throws InputError when
/// the folder cannot be written
std::filesystem::path write_palpation_report(const scene::Scene& scene, const palpation::Scorer& scorer,
                                             const std::filesystem::path& folder, const std::string& command);

/// [setup] As write_palpation_report() of a recording of task insert: the score, and the force along each
/// needle that went in.
std::filesystem::path write_insertion_report(const record::Recording& recording,
                                             const palpation::AnyScore& score,
                                             const std::filesystem::path& folder, const std::string& command);

}  // namespace palpate::report

#include "app/pictures.h"

#include <vector>

#include "palpate/error.h"
#include "palpate/offscreen.h"
#include "view/report/subject.h"

#include "app/progress.h"

namespace palpate::app {

bool has_pictures() noexcept { return true; }

void require_pictures(const std::string& /*flag*/) {}

void write_screenshot(const record::Recording& recording, const session::RunStatistics& statistics,
                      const std::filesystem::path& file, bool no_cache) {
  constexpr int kWidth = 1280;
  constexpr int kHeight = 960;
  if (recording.rows.empty()) throw InputError("--screenshot " + file.string() + ": no tick was run");
  const std::vector<haptics::Snapshot> snapshots =
      record::snapshots_at(recording, {statistics.deepest_tick}, OrganPreparation(no_cache).how());
  const haptics::Snapshot& deepest = snapshots.front();
  const contact::ToolResult& result = deepest.results[statistics.deepest_hand];
  const render::Subject subject = report::subject_of(recording.scene);
  render::OffscreenRenderer renderer(subject, kWidth, kHeight);
  const bool touched = result.phase != contact::Phase::kApproach;
  const render::Camera camera = render::frame_contact(
      subject, deepest, touched ? result.contact_W : result.nearest_W, result.normal_W, touched);
  render::write_png(renderer.draw(deepest, camera), file);
}

}  // namespace palpate::app

#include "app/recorded_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/error.h"
#include "view/report/subject.h"

#include "app/session.h"

namespace palpate::app {
namespace {

record::Recording read_some(const std::filesystem::path& file, const record::Progress& progress,
                            bool break_blind) {
  record::Recording recording = read_to_show(file, "palpate view", break_blind, progress);
  if (recording.rows.empty())
    throw InputError(file.string() + ": contains no tick, so there is nothing to show");
  return recording;
}

}  // namespace

RecordedView::RecordedView(std::filesystem::path file, bool no_cache, const record::Progress& progress,
                           bool break_blind)
    : file_(std::move(file)),
      recording_(read_some(file_, progress, break_blind)),
      preparation_(no_cache),
      frames_(recording_, preparation_.how()) {
  recording_.scene.store = preparation_.how().store;
}

std::uint32_t RecordedView::hands() const noexcept {
  return static_cast<std::uint32_t>(recording_.scene.devices.size());
}

render::Subject RecordedView::subject() const { return report::subject_of(recording_.scene); }

const haptics::TickRow& RecordedView::row(std::uint64_t tick, std::uint32_t hand) const {
  return recording_.rows.at(tick * hands() + hand);
}

double RecordedView::time_of(std::uint64_t tick) const noexcept {
  return static_cast<double>(tick) / recording_.scene.rate_Hz;
}

std::uint64_t RecordedView::tick_at(double time) const noexcept {
  const double last = static_cast<double>(ticks() - 1);
  return static_cast<std::uint64_t>(std::clamp(std::round(time * recording_.scene.rate_Hz), 0.0, last));
}

render::Camera RecordedView::camera(std::uint32_t hand, bool close_up) {
  const haptics::Snapshot deepest = frames_.at(frames_.deepest(hand));
  const contact::ToolResult& result = deepest.results[hand];
  const bool contact = result.view_count > 0;
  return render::frame_contact(subject(), deepest, contact ? result.contact_W : result.nearest_W,
                               contact ? result.normal_W : result.away_W, close_up);
}

}  // namespace palpate::app

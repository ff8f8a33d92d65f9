#include "app/window/search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <imgui.h>

#include "core/haptics/simulation.h"
#include "io/system/clock.h"
#include "palpate/units.h"
#include "view/render/map_legend.h"
#include "view/report/palpation_report.h"

#include "app/window/panels.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

void score_rows(const std::vector<palpation::Measure>& measures) {
  const Rows rows("score");
  for (const palpation::Measure& one : measures) rows.text(one.name, one.value, one.definition.c_str());
}

/// A new run of the scene with the next seed, which hides things elsewhere.
void other_places(const PanelModel& shown, Commands& commands) {
  if (!ImGui::Button("Other places", ImVec2(-1.0F, 0.0F))) return;
  scene::Overrides request = shown.request;
  request.seed = shown.scene.seed + 1;
  commands.request = std::move(request);
  commands.keep = {.tissue = true, .noise = true};
}

/// The colours of the map, with the factors at their ends. Without the map its place stays empty, so that
/// nothing below moves.
void colour_bar(const SearchStatus& search) {
  constexpr int kSteps = 32;
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = 0.6F * ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  if (!search.shows_map) {
    ImGui::Dummy(ImVec2(width, height));
    ImGui::TextUnformatted(" ");
    return;
  }
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 colour = render::map_colour((i + 0.5) / kSteps);
    const auto level = [&](int k) { return static_cast<int>(std::lround(255.0 * render::srgb(colour[k]))); };
    const float left = corner.x + width * static_cast<float>(i) / kSteps;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(left, corner.y),
                                              ImVec2(left + width / kSteps + 1.0F, corner.y + height),
                                              IM_COL32(level(0), level(1), level(2), 255));
  }
  ImGui::Dummy(ImVec2(width, height));
  const std::string high = fmt::format("{:.2f} times as stiff", search.high);
  ImGui::Text("%.2f", search.low);
  ImGui::SameLine(width - ImGui::CalcTextSize(high.c_str()).x);
  ImGui::TextUnformatted(high.c_str());
}

}  // namespace

Search::Search(const Session& session)
    : session_(session), scorer_(session.scene(), session.world().contact) {}

void Search::end() {
  if (score_) return;
  score_ = scorer_.score();
  shows_map = true;
}

std::size_t Search::take_untouched_marks() {
  return scorer_.untouched_marks() - std::exchange(untouched_, scorer_.untouched_marks());
}

std::string answer_text(const palpation::Score& score) {
  const char* lumps = score.lumps.size() == 1 ? "lump" : "lumps";
  std::string text = fmt::format("{} of {} {} found", score.found, score.lumps.size(), lumps);
  if (score.wrong > 0) text += fmt::format(", {} false mark{}", score.wrong, score.wrong > 1 ? "s" : "");
  if (score.error) text += fmt::format(", marks {:.1f} mm away", *score.error / kMillimetre);
  return text + ".";
}

double Search::pointer_gain(const Traces& traces) const {
  constexpr double kLeastDepth = 1e-3;  // m
  constexpr double kLeastGain = 0.25;
  double gain = 1.0;
  for (std::uint32_t hand = 0; hand < session_.hands(); ++hand) {
    const haptics::TickRow& row = traces.newest(hand);
    if (static_cast<contact::Phase>(row.phase) != contact::Phase::kPress || row.depth < kLeastDepth) continue;
    const double uniform = session_.world().contact.press_law().force_at(row.depth).force;
    const double softness = uniform / std::max(palpation::normal_force(row), 1e-9);
    gain = std::min(gain, std::max(kLeastGain, softness * softness * softness));
  }
  return gain;
}

/// Widens the colours' range in few steps, because each new range assigns all colours again.
void Search::widen_range() {
  const report::FactorRange range = report::range_of(scorer_.map());
  while (range.high > high_ + 1e-9) high_ = 1.0 + 2.0 * (high_ - 1.0);
  while (range.low < low_ - 0.1) low_ -= 0.2;
}

void Search::draw_on(LivePicture& picture, bool now) {
  constexpr std::int64_t kPeriodNs = 200'000'000;
  if (!now && monotonic_ns() < next_ns_) return;
  next_ns_ = monotonic_ns() + kPeriodNs;
  if (shows_map) {
    widen_range();
    picture.show_values(scorer_.map().surface().vertices, report::felt_factors(scorer_.map()), low_, high_);
  } else {
    picture.show_values({}, {}, low_, high_);
  }
  if (score_) {
    picture.show_marks(report::marks_of(*score_));
    return;
  }
  palpation::Score hidden;  // during the search no mark shows whether it is right
  hidden.marks = scorer_.marks();
  for (palpation::Mark& mark : hidden.marks) mark.lump = 0;
  picture.show_marks(report::marks_of(hidden));
}

SearchStatus Search::status() const {
  SearchStatus status;
  status.score = score_;
  status.shows_map = shows_map;
  status.low = low_;
  status.high = high_;
  status.marks = scorer_.marks().size();
  const palpation::Score now = score_ ? *score_ : scorer_.score();
  status.lumps = now.lumps.size();
  status.coverage = now.coverage;
  return status;
}

void insertion_panel(const PanelModel& shown, Commands& commands) {
  if (!shown.inserts) return;
  ImGui::Separator();
  if (!shown.ended) {
    if (ImGui::Button("End the insertion", ImVec2(-1.0F, 0.0F))) commands.end_search = true;
    return;
  }
  const bool hidden = std::any_of(shown.inclusions.begin(), shown.inclusions.end(),
                                  [](const scene::InclusionSetup& one) { return !one.visible; });
  if (hidden) other_places(shown, commands);
  score_rows(shown.insertion);
}

void search_panel(const PanelModel& shown, Commands& commands) {
  if (!shown.search) return;
  const SearchStatus& search = *shown.search;
  ImGui::Separator();
  if (search.score) {
    other_places(shown, commands);
  } else {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextColored(colour::kFaint,
                       "Press, compare the force at equal depth, and mark each lump while you touch it: M, a "
                       "click or the device's button.");
    ImGui::PopTextWrapPos();
    if (ImGui::Button("End the search", ImVec2(-1.0F, 0.0F))) commands.end_search = true;
  }
  bool map = search.shows_map;
  if (ImGui::Checkbox("Map of the felt stiffness  (T)", &map)) commands.map = map;
  colour_bar(search);
  {
    const Rows rows("search");
    rows.text("Hidden lumps", std::to_string(search.lumps));
    rows.text("Marks", std::to_string(search.marks), "of places under the tool, made in contact");
    rows.text("Coverage", fmt::format("{:.0f} %", 100.0 * search.coverage),
              "touched share of the organ's upper side");
    if (search.pointer_gain) {
      rows.text("Pointer",
                *search.pointer_gain < 1.0
                    ? fmt::format("{:.0f} % of its speed", 100.0 * *search.pointer_gain)
                    : "at its full speed",
                "pseudo-haptics: over stiff places the mouse moves the tool less");
    }
  }
  if (search.score) score_rows(palpation::measures(*search.score));
}

}  // namespace palpate::app

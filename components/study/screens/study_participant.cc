#include "study/screens/study_participant.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/core.h>

#include "study/screens/study_keys.h"

namespace palpate::app {
namespace {

using study::ScreenContent;
using study::Study;
using study::TrialState;

constexpr float kTextHeight = 44.0F;  // px at 1080 lines
constexpr double kBarEnd = 1.5;       // end of the force bar / upper end of the band

/// The window in units of its text: 24.5 high at any resolution.
struct Page {
  ImVec2 size = ImGui::GetIO().DisplaySize;
  float text = ImGui::GetFontSize();
  float middle = 0.5F * size.x;
  float margin = 1.5F * text;

  [[nodiscard]] float y(float share) const { return share * size.y; }
};

/// What to do while a stimulus interval lasts.
std::string interval_action(const study::TrialView& trial, const study::StudyTask* task,
                            const study::Language& say) {
  const std::string number = fmt::format(fmt::runtime(say("Interval {}")), trial.interval);
  if (task == nullptr) return number;
  if (task->free) return number;
  return say(trial.deep_enough ? "Come up" : describe(task->kind).action);
}

std::string action_of(const ScreenContent& content, const study::StudyTask* task,
                      const study::Language& say) {
  const bool lifts = task != nullptr && task->leaves_tissue();
  switch (content.trial.state) {
    case TrialState::kIdle:  // a block is being prepared
      return content.message.empty() ? say("Please wait") : std::string();
    case TrialState::kFinished:
      return {};
    case TrialState::kHome:
      return say("Move back to the start and hold still");
    case TrialState::kReach:
      return say(content.trial.bar ? "Press until the force is in the band" : "Press");
    case TrialState::kInterval:
      return interval_action(content.trial, task, say);
    case TrialState::kGap:
      return say(lifts ? "Come up" : task == nullptr || task->free ? "Wait" : "Keep this force");
    case TrialState::kAnswer:
      return say("Which one?");
  }
  return {};
}

void draw_progress(const ParticipantView& view, const Page& page) {
  if (view.progress.empty()) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float y = page.margin;
  const float text =
      study_font(StudyFont::kText)->CalcTextSizeA(page.text, FLT_MAX, 0.0F, view.progress.c_str()).x;
  (void)draw_text(list, StudyFont::kText, ImVec2(page.margin, y), Align::kLeft, page.size.x,
                  packed(colour::kFaint), view.progress);
  const ImVec2 low(2.0F * page.margin + text, y + 0.35F * page.text);
  const ImVec2 high(page.size.x - page.margin, y + 0.95F * page.text);
  const float end = low.x + static_cast<float>(std::clamp(view.part_done, 0.0, 1.0)) * (high.x - low.x);
  list.AddRectFilled(low, high, packed(colour::kGrid));
  list.AddRectFilled(low, ImVec2(end, high.y), packed(colour::kDepth, 0.8F));
}

/// A box of an interval. Lit, it is bright with a dark digit and a thick frame.
void draw_box(const ImVec2& low, const ImVec2& high, const char* digit, bool lit, float text) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float round = 0.35F * text;
  if (lit) {
    const ImVec2 edge(0.5F * text, 0.5F * text);
    list.AddRect(ImVec2(low.x - edge.x, low.y - edge.y), ImVec2(high.x + edge.x, high.y + edge.y),
                 packed(colour::kText), 2.0F * round, 0, 0.25F * text);
    list.AddRectFilled(low, high, packed(colour::kForce), round);
  } else {
    list.AddRect(low, high, packed(colour::kFaint), round, 0, 0.08F * text);
  }
  const ImFont* font = study_font(StudyFont::kDigits);
  const float height = font->FontSize * ImGui::GetIO().FontGlobalScale;
  (void)draw_text(list, StudyFont::kDigits, ImVec2(0.5F * (low.x + high.x), 0.5F * (low.y + high.y - height)),
                  Align::kCentre, high.x - low.x, packed(lit ? colour::kBackground : colour::kFaint), digit);
}

void draw_boxes(const ParticipantView& view, const Page& page) {
  const float width = std::min(0.26F * page.size.x, 11.0F * page.text);
  const float gap = 2.0F * page.text;
  const float top = page.y(0.30F);
  const float bottom = page.y(0.57F);
  for (int box = 1; box <= 2; ++box) {
    const float left = box == 1 ? page.middle - gap - width : page.middle + gap;
    draw_box(ImVec2(left, top), ImVec2(left + width, bottom), box == 1 ? "1" : "2", view.lit == box,
             page.text);
    const std::string& keys = box == 1 ? view.first : view.second;
    if (keys.empty()) continue;
    (void)draw_text(*ImGui::GetBackgroundDrawList(), StudyFont::kText,
                    ImVec2(left + 0.5F * width, bottom + 0.6F * page.text), Align::kCentre,
                    width + 1.6F * gap, packed(colour::kText), keys);
  }
}

void draw_force_bar(const ParticipantView& view, const Page& page) {
  const ParticipantView::ForceBar& bar = *view.bar;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float left = 0.22F * page.size.x;
  const float right = 0.78F * page.size.x;
  const float top = page.y(0.90F);
  const float bottom = page.y(0.95F);
  const double end = bar.high > 0.0 ? kBarEnd * bar.high : 1.0;
  const auto at = [&](double force) {
    return left + static_cast<float>(std::clamp(force / end, 0.0, 1.0)) * (right - left);
  };
  const bool inside = bar.force >= bar.low && bar.force <= bar.high;
  list.AddRectFilled(ImVec2(left, top), ImVec2(right, bottom), packed(colour::kGrid));
  list.AddRectFilled(ImVec2(at(bar.low), top), ImVec2(at(bar.high), bottom), packed(colour::kDepth, 0.35F));
  const float middle = 0.5F * (top + bottom);
  const float half = 0.32F * (bottom - top);
  list.AddRectFilled(ImVec2(left, middle - half), ImVec2(at(bar.force), middle + half),
                     packed(inside ? colour::kGood : colour::kForce));
  for (const double edge : {bar.low, bar.high}) {
    list.AddRectFilled(ImVec2(at(edge) - 0.06F * page.text, top - 0.3F * page.text),
                       ImVec2(at(edge) + 0.06F * page.text, bottom + 0.3F * page.text),
                       packed(colour::kText));
  }
  const std::string& advice = inside ? view.good : bar.force < bar.low ? view.more : view.less;
  (void)draw_text(list, StudyFont::kText, ImVec2(right + 0.6F * page.text, middle - 0.55F * page.text),
                  Align::kLeft, page.size.x, packed(colour::kText), advice);
}

void draw_break(double left, const ParticipantView& view, const Page& page) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const int seconds = static_cast<int>(std::ceil(std::max(0.0, left)));
  (void)draw_text(list, StudyFont::kLarge, ImVec2(page.middle, page.y(0.30F)), Align::kCentre, page.size.x,
                  packed(colour::kText), view.message);
  (void)draw_text(list, StudyFont::kDigits, ImVec2(page.middle, page.y(0.40F)), Align::kCentre, page.size.x,
                  packed(colour::kText), fmt::format("{}:{:02}", seconds / 60, seconds % 60));
  (void)draw_text(list, StudyFont::kText, ImVec2(page.middle, page.y(0.62F)), Align::kCentre,
                  0.8F * page.size.x, packed(colour::kText), view.rest);
}

}  // namespace

ParticipantView participant_view(const ScreenContent& content, const Study& study,
                                 const study::Language& say) {
  const std::optional<std::size_t> found = study.find_task(content.task);
  const study::StudyTask* task = found ? &study.tasks[*found] : nullptr;
  const study::TrialView& trial = content.trial;
  ParticipantView view;
  if (content.position.parts > 0) {
    view.progress =
        fmt::format(fmt::runtime(say("part {} of {}")),
                    std::min(content.position.part + 1, content.position.parts), content.position.parts);
    view.part_done =
        content.position.of > 0 ? static_cast<double>(content.position.done) / content.position.of : 1.0;
  }
  // Beside the stimuli of the next trial, "correct" would seem to be about that trial.
  const bool before = trial.state == TrialState::kIdle || trial.state == TrialState::kHome ||
                      trial.state == TrialState::kFinished;
  if (before) view.message = say(content.message);
  view.rest = say(view.rest);
  view.more = say(view.more);
  view.less = say(view.less);
  view.good = say(view.good);
  if (content.break_left > 0.0) {
    view.break_left = content.break_left;
    if (view.message.empty()) view.message = say("Break");
    return view;
  }
  view.sentence = say(content.sentence);
  if (content.example != 0 && trial.state != TrialState::kIdle) {  // not in the break before it
    const bool stiffer = task != nullptr && task->comparison();
    view.message = fmt::format(
        fmt::runtime(say(stiffer ? "Example: interval {} is stiffer" : "Example: it is in interval {}")),
        content.example);
  }
  if (trial.fault != 0) {
    view.action = say("The device has stopped. Let go of it and wait.");
    return view;
  }
  view.action = action_of(content, task, say);
  view.boxes = trial.state != TrialState::kIdle && (task == nullptr || task->two_intervals());
  if (trial.state == TrialState::kInterval) view.lit = trial.interval;
  if (trial.state == TrialState::kAnswer) {
    view.first = text_of_keys(study.first_keys, say);
    view.second = text_of_keys(study.second_keys, say);
  }
  if (trial.bar) view.bar = ParticipantView::ForceBar{trial.force, trial.low, trial.high};
  return view;
}

std::vector<ExtraFont> study_fonts(const std::string& letters) {
  return {{22.0F, false, letters}, {58.0F, true, {}}};
}

ImFont* study_font(StudyFont which) { return ImGui::GetIO().Fonts->Fonts[static_cast<int>(which)]; }

float participant_text(float width, float height) {
  return kTextHeight * std::min(height / 1080.0F, width / 1440.0F);
}

float draw_text(ImDrawList& list, StudyFont font, ImVec2 at, Align align, float width, ImU32 colour,
                const std::string& text) {
  const ImFont* letters = study_font(font);
  const float height = letters->FontSize * ImGui::GetIO().FontGlobalScale;
  const float scale = height / letters->FontSize;
  const float shift = align == Align::kLeft ? 0.0F : align == Align::kCentre ? 0.5F : 1.0F;
  const char* end = text.c_str() + text.size();
  float y = at.y;
  for (const char* line = text.c_str(); line < end;) {
    const char* stop = letters->CalcWordWrapPositionA(scale, line, end, width);
    constexpr std::string_view kOpening = "“";  // stays with the text after it
    const bool opens = stop < end && std::string_view(line, stop).ends_with(kOpening);
    if (opens && stop - line > std::ssize(kOpening)) stop -= kOpening.size();
    const char* newline = std::find(line, stop, '\n');
    stop = newline < stop ? newline : std::max(stop, line + 1);
    const float wide = letters->CalcTextSizeA(height, FLT_MAX, 0.0F, line, stop).x;
    list.AddText(letters, height, ImVec2(std::round(at.x - shift * wide), std::round(y)), colour, line, stop);
    y += 1.2F * height;
    line = stop;
    while (line < end && (*line == ' ' || *line == '\n')) {
      if (*line++ == '\n') break;
    }
  }
  return y - at.y;
}

void draw_participant(const ParticipantView& view) {
  const Page page;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  draw_progress(view, page);
  (void)draw_text(list, StudyFont::kText, ImVec2(page.middle, page.y(0.15F)), Align::kCentre,
                  0.84F * page.size.x, packed(colour::kText), view.sentence);
  if (view.boxes) draw_boxes(view, page);
  if (view.break_left) {
    draw_break(*view.break_left, view, page);
    return;
  }
  // Without boxes, the text is in the middle of the page.
  (void)draw_text(list, StudyFont::kLarge, ImVec2(page.middle, page.y(view.boxes ? 0.69F : 0.42F)),
                  Align::kCentre, 0.9F * page.size.x, packed(colour::kText), view.action);
  (void)draw_text(list, StudyFont::kLarge, ImVec2(page.middle, page.y(view.boxes ? 0.79F : 0.55F)),
                  Align::kCentre, 0.9F * page.size.x, packed(colour::kDepth), view.message);
  if (view.bar) draw_force_bar(view, page);
}

void draw_notice(const std::string& text, std::optional<double> part) {
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float unit = ImGui::GetFontSize();
  const float width = std::min(0.8F * size.x, 26.0F * unit);
  const ImVec2 low(0.5F * (size.x - width), 0.4F * size.y);
  const ImVec2 high(low.x + width, low.y + (part ? 5.0F : 4.2F) * unit);
  list.AddRectFilled(low, high, packed(colour::kNotice), 0.4F * unit);
  list.AddRect(low, high, packed(colour::kText), 0.4F * unit, 0, 0.1F * unit);
  (void)draw_text(list, StudyFont::kText, ImVec2(0.5F * size.x, low.y + unit), Align::kCentre,
                  width - 2.0F * unit, packed(colour::kText), text);
  if (!part) return;
  const ImVec2 left(low.x + unit, high.y - 1.8F * unit);
  const ImVec2 right(high.x - unit, high.y - 0.9F * unit);
  list.AddRectFilled(left, right, packed(colour::kGrid));
  list.AddRectFilled(left, ImVec2(left.x + static_cast<float>(*part) * (right.x - left.x), right.y),
                     packed(colour::kWarning));
}

}  // namespace palpate::app

#include "study/screens/study_question.h"

#include <algorithm>
#include <cfloat>
#include <sstream>

#include <SDL.h>
#include <imgui.h>

#include "study/screens/study_participant.h"

namespace palpate::app {
namespace {

constexpr float kReadable = 34.0F;  // widest line of text / font size: about 70 letters

/// Whether a line begins an item of a list: "- ", "* " or "1. ".
bool begins_item(const std::string& line) {
  if (line.starts_with("- ") || line.starts_with("* ")) return true;
  const std::size_t digits = line.find_first_not_of("0123456789");
  return digits != std::string::npos && digits > 0 && line.compare(digits, 2, ". ") == 0;
}

StudyFont font_of(const Paragraph& one) { return one.heading ? StudyFont::kLarge : StudyFont::kText; }

void scroll_by_keys(float page) {
  constexpr float kPart = 0.85F;  // of a page: some lines stay
  const float line = 2.0F * ImGui::GetFontSize();
  float step = 0.0F;
  if (ImGui::IsKeyPressed(SDL_SCANCODE_PAGEDOWN)) step = kPart * page;
  if (ImGui::IsKeyPressed(SDL_SCANCODE_PAGEUP)) step = -kPart * page;
  if (ImGui::IsKeyPressed(SDL_SCANCODE_DOWN)) step = line;
  if (ImGui::IsKeyPressed(SDL_SCANCODE_UP)) step = -line;
  if (step != 0.0F) ImGui::SetScrollY(std::clamp(ImGui::GetScrollY() + step, 0.0F, ImGui::GetScrollMaxY()));
}

/// @return whether there is more text below
bool draw_paragraphs(const std::vector<Paragraph>& text, float width, float height) {
  ImGui::BeginChild("text", ImVec2(width + ImGui::GetStyle().ScrollbarSize, height));
  scroll_by_keys(height);
  for (const Paragraph& one : text) {
    ImGui::PushFont(study_font(font_of(one)));
    ImGui::PushTextWrapPos(width);
    ImGui::TextUnformatted(one.text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::Dummy(ImVec2(0.0F, 0.5F * ImGui::GetFontSize() - ImGui::GetStyle().ItemSpacing.y));
    ImGui::PopFont();
  }
  const bool more = ImGui::GetScrollY() + 1.0F < ImGui::GetScrollMaxY();
  ImGui::EndChild();
  return more;
}

/// Grid of equal buttons.
struct AnswerGrid {
  std::vector<std::string> labels;
  std::size_t columns = 1;
  ImVec2 button;
  float gap = 0.0F;

  AnswerGrid(const std::vector<std::string>& answers, float width) {
    const float text = ImGui::GetFontSize();
    float widest = 6.0F * text;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const std::string number = std::to_string(i + 1);
      labels.push_back(answers[i] == number ? number : number + "   " + answers[i]);
      widest = std::max(widest, ImGui::CalcTextSize(labels.back().c_str()).x + 1.6F * text);
    }
    gap = 0.6F * text;
    const std::size_t fitting = static_cast<std::size_t>(std::max(1.0F, (width + gap) / (widest + gap)));
    const std::size_t rows = (labels.size() + fitting - 1) / fitting;
    columns = (labels.size() + rows - 1) / rows;  // rows of about the same length
    button = ImVec2(std::min(widest, width), 2.1F * text);
  }
  [[nodiscard]] float width() const { return static_cast<float>(columns) * (button.x + gap) - gap; }
  [[nodiscard]] float height() const {
    const std::size_t rows = (labels.size() + columns - 1) / columns;
    return static_cast<float>(rows) * (button.y + gap) - gap;
  }
};

std::optional<std::size_t> draw_answers(const AnswerGrid& grid, const ImVec2& at) {
  std::optional<std::size_t> pressed;
  for (std::size_t i = 0; i < grid.labels.size(); ++i) {
    const auto column = static_cast<float>(i % grid.columns);
    const auto row = static_cast<float>(i / grid.columns);
    ImGui::SetCursorPos(
        ImVec2(at.x + column * (grid.button.x + grid.gap), at.y + row * (grid.button.y + grid.gap)));
    if (ImGui::Button(grid.labels[i].c_str(), grid.button)) pressed = i;
  }
  return pressed;
}

}  // namespace

std::vector<Paragraph> paragraphs_of(const std::string& text) {
  std::vector<Paragraph> all;
  bool open = false;  // the next line continues the last paragraph
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    line = begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
    if (line.empty()) {
      open = false;
    } else if (line[0] == '#') {
      const std::size_t title = line.find_first_not_of("# ");
      if (title != std::string::npos) all.push_back({line.substr(title), true});
      open = false;
    } else if (open && !begins_item(line)) {
      all.back().text += " " + line;
    } else {
      if (line.starts_with("- ") || line.starts_with("* ")) line = "•" + line.substr(1);
      all.push_back({line, false});
      open = true;
    }
  }
  return all;
}

std::optional<std::size_t> draw_question(const study::Question& question, const std::string& more) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.0F, 0.0F));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("question", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoScrollWithMouse);
  const float text = ImGui::GetFontSize();
  const float width = std::min(0.86F * size.x, kReadable * text);
  const AnswerGrid grid(question.answers, 0.92F * size.x);
  const float answers_x = 0.5F * (size.x - grid.width());
  const std::vector<Paragraph> paragraphs = paragraphs_of(question.text);
  std::optional<std::size_t> pressed;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (paragraphs.size() <= 2) {  // a short question, in the middle
    const ImFont& font = *study_font(StudyFont::kLarge);
    float high = 2.5F * text + grid.height();
    for (const Paragraph& one : paragraphs) {
      const float letters = font.FontSize * ImGui::GetIO().FontGlobalScale;
      high += 0.4F * text + 1.2F * font.CalcTextSizeA(letters, FLT_MAX, width, one.text.c_str()).y;
    }
    float y = std::min(0.26F * size.y, size.y - high);  // a long one begins higher
    for (const Paragraph& one : paragraphs) {
      y += 0.4F * text + draw_text(list, StudyFont::kLarge, ImVec2(0.5F * size.x, y), Align::kCentre, width,
                                   packed(colour::kText), one.text);
    }
    pressed = draw_answers(grid, ImVec2(answers_x, std::max(y + 1.5F * text, 0.45F * size.y)));
  } else {
    const float answers_y = size.y - 1.5F * text - grid.height();
    const float space = answers_y - 3.4F * text;  // above: a margin; below: the line "more below"
    ImGui::SetCursorPos(ImVec2(0.5F * (size.x - width), 1.2F * text));
    if (draw_paragraphs(paragraphs, width, space)) {
      (void)draw_text(list, StudyFont::kText, ImVec2(0.5F * size.x, answers_y - 1.8F * text), Align::kCentre,
                      size.x, packed(colour::kDepth), more);
    }
    pressed = draw_answers(grid, ImVec2(answers_x, answers_y));
  }
  ImGui::End();
  return pressed;
}

}  // namespace palpate::app

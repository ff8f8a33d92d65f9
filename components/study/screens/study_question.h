#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "study/session/run_session.h"

namespace palpate::app {

/// A paragraph of a text.
struct Paragraph {
  std::string text;
  bool heading = false;

  [[nodiscard]] bool operator==(const Paragraph&) const = default;
};

/// [any] Paragraphs of a text such as a consent form in Markdown: lines are joined up to an empty line, a
/// heading (#) or an item of a list (- or 1.).
[[nodiscard]] std::vector<Paragraph> paragraphs_of(const std::string& text);

/// [setup] Draws a question over the whole window: the text, which scrolls by wheel, arrows and Page Down,
/// and a button for each answer, with its number. @return the answer whose button was pressed
std::optional<std::size_t> draw_question(const study::Question& question,
                                         const std::string& more = "↓  more below: Page Down or wheel");

}  // namespace palpate::app

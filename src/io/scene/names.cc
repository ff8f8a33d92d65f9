#include "io/scene/names.h"

#include <algorithm>
#include <array>

#include "io/system/path_text.h"
#include "palpate/read_mesh.h"
#include "palpate/scene.h"

namespace palpate::scene {

bool is_path(std::string_view text) {
  // Extensions of other files, and of formats without a reader: the error message then names the file.
  static constexpr std::array<std::string_view, 13> kEndings = {".toml", ".csv", ".h5",   ".hdf5", ".dae",
                                                                ".vtp",  ".vtu", ".html", ".json", ".png",
                                                                ".txt",  ".tsv", ".xlsx"};
  if (text.find('/') != std::string_view::npos || geometry::is_mesh_file(to_path(text))) return true;
  std::string ending = to_text(to_path(text).extension());
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

const char* to_string(OrganFrame frame) noexcept { return frame == OrganFrame::kLps ? "lps" : "ras"; }

std::optional<OrganFrame> find_organ_frame(std::string_view name) noexcept {
  for (const OrganFrame frame : {OrganFrame::kRas, OrganFrame::kLps}) {
    if (name == to_string(frame)) return frame;
  }
  return std::nullopt;
}

const char* to_string(Task task) noexcept {
  switch (task) {
    case Task::kPull:
      return "pull";
    case Task::kPalpate:
      return "palpate";
    case Task::kInsert:
      return "insert";
    case Task::kPress:
      break;
  }
  return "press";
}

std::optional<Task> find_task(std::string_view name) noexcept {
  for (const Task task : {Task::kPress, Task::kPull, Task::kPalpate, Task::kInsert}) {
    if (name == to_string(task)) return task;
  }
  return std::nullopt;
}

std::string alternatives(std::span<const std::string> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace palpate::scene

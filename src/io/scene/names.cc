#include "io/scene/names.h"

#include <algorithm>
#include <array>

#include "palpate/read_mesh.h"

namespace palpate::scene {

bool is_path(std::string_view text) {
  // Extensions of other files, and of formats without a reader: the error message then names the file.
  static constexpr std::array<std::string_view, 7> kEndings = {".toml", ".csv", ".h5", ".hdf5",
                                                               ".dae",  ".vtp", ".vtu"};
  if (text.find('/') != std::string_view::npos || geometry::is_mesh_file(text)) return true;
  std::string ending = std::filesystem::path(text).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
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

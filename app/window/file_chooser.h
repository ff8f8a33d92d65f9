#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::app {

/// What a file that the user names is for.
enum class FileUse { kOrgan, kTool, kFurtherJaw, kTissue, kScene, kToolPath, kRecording, kSaveTissue };

/// A file that the user has chosen.
struct ChosenFile {
  FileUse use = FileUse::kScene;
  std::filesystem::path path;
  std::string unit;  // of a mesh: mm, cm, m or in
};

/// [setup] What a file dropped on the window would be for, by its ending and for .toml by what stands in it;
/// nothing when palpate reads no such file.
[[nodiscard]] std::optional<FileUse> use_of_file(const std::filesystem::path& file);

/// A dialog in which a file is chosen, by mouse or keyboard. For a mesh it asks for the unit, which is never
/// guessed. All members: [setup], the window's thread, between ImGui's NewFrame and Render.
class FileChooser final {
 public:
  /// Opens the dialog. @param file where it begins: a folder, or a file that is chosen already
  void open(FileUse use, const std::filesystem::path& file);
  [[nodiscard]] bool is_open() const noexcept { return open_; }
  /// As if the user had chosen it for a mesh: mm, cm, m or in.
  void choose_unit(std::string unit) { unit_ = std::move(unit); }
  /// Draws the dialog while it is open. @return what was chosen in this frame
  [[nodiscard]] std::optional<ChosenFile> draw();

 private:
  struct Entry {
    std::string name;
    bool folder = false;
  };

  void go_to(const std::filesystem::path& folder);
  void draw_entries(float height);
  void draw_mesh_choices();
  [[nodiscard]] bool ready() const;

  bool open_ = false;
  bool just_opened_ = false;
  bool confirmed_ = false;
  FileUse use_ = FileUse::kScene;
  std::filesystem::path folder_;
  std::vector<Entry> entries_;
  std::string name_;
  std::string unit_;
};

}  // namespace palpate::app

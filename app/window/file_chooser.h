#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::app {

/// Purpose of a file that the user chooses.
enum class FileUse { kOrgan, kTool, kFurtherJaw, kTissue, kScene, kToolPath, kRecording, kSaveTissue };

/// A file that the user has chosen.
struct ChosenFile {
  FileUse use = FileUse::kScene;
  std::filesystem::path path;
  std::string unit;  // of a mesh: mm, cm, m or in
};

/// [setup] Purpose of a file dropped on the window, from its file name extension and, for .toml, its content;
/// nothing if Palpate does not read such files.
[[nodiscard]] std::optional<FileUse> use_of_file(const std::filesystem::path& file);

/// Dialog that chooses a file, by mouse or keyboard. The user must select a mesh's unit; it is never
/// guessed. All members: [setup], the window's thread, between ImGui's NewFrame and Render.
class FileChooser final {
 public:
  /// Opens the dialog. @param file folder where it starts, or a file that is selected at first
  void open(FileUse use, const std::filesystem::path& file);
  [[nodiscard]] bool is_open() const noexcept { return open_; }
  /// Selects the unit of a mesh as the user would: mm, cm, m or in.
  void choose_unit(std::string unit) { unit_ = std::move(unit); }
  /// Draws the dialog while it is open. @return the file chosen in this frame
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

#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/scene/setup.h"

namespace palpate::scene {

/// A scene that stands in no file.
struct SceneText {
  std::string toml;
  std::filesystem::path folder;  // that relative paths in it start from
};

/// What a user asked for on the command line; what is set overrides the scene file.
struct Request {
  std::optional<std::filesystem::path> scene;  // none: the gallbladder press (task pull: the heart)
  std::optional<SceneText> scene_text;         // in place of `scene`
  std::optional<std::string> task;             // press | pull
  std::optional<std::string> organ;            // built-in name or path
  std::optional<std::string> organ_unit;
  std::vector<std::string> organ_motion;  // breathing, heartbeat, none; they replace all of the scene's
  std::optional<std::string> tissue;      // built-in name or tissue file
  std::vector<std::string> tools;         // one: the tool; several: its jaws
  std::optional<std::string> tool_unit;
  std::optional<std::string> device;  // KIND[:PATH]
  std::optional<double> rate_Hz;
  std::optional<std::uint64_t> seed;
  bool no_noise = false;
};

/// [setup] Reads and checks the scene and every file it names, and resolves defaults. Paths inside a scene
/// are relative to the scene, in the request to the working folder. Reads only.
/// @throws InputError: one line with file, field or line, value and what would be right (unknown keys too,
/// with the nearest known one).
[[nodiscard]] Setup load(const Request& request);

/// [setup] A tissue by built-in name or from a tissue file. @throws InputError as load().
[[nodiscard]] model::TissueParameters load_tissue(const std::string& name_or_file);

}  // namespace palpate::scene

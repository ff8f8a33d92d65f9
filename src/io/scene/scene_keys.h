#pragma once
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/scene/toml_reader.h"
#include "palpate/scene.h"

namespace palpate::model {
struct TissueField;
}

namespace palpate::scene {

enum class KeyType { kNumber, kWhole, kTruth, kText };

/// A key of a scene file that has a single value.
struct SceneKey {
  std::string path;  // "device.mass_kg", "tissue.contact.friction"
  KeyType type = KeyType::kNumber;
  Range range{};                               // of a number
  const model::TissueField* tissue = nullptr;  // of a tissue's number, used instead of `range`

  /// [setup] @throws InputError "FLAG PATH = VALUE: must be ..." unless the text is a value of this key.
  void check(const std::string& flag, const std::string& value) const;
};

/// [any] The table of all keys. The readers of scene files check keys and ranges by it, and a Setting may set
/// each of them.
[[nodiscard]] const std::vector<SceneKey>& scene_keys();

/// [setup] The key that a user named, possibly without its unit: tissue.k1 for tissue.k1_N_per_m. @throws
/// InputError "FLAG TEXT: ...", with the nearest key.
[[nodiscard]] const SceneKey& find_scene_key(const std::string& flag, const std::string& text);

/// [setup] The keys of the table `path`, and those without a single value, for TomlTable::allow_only().
[[nodiscard]] std::vector<std::string> keys_in(std::string_view path,
                                               std::initializer_list<const char*> others = {});

/// [setup] The number of a key in a scene's table, checked against its range. @throws InputError as
/// TomlTable::number().
[[nodiscard]] std::optional<double> number_in(const TomlTable& table, std::string_view key);

/// [setup] Writes the settings into a scene; into each of its tools, devices or motions if there are several.
void apply_to_scene(std::span<const Setting> settings, toml::table& root);
/// [setup] Applies the settings of the tissue to a tissue. @throws InputError when the result is not a valid
/// tissue.
void apply_to_tissue(std::span<const Setting> settings, model::TissueParameters& tissue);

}  // namespace palpate::scene

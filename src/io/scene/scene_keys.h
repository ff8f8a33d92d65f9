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

/// A key of a scene file with a single value, or of its tissue.
struct SceneKey {
  std::string path;  // "device.mass_kg", "tissue.contact.friction"
  KeyType type = KeyType::kNumber;
  Range range{};                               // of a number
  const model::TissueField* tissue = nullptr;  // of a tissue's number, in place of `range`

  /// [setup] @throws InputError "FLAG PATH = VALUE: must be ..." unless the text is a value of this key.
  void check(const std::string& flag, const std::string& value) const;
};

/// [any] All of them: the readers of scene files check keys and ranges by this table, and a Setting may set
/// them.
[[nodiscard]] const std::vector<SceneKey>& scene_keys();

/// [setup] The key that a user means, who may leave its unit out: tissue.k1 for tissue.k1_N_per_m.
/// @throws InputError "FLAG TEXT: ...", with the key that was probably meant
[[nodiscard]] const SceneKey& find_scene_key(const std::string& flag, const std::string& text);

/// [setup] The keys of the table `path`, and those that have no single value, for TomlTable::allow_only().
[[nodiscard]] std::vector<std::string> keys_in(std::string_view path,
                                               std::initializer_list<const char*> others = {});

/// [setup] The number at a key of a scene's table, in its range. @throws InputError as TomlTable::number()
[[nodiscard]] std::optional<double> number_in(const TomlTable& table, std::string_view key);

/// [setup] Puts the settings into a scene; where it has several tools, devices or motions, into each.
void apply_to_scene(std::span<const Setting> settings, toml::table& root);
/// [setup] Puts those of the tissue into a tissue. @throws InputError when it is none then
void apply_to_tissue(std::span<const Setting> settings, model::TissueParameters& tissue);

}  // namespace palpate::scene

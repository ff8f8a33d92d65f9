#pragma once
#include <string>
#include <vector>

#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] Where the default path of a hand touches the organ first, in the world. @throws InputError when
/// the organ's mesh is not closed.
[[nodiscard]] Vec3 default_touch(const Scene& scene, std::size_t hand);

/// [setup] Remarks about default_path() for the devices that use it: the organ is too thin, or the depth that
/// the tool reaches. @throws InputError when the organ's mesh is not closed.
[[nodiscard]] std::vector<std::string> default_path_remarks(const Scene& scene);

}  // namespace palpate::scene

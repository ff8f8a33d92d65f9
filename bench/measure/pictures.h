#pragma once
#include <string>

#include "bench/measure/account.h"

namespace palpate::bench {

/// [setup] Moving pictures of 1280 x 720 pixels of a built-in scene, 60 a second of its own way in contact,
/// drawn as the window draws them: computing time of deformation and upload, wall time and computing time of
/// all threads for whole frames. The contacts are those of the scene's own organ. @param organ_triangles of
/// the organ that is drawn; 0: as built in. @throws std::runtime_error without OpenGL.
[[nodiscard]] PictureAccount time_pictures(const std::string& task, std::size_t organ_triangles);

}  // namespace palpate::bench

#pragma once
#include <string>
#include <vector>

#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] What is to be said of default_path() of the devices that take it: that the organ is too thin, and
/// how deep the tool will be. @throws InputError when the organ's mesh is not closed.
[[nodiscard]] std::vector<std::string> default_path_remarks(const Setup& setup);

}  // namespace palpate::scene

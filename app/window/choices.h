#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "palpate/scene.h"

namespace palpate::app {

/// A built-in organ's name in two parts: "heart" and "-30k".
struct OrganName {
  std::string organ;
  std::string detail;  // empty, "-30k" or "-300k"
};

/// [any] The parts of a built-in organ's name.
[[nodiscard]] OrganName parts_of(std::string_view name);
/// [setup] The built-in organs, each once.
[[nodiscard]] std::vector<std::string> organ_choices();
/// [setup] The details that a built-in organ exists in, the coarsest first; empty: it is no built-in organ.
[[nodiscard]] std::vector<std::string> detail_choices(std::string_view organ);
/// [any] A detail as text: "30,000 triangles".
[[nodiscard]] std::string detail_text(std::string_view detail);

/// [setup] The request for another task, which keeps organ and tool where they fit it: a pull needs jaws.
/// @param scene of the session @param request of the session
[[nodiscard]] scene::Overrides with_task(const scene::Scene& scene, const scene::Overrides& request,
                                         scene::Task task);

/// What a session simulates, as far as the user chooses it.
struct Selection {
  std::string task{};
  std::string organ{};
  std::string tool{};
  std::string device{};
  model::TissueParameters tissue{};  // in force
  noise::NoiseSettings noise{};      // in force
};
/// [any] What differs between two sessions, as a sentence, for the user: "Now: tool straight-forceps (before
/// sphere:5)." Empty: nothing.
[[nodiscard]] std::string changes_text(const Selection& before, const Selection& after);

}  // namespace palpate::app

#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "palpate/scene.h"

namespace palpate::app {

/// A built-in organ's or tool's name in two parts: "heart" and "-30k".
struct BuiltinName {
  std::string base;
  std::string detail;  // empty, "-30k" or "-300k"
};

/// [any] The parts of a built-in organ's or tool's name.
[[nodiscard]] BuiltinName parts_of(std::string_view name);
/// [setup] The built-in organs, each once.
[[nodiscard]] std::vector<std::string> organ_choices();
/// [setup] The built-in tools, each once.
[[nodiscard]] std::vector<std::string> tool_choices();
/// [setup] The details that a built-in organ or tool exists in, the coarsest first; empty: it is not built
/// in.
/// @param base its name without a detail
[[nodiscard]] std::vector<std::string> detail_choices(std::string_view base);
/// [any] A detail as text: "30,000 triangles". @param coarsest the text of the detail without a number
[[nodiscard]] std::string detail_text(std::string_view detail, const char* coarsest);

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

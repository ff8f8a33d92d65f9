#include "app/window/scene_pictures.h"

#include <algorithm>
#include <array>

// The assembler embeds the files of assets/scenes in the object file.
asm(R"(
  .pushsection .rodata
palpate_scene_press: .incbin ")" PALPATE_SCENE_PICTURES R"(/press.png"
palpate_scene_pull: .incbin ")" PALPATE_SCENE_PICTURES R"(/pull.png"
palpate_scene_find_the_lump: .incbin ")" PALPATE_SCENE_PICTURES R"(/find-the-lump.png"
palpate_scene_beating_heart: .incbin ")" PALPATE_SCENE_PICTURES R"(/beating-heart.png"
palpate_scene_bimanual: .incbin ")" PALPATE_SCENE_PICTURES R"(/bimanual.png"
palpate_scene_gallstone: .incbin ")" PALPATE_SCENE_PICTURES R"(/gallstone.png"
palpate_scene_heart_plaque: .incbin ")" PALPATE_SCENE_PICTURES R"(/heart-plaque.png"
palpate_scene_insert: .incbin ")" PALPATE_SCENE_PICTURES R"(/insert.png"
palpate_scene_end:
  .popsection
)");
extern "C" {
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_press[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_pull[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_find_the_lump[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_beating_heart[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_bimanual[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_gallstone[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_heart_plaque[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_insert[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_scene_end[];
}

namespace palpate::app {
namespace {

struct Picture {
  std::string_view name;
  const unsigned char* begin;
  const unsigned char* end;
};

const std::array<Picture, 8> kPictures = {{
    {"press", palpate_scene_press, palpate_scene_pull},
    {"pull", palpate_scene_pull, palpate_scene_find_the_lump},
    {"find-the-lump", palpate_scene_find_the_lump, palpate_scene_beating_heart},
    {"beating-heart", palpate_scene_beating_heart, palpate_scene_bimanual},
    {"bimanual", palpate_scene_bimanual, palpate_scene_gallstone},
    {"gallstone", palpate_scene_gallstone, palpate_scene_heart_plaque},
    {"heart-plaque", palpate_scene_heart_plaque, palpate_scene_insert},
    {"insert", palpate_scene_insert, palpate_scene_end},
}};

}  // namespace

std::span<const unsigned char> scene_picture(std::string_view name) noexcept {
  const auto found = std::find_if(kPictures.begin(), kPictures.end(),
                                  [name](const Picture& one) { return one.name == name; });
  if (found == kPictures.end()) return {};
  return {found->begin, found->end};
}

}  // namespace palpate::app

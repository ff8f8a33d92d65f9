// Keeps prepared organs in a folder, so that the next session with the same organ starts at once.
// Usage: organ_cache [FOLDER]     without FOLDER: the user's cache, which the program palpate also uses
#include "palpate/organ_cache.h"

#include <iostream>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/session.h"

int main(int argc, char** argv) {
  try {
    palpate::session::SessionOptions options;
    palpate::scene::use_organ_cache(
        options.preparation, argc > 1 ? argv[1] : palpate::scene::organ_cache_folder(),
        [](const std::string& remark) { std::cout << remark << '\n'; },
        [](const std::string& reason) { std::cerr << "organ_cache: " << reason << '\n'; });
    // The first run of this program prepares the gallbladder, later ones read it.
    for (int i = 0; i < 2; ++i) {
      const palpate::session::Session session(palpate::scene::load({}), {.preparation = options.preparation});
      std::cout << "session " << i + 1 << ": " << session.scene().organ_name << " is ready\n";
    }
  } catch (const palpate::InputError& error) {
    std::cerr << "organ_cache: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

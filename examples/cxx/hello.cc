// Runs a press from a scene file and records it. Usage: hello SCENE.toml RECORDING.h5
#include <iostream>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/session.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: hello SCENE.toml RECORDING.h5\n";
    return 2;
  }
  try {
    palpate::scene::Overrides request;
    request.scene = argv[1];
    const auto result = palpate::session::Session::open(palpate::scene::load(request))
                            .run({.recording = argv[2], .offline = true});

    std::cout << result.scene << ": " << result.loop.ticks << " ticks, deepest "
              << 1e3 * result.statistics.peak_depth << " mm, recorded in " << argv[2] << '\n';
    return 0;
  } catch (const palpate::InputError& error) {
    std::cerr << "hello: " << error.what() << '\n';
    return 2;
  }
}

// Draws a press after 3 s without a display. Usage: offscreen_picture [PICTURE.png]
// Without OpenGL it prints a message and draws nothing.
#include <iostream>
#include <stdexcept>

#include "palpate/offscreen.h"
#include "palpate/scene.h"
#include "palpate/session.h"

namespace {

/// Runs the first 3 s of the scripted hand and returns the last snapshot.
palpate::haptics::Snapshot press(const palpate::scene::Scene& scene) {
  // Publishes snapshots without blocking the loop.
  palpate::haptics::SnapshotPublisher publisher;
  palpate::session::Session(scene, {.duration_s = 3.0}).run({.offline = true}, {&publisher});
  publisher.cell().refresh();
  return publisher.cell().value();
}

void draw(const palpate::scene::Scene& scene, const char* file) {
  const palpate::haptics::Snapshot snapshot = press(scene);
  const palpate::render::Subject subject{scene.organ, scene.tools, scene.tissue.reach, scene.tissue.name};
  palpate::render::OffscreenRenderer renderer(subject, 960, 720);
  std::cout << "drawn by " << renderer.driver() << '\n';

  const palpate::contact::ToolResult& result = snapshot.results[0];
  const palpate::render::Camera camera =
      palpate::render::frame_contact(subject, snapshot, result.contact_W, result.normal_W, false);
  const palpate::render::Image image = renderer.draw(snapshot, camera);
  if (file != nullptr) palpate::render::write_png(image, file);
  std::cout << image.width << " x " << image.height << " pixels, " << 1e3 * result.depth << " mm deep\n";
}

}  // namespace

int main(int argc, char** argv) {
  const palpate::scene::Scene scene = palpate::scene::load({});
  try {
    draw(scene, argc > 1 ? argv[1] : nullptr);
  } catch (const std::runtime_error& error) {
    std::cout << "no picture: " << error.what() << '\n';
  }
  return 0;
}

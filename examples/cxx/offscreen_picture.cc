// A picture of the deepest moment of a run, without a display. Usage: offscreen_picture [PICTURE.png]
// Where no OpenGL can be had it says so and draws nothing.
#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <vector>

#include "palpate/devices/devices.h"
#include "palpate/haptics/loop.h"
#include "palpate/render/offscreen.h"
#include "palpate/scene/load.h"
#include "palpate/scene/make_world.h"

namespace {

/// What the loop last published when so many ticks were done.
palpate::haptics::Snapshot snapshot_after(const palpate::scene::Setup& setup, std::uint64_t ticks) {
  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  const auto device = palpate::devices::open_device(setup, 0);
  palpate::haptics::Device* const hand = device.get();

  // The loop leaves its newest snapshot here and never waits for whoever draws.
  palpate::haptics::SnapshotPublisher publisher;
  palpate::haptics::LoopOptions options;
  options.offline = true;
  options.ticks = ticks;
  (void)palpate::haptics::run_loop(world, state, {&hand, 1}, {&publisher}, options);
  publisher.cell().refresh();
  return publisher.cell().value();
}

void draw(const palpate::scene::Setup& setup, const char* file) {
  const palpate::haptics::Snapshot snapshot = snapshot_after(setup, 3000);
  const palpate::render::Subject subject{setup.organ, setup.tools, setup.tissue.reach, setup.tissue.name};
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
  const palpate::scene::Setup setup = palpate::scene::load({});
  try {
    draw(setup, argc > 1 ? argv[1] : nullptr);
  } catch (const std::runtime_error& error) {
    std::cout << "no picture: " << error.what() << '\n';
  }
  return 0;
}

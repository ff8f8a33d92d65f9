#pragma once
#include "io/scene/make_world.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::bench {

/// A ball pressed by a ball: fast to prepare.
inline scene::Scene sample_scene() {
  scene::Overrides request;
  request.organ = "ball";
  request.tissue = "liver";
  request.tools = {"sphere:5"};
  return scene::load(request);
}

/// The tool rests `height` [m] above the organ's centre for 20 ms, plus the device's final half second.
inline scene::ToolPath still_path(double height) {
  scene::PathRow from;
  from.position = Vec3(0.0, 0.0, height);
  scene::PathRow to = from;
  to.time = 20e-3;
  return scene::ToolPath({from, to});
}

}  // namespace palpate::bench

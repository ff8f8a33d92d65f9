#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "core/contact/contact.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/recording.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

namespace palpate::report::test {

/// A recording computed from formulas: a ball of 5 mm moves into the top of a box, from 10 mm above it to a
/// depth of 12 mm at 1.5 s, holds and returns. The force follows the law, the noise its model.
class SyntheticRecording final {
 public:
  static constexpr double kRate = 1000.0;
  static constexpr double kRadius = 5e-3;
  static constexpr double kTop = 20e-3;
  static constexpr double kClear = 10e-3;
  static constexpr double kDeepest = 12e-3;

  /// Height of the ball's lowest point above the box's top [m].
  static double height(double time) {
    const double path = kClear + kDeepest;
    if (time < 1.5) return kClear - path * time / 1.5;
    if (time < 2.0) return -kDeepest;
    return std::min(kClear, -kDeepest + path * (time - 2.0) / 1.5);
  }

  static record::Recording make(bool noise = true, int ticks = 4000) {
    record::Recording recording;
    scene::Scene& scene = recording.scene;
    scene.name = "synthetic press";
    scene.organ_name = "box <60 x 60>";
    scene.organ = geometry::make_box(Vec3(60e-3, 60e-3, 40e-3), 10e-3);
    scene.tools = {geometry::make_tool("sphere:5")};
    scene.devices.resize(1);
    scene.noise.enabled = noise;
    scene.rate_Hz = kRate;
    scene.tissue = tissue();
    scene.repairs = {"liver <1>.stl: turned 12 triangles outwards"};
    scene.remarks = {"a remark with <angle> & ampersand"};
    recording.facts.version = "0.1.0";
    recording.facts.compiler = "a compiler";
    recording.facts.machine = "a machine";
    recording.facts.started_unix_ns = 1'309'521'600'000'000'000;  // 2011-07-01 12:00:00 UTC
    recording.facts.complete = true;
    recording.facts.missed_deadlines = 3;
    recording.facts.longest_gap_ns = 2'345'678;
    fill_rows(recording, ticks);
    return recording;
  }

  static model::TissueParameters tissue() {
    model::TissueParameters tissue;
    tissue.name = "example";
    tissue.k1 = 18.0;
    tissue.beta = 1.6;
    tissue.q = 0.7;
    tissue.rest_length = 14e-3;
    tissue.max_length = 22e-3;
    tissue.min_length = 6e-3;
    tissue.t1 = 1e-6;
    return tissue;
  }

 private:
  static void fill_rows(record::Recording& recording, int ticks) {
    const model::SpringLaw law(recording.scene.tissue, model::Direction::kPress, 1.0 / kRate);
    const noise::TouchNoise noise(recording.scene.noise, kRate);
    std::mt19937_64 random(7);
    std::lognormal_distribution<double> cost(std::log(40e3), 0.25);
    std::lognormal_distribution<double> late(std::log(9e3), 0.5);
    for (int i = 0; i < ticks; ++i) {
      haptics::TickRow row;
      row.tick = static_cast<std::uint64_t>(i);
      row.time = i / kRate;
      const double above = height(row.time);
      const bool touching = above < 0.0;
      row.phase = static_cast<std::uint32_t>(touching ? contact::Phase::kPress : contact::Phase::kApproach);
      row.distance = above;
      row.depth = touching ? -above : 0.0;
      row.cutoff_layer = static_cast<std::uint32_t>(touching ? law.force_at(row.depth).cutoff_layer : 0);
      row.tissue_force = law.force_at(row.depth).force;
      if (recording.scene.noise.enabled)
        row.noise_force =
            noise.sigma(touching ? 0.0 : above) * noise::unit_sample(1, 0, noise.sample_number(row.tick));
      row.force = {0.0, 0.0, row.tissue_force + row.noise_force};
      row.tool = {0.0, 0.0, kTop + kRadius + above};
      row.tool_q = {1.0, 0.0, 0.0, 0.0};
      row.contact = {0.0, 0.0, kTop};
      row.normal = {0.0, 0.0, 1.0};
      row.tick_ns = static_cast<std::int64_t>(cost(random));
      row.late_ns = static_cast<std::int64_t>(late(random));
      row.device = row.tool;
      row.device_q = row.tool_q;
      recording.rows.push_back(row);
    }
  }
};

}  // namespace palpate::report::test

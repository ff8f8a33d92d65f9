#pragma once
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <hdf5.h>
#include <unistd.h>

#include "io/record/recorder.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/recording.h"
#include "palpate/scene.h"

namespace palpate::record {

using test::TemporaryFolder;

inline geometry::TriangleMesh tetrahedron(double size) {
  return {{{0, 0, 0}, {size, 0, 0}, {0, size / 3, 0}, {0, 0, size}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// A scene in which no field has its default, with numbers that need all their digits.
inline scene::Scene sample_setup(std::size_t hands) {
  scene::Scene scene;
  scene.name = "an odd \"name\"\nwith \xc3\xa4";
  scene.task = scene::Task::kPull;
  scene.rate_Hz = 1000.0;
  scene.seed = 0xfedcba9876543210ULL;
  scene.organ_name = "tetrahedron";
  scene.organ = tetrahedron(0.1);
  scene.organ_pose = {Quat(0.5, -0.5, 0.5, 0.5000000000000001), Vec3(0.1, -0.0, 1e-300)};
  scene.tissue.name = "soft";
  scene.tissue.k1 = 18.0 / 7.0;
  scene.tissue.beta = 1.6;
  scene.tissue.q = 0.7;
  scene.tissue.rest_length = 0.1 + 0.2;
  scene.tissue.max_length = 22e-3 / 3;
  scene.tissue.min_length = 4.9406564584124654e-324;
  scene.tissue.t1 = 1e-6 / 3;
  scene.tissue.reach = {1.1, 0.43, 1.8, 0.58, 1.1 / 3};
  scene.tissue.contact.friction = 0.30000000000000004;
  scene.tissue.contact.tangential_stiffness = 180.0 / 7;
  scene.tissue.contact.tangential_damping = 0.7 / 3;
  scene.tissue.contact.damping = 0.25;
  scene.tissue.contact.reference_radius = 0.011;
  scene.tissue.contact.grip_limit = 7.7;
  scene.tissue.law = model::LawKind::kSmooth;
  scene.tissue.relaxation = {{0.1 + 0.2, 1.0 / 3}, {1e-3, 70.1}};
  scene.tissue.source = model::SourceParameters{"ball", 3e-3};
  for (std::size_t hand = 0; hand < hands; ++hand) {
    geometry::Tool tool;
    tool.name = "tool " + std::to_string(hand);
    if (hand == 0) tool.tip_radius = 1.0 / 3.0;
    tool.parts.resize(2);
    tool.parts[0] = {
        "jaw", tetrahedron(0.01 / 3), true, Vec3(0.1, 0.2, 0.3), Vec3(0, 0.6, 0.8), -0.26179938779914941};
    tool.parts[1].name = "shaft";
    tool.parts[1].mesh = tetrahedron(0.2);
    scene.tools.push_back(tool);
    scene::DeviceSetup& device = scene.devices.emplace_back();
    device.kind = "replay";
    device.path = "a/path.h5";
    device.interpolation = scene::PathInterpolation::kCubic;
    device.path_speed = 1.5;
    device.workspace_scale = 2.5;
    device.base = {Quat(0.6, 0.8, 0, 0), Vec3(1, 2, 3.1)};
    device.dynamics.damping = 1.5;
    device.dynamics.resolution = 1e-5;
    device.clutch_button = 3U;
  }
  scene.noise = {false, 5e-5 / 7, 4e-3, 500.0, 77};
  scene.safety = {19.0, 4000.0, 0.1, 40.0};
  scene.repairs = {"box.stl: turned 12 triangles outwards"};
  scene.remarks = {"two vertices merged", "not closed"};
  return scene;
}

/// A row whose columns all differ from those of every other row.
inline haptics::TickRow sample_row(std::uint64_t tick, std::uint32_t hand) {
  haptics::TickRow row;
  row.tick = tick;
  row.time = static_cast<double>(tick) / 1000.0;
  row.hand = hand;
  row.phase = static_cast<std::uint32_t>(tick % 3);
  double value = static_cast<double>(tick) / 7.0 + static_cast<double>(hand) / 3.0;
  for (double* member : {&row.distance, &row.depth, &row.tissue_force, &row.noise_force, &row.friction,
                         &row.gripper_force, &row.gripper, &row.device_gripper, &row.device_age, &row.energy,
                         &row.engagement, &row.stimulus_force}) {
    *member = value += 0.1;
  }
  for (auto* triple :
       {&row.force, &row.torque, &row.tool, &row.contact, &row.normal, &row.device, &row.device_velocity}) {
    for (double& member : *triple) member = value += 0.1;
  }
  for (auto* four : {&row.tool_q, &row.device_q}) {
    for (double& member : *four) member = value += 0.1;
  }
  row.cutoff_layer = static_cast<std::uint32_t>(tick % 5);
  row.saturated = static_cast<std::uint32_t>(tick % 2);
  row.tick_ns = static_cast<std::int64_t>(tick) + 1000;
  row.late_ns = -static_cast<std::int64_t>(tick);
  row.status = static_cast<std::uint32_t>(tick % 4096);
  row.fault = static_cast<std::uint32_t>((tick + 1) % 3);
  row.buttons = static_cast<std::uint32_t>(tick * 3);
  row.device_valid = 1;
  row.device_fault = static_cast<std::uint32_t>((tick + 1) % 3);
  row.events = static_cast<std::uint32_t>((tick + 1) % 2);
  return row;
}

inline bool same_bits(const haptics::TickRow& a, const haptics::TickRow& b) {
  // Compares bits, also of doubles.
  return std::memcmp(&a, &b, sizeof(a)) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

inline constexpr std::int64_t kStarted = 1'700'000'000'123'456'789;

/// An offline recording of `ticks` ticks, finished properly.
inline void record_sample(const std::filesystem::path& file, std::uint64_t ticks, std::size_t hands) {
  Recorder recorder(file, sample_setup(hands), true);
  recorder.on_start(kStarted);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    for (std::uint32_t hand = 0; hand < hands; ++hand) recorder.on_row(sample_row(tick, hand));
  }
  haptics::LoopReport report;
  report.ticks = ticks;
  report.missed_deadlines = 7;
  report.longest_gap_ns = 123456;
  report.realtime_priority = true;
  report.memory_locked = true;
  report.polled = true;
  report.tick_time.add(500);
  report.lateness.add(900);
  report.watchdog_stops = 3;
  report.remarks = {"no priority: not allowed", "second remark"};
  recorder.finish(report);
}

/// Whether a plain HDF5 tool can open the file.
inline bool opens_plainly(const std::filesystem::path& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id >= 0) H5Fclose(id);
  return id >= 0;
}

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace palpate::record

#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/realtime/held_play.h"

namespace palpate::devices {

/// What a test plays. SI units.
struct DeviceTestSettings {
  int axis = 2;                    // of the device's frame: 0 x, 1 y, 2 z
  double max_force = 2.0;          // N; the steps use fractions of it
  double least_stiffness = 200.0;  // N/m, of the first virtual wall
  double max_stiffness = 20e3;     // N/m, of the last one
};

/// A mean of repeated measurements and their standard deviation.
struct Repeated {
  double mean = 0.0;
  double sd = 0.0;
};

/// What a test found, in SI units. A part that did not take place, or could not tell, is empty.
struct DeviceTest {
  double loop_rate = 0.0;            // Hz, of the program's loop
  double sample_rate = 0.0;          // Hz, new samples by their age
  double jitter_sd = 0.0;            // s, of the loop's periods
  double longest_period = 0.0;       // s
  double noise_at_rest = 0.0;        // m, standard deviation along the axis where it varies most
  std::optional<double> resolution;  // m, the step of the position; empty: finer than the noise or the motion
  std::optional<Repeated> friction;  // N, Coulomb friction of device and hand
  std::optional<Repeated> latency;   // s, from a written force to the sample that shows its effect
  std::optional<Repeated> mass;      // kg, moving mass of device and hand, if the commanded force is true
  std::optional<Repeated> rise;      // s, 10 to 90 % of the step's displacement
  std::optional<Repeated> overshoot;        // fraction of the step's displacement
  std::optional<double> largest_stable;     // N/m, stiffest virtual wall without oscillation
  std::optional<double> least_oscillating;  // N/m; empty with largest_stable: none oscillated
  std::vector<std::string> unknown;         // what the device cannot tell, in sentences
  std::string failure;                      // why the test ended early; empty: it did not
};

/// Tells the person what to do before a part. @return false: the person ends the test
using Instruct = std::function<bool(const std::string& title, const std::string& what)>;

/// [setup] Tests one held device for about three minutes: rest, slow pushes, force steps, a virtual wall that
/// becomes stiffer (docs/devices.md). Every part is guarded by HeldPlay.
[[nodiscard]] DeviceTest test_device(realtime::HeldPlay& play, const DeviceTestSettings& settings,
                                     const Instruct& instruct);

}  // namespace palpate::devices

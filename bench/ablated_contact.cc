// Plays presses, sweeps, edges, fast taps and pulls with one constant of contact changed, and compares the
// forces with those of the committed constants. tools/ablate_contact compiles it against a copy of
// contact_constants.h whose constants are variables, and in which contact::set_constants() exists. Reads one
// "NAME VALUE" per line. Prints for each: largest change of a force [mN], its 95th percentile, the motion
// with the largest change, largest change of a torque [mN m], largest growth of a step between ticks of all
// motions but the fast ones [mN], processor time [us] of a tick and hand. The first line printed is for the
// committed constants, with their largest step and its motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "core/base/portable_math.h"
#include "core/contact/contact.h"
#include "core/contact/contact_constants.h"
#include "palpate/builtin.h"
#include "palpate/tissue.h"

namespace {

using namespace palpate;

constexpr double kPeriod = 1e-3;        // s
constexpr int kTicks = 1500;            // of a motion
constexpr double kLargestForce = 20.0;  // N, as the gate limits it by default
constexpr std::array kMotions{"press", "sweep", "edge", "fast", "roll", "turn", "pull"};
constexpr std::size_t kFast = 3;  // has jumps, which are steps of the force in any case

/// An organ, its tools and the heights that the motions need.
struct Setting {
  std::string name;
  contact::World world;
  Vec3 top;          // highest point of the organ near its middle [m]
  double edge;       // half the organ's width [m]
  double tool_tips;  // the tip in the handle's frame, along z [m]
};

Setting setting(const std::string& organ_name, const std::vector<std::string>& tools, bool inclusion) {
  const geometry::TriangleMesh organ = geometry::make_organ(organ_name);
  Vec3 top(0.0, 0.0, -1.0);
  double edge = 0.0;
  for (const Vec3& v : organ.vertices) {
    if (std::hypot(v.x(), v.y()) < 8e-3 && v.z() > top.z()) top = v;
    edge = std::max(edge, v.y());
  }
  std::vector<geometry::Tool> instruments;
  double tips = -1.0;
  for (const std::string& name : tools) {
    instruments.push_back(geometry::make_tool(name));
    for (const geometry::ToolPart& part : instruments[0].parts) {
      for (const Vec3& v : part.mesh.vertices) tips = std::max(tips, v.z());
    }
  }
  model::TissueVariation variation;
  if (inclusion) variation.inclusions.push_back({top - Vec3(0.0, 0.0, 7e-3), 4e-3});
  return {organ_name + ", " + tools[0],
          contact::World(organ, instruments, model::tissue_preset("gallbladder"), kPeriod, {}, variation),
          top, edge, tips};
}

/// 0 before `from`, 1 after `to`, smooth between.
double ramp(double time, double from, double to) {
  const double u = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

double wave(double rate_Hz, double time) {
  return portable::sin_cos(2.0 * portable::kPi * rate_Hz * time).sine;
}

/// Place of the tip against the top of the organ, tilt and gripper of hand 0.
contact::ToolInput at(const Setting& s, std::size_t motion, int tick, std::size_t hand) {
  const double t = kPeriod * tick;
  Vec3 tip(0.0, 0.0, 5e-3);
  double tilt = 0.0;
  double gripper = 0.1;
  double turn = 0.0;
  switch (motion) {
    case 0:
      tip.z() -= 13e-3 * (ramp(t, 0.0, 0.5) - ramp(t, 0.9, 1.4));
      break;
    case 1:
      tip += Vec3(-12e-3 + 24e-3 * ramp(t, 0.3, 1.2), 3e-3 * wave(1.5, t),
                  -9e-3 * (ramp(t, 0.0, 0.3) - ramp(t, 1.25, 1.45)));
      tilt = 0.5 * ramp(t, 0.3, 1.0);
      break;
    case 2:  // over the rim of the organ, twice as fast on the way back
      tip +=
          Vec3(0.0, (s.edge + 4e-3) * (ramp(t, 0.2, 0.9) - ramp(t, 0.95, 1.3)), -10e-3 * ramp(t, 0.0, 0.2));
      tilt = -0.7 * ramp(t, 0.3, 0.9);
      break;
    case kFast:
      tip += Vec3(4e-3 * wave(5.0, t), 3e-3 * wave(7.0, t), -5e-3 + 9e-3 * wave(6.0, t));
      if (tick % 500 > 495) tip.z() -= 60e-3;  // faster than a hand
      break;
    case 4:  // from the tips of open jaws onto the shaft and back, while it turns
      tip += Vec3(4e-3 * wave(1.0, t), 0.0, -9e-3 * (ramp(t, 0.0, 0.2) - ramp(t, 1.3, 1.5)));
      tilt = 1.7 * (ramp(t, 0.2, 0.7) - ramp(t, 0.8, 1.3));
      gripper = 0.8;
      break;
    case 5:  // oblique open jaws slide and turn
      tip += Vec3(5e-3 + 6e-3 * wave(0.8, t), 5e-3 - 8e-3 * ramp(t, 0.4, 1.0),
                  -11e-3 * (ramp(t, 0.0, 0.2) - ramp(t, 1.3, 1.5)));
      tilt = 1.1 + 0.4 * wave(1.7, t);
      turn = 2.0 * ramp(t, 0.3, 1.2);
      gripper = 1.0;
      break;
    default:
      tip += Vec3(6e-3 * ramp(t, 0.6, 0.8), 0.0, -6e-3 * ramp(t, 0.0, 0.3) + 9e-3 * ramp(t, 0.5, 0.9));
      gripper = 0.8 - 0.8 * ramp(t, 0.3, 0.4) + 0.8 * ramp(t, 1.0, 1.1);
  }
  const double aside = hand == 0 ? 0.0 : 6e-3;
  const Quat down = rotation_about(Vec3::UnitX(), portable::kPi);
  const Quat turned =
      (rotation_about(Vec3::UnitZ(), 100.0 * aside + turn) * rotation_about(Vec3::UnitX(), tilt) * down)
          .normalized();
  const Vec3 tip_W = s.top + tip + Vec3(aside, 0.5 * aside, 0.0);
  return {{turned, tip_W - turned * Vec3(0.0, 0.0, s.tool_tips)}, gripper};
}

struct Wrench {
  Vec3 force, torque;
};

/// Wrenches of every motion, one after the other; each motion has kTicks x hands of them.
std::vector<std::vector<Wrench>> play(const std::vector<Setting>& settings, double& time_us) {
  std::vector<std::vector<Wrench>> all;
  std::size_t count = 0;
  const std::clock_t begun = std::clock();
  for (const Setting& s : settings) {
    const std::size_t hands = s.world.tool_count();
    for (std::size_t motion = 0; motion < kMotions.size(); ++motion) {
      contact::State state(s.world);
      std::vector<contact::ToolInput> inputs(hands);
      std::vector<contact::ToolResult> results(hands);
      std::vector<Wrench>& wrenches = all.emplace_back();
      for (int tick = 0; tick < kTicks; ++tick) {
        for (std::size_t hand = 0; hand < hands; ++hand) inputs[hand] = at(s, motion, tick, hand);
        contact::advance(s.world, {}, inputs, state, results);
        for (const contact::ToolResult& r : results) {
          const double felt = std::min(1.0, kLargestForce / std::max(r.force_W.norm(), 1e-9));
          wrenches.push_back({felt * r.force_W, felt * r.torque_W});
        }
      }
      count += wrenches.size();
    }
  }
  time_us = 1e6 * static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC / static_cast<double>(count);
  return all;
}

std::string name_of(const Setting& s, std::size_t motion) {
  return std::string(kMotions[motion % kMotions.size()]) + " (" + s.name + ")";
}

/// @param usual the wrenches of the committed constants; empty: these are they
void report(const std::vector<Setting>& settings, const std::string& name,
            const std::vector<std::vector<Wrench>>& usual) {
  double time_us = 0.0;
  const auto now = play(settings, time_us);
  std::vector<double> changes{0.0};
  double largest = 0.0;
  double torque = 0.0;
  double step = 0.0;
  std::string where = "-";
  for (std::size_t m = 0; m < now.size(); ++m) {
    const Setting& s = settings[m / kMotions.size()];
    const std::size_t hands = s.world.tool_count();
    for (std::size_t i = 0; i < now[m].size(); ++i) {
      if (i >= hands && m % kMotions.size() != kFast) {
        const double before = usual.empty() ? 0.0 : (usual[m][i].force - usual[m][i - hands].force).norm();
        const double grown = (now[m][i].force - now[m][i - hands].force).norm() - before;
        if (usual.empty() && grown > step) where = name_of(s, m);
        step = std::max(step, grown);
      }
      if (usual.empty()) continue;
      torque = std::max(torque, (now[m][i].torque - usual[m][i].torque).norm());
      if (now[m][i].force.isZero(0.0) && usual[m][i].force.isZero(0.0)) continue;
      changes.push_back((now[m][i].force - usual[m][i].force).norm());
      if (changes.back() <= largest) continue;
      largest = changes.back();
      where = name_of(s, m);
    }
  }
  std::sort(changes.begin(), changes.end());
  std::printf("%s\t%.3g\t%.3g\t%s\t%.3g\t%.4g\t%.2f\n", name.c_str(), 1e3 * largest,
              1e3 * changes[changes.size() * 95 / 100], where.c_str(), 1e3 * torque, 1e3 * step, time_us);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::vector<Setting> settings;
  settings.push_back(setting("gallbladder", {"straight-forceps"}, false));
  settings.push_back(setting("liver", {"curved-forceps", "straight-forceps"}, true));
  settings.push_back(setting("box", {"curved-forceps"}, false));
  settings.push_back(setting("kidney", {"sphere:4"}, false));
  double time_us = 0.0;
  const auto usual = play(settings, time_us);
  report(settings, "as committed", {});
  std::string name;
  for (double value = 0.0; std::cin >> name >> value;) {
    contact::set_constants(name, value);
    report(settings, name, usual);
  }
}

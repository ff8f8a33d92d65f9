// `palpate devices`: lists the available devices and the reasons why others are unavailable; --try reads one
// device.
#include "run/devices/devices.h"

#include <algorithm>
#include <cstdint>
#include <iostream>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/clock.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/output.h"

namespace palpate::app {
namespace {

using Json = nlohmann::ordered_json;

struct DevicesFlags {
  std::string try_one;
  bool as_json = false;
};

int list_devices(bool as_json) {
  const std::vector<devices::Probe> probes = devices::probe_devices();
  if (as_json) {
    Json list = Json::array();
    for (const devices::Probe& probe : probes) {
      Json reasons = Json::array();
      for (const devices::Reason& reason : probe.reasons) {
        reasons.push_back({{"what", reason.what}, {"command", reason.command}});
      }
      list.push_back({{"kind", probe.kind},
                      {"available", probe.available},
                      {"words", probe.text},
                      {"reasons", reasons}});
    }
    std::cout << json_text(Json{{"devices", list}}, -1) << '\n';
    return kDone;
  }
  constexpr std::size_t kKindWidth = 16;
  for (const devices::Probe& probe : probes) {
    std::string kind = probe.kind;
    kind.resize(std::max(kKindWidth, kind.size() + 1), ' ');
    std::cout << kind << (probe.available ? "available:    " : "unavailable:  ") << probe.text << '\n';
    for (const devices::Reason& reason : probe.reasons) {
      std::cout << std::string(kKindWidth, ' ') << "- " << reason.what << '\n'
                << std::string(kKindWidth, ' ') << "  $ " << reason.command << '\n';
    }
  }
  return kDone;
}

/// Result of reading a device for a short time at zero force.
struct Look {
  std::string name;
  haptics::DeviceState last;
  std::uint64_t reads = 0;
  std::uint64_t fresh = 0;  // reads that returned a new sample
  std::string last_error;
};

/// Opens the device and reads it for 0.2 s at 1 kHz. Commands no force, so the device stays at zero force.
Look look_at(const std::string& what) {
  constexpr std::uint64_t kReads = 200;
  constexpr std::int64_t kPeriod_ns = 1'000'000;
  const devices::OpenedDevice opened = devices::open_connected(what);
  Look look;
  look.name = opened.name;
  const std::int64_t begin = monotonic_ns();
  double age = 0.0;  // s, age of the previous sample
  for (; look.reads < kReads; ++look.reads) {
    sleep_until_ns(begin + static_cast<std::int64_t>(look.reads) * kPeriod_ns);
    look.last = opened.device->read(look.reads, static_cast<double>(look.reads) * 1e-3);
    // When the device has no new sample, the age grows by 1 ms from one read to the next.
    const bool fresh = look.last.age < age + 0.5e-3 && look.last.age < haptics::kStaleAfter;
    if (fresh && look.last.fault == haptics::Fault::kNone) ++look.fresh;
    age = look.last.age;
  }
  opened.device->stop();
  look.last_error = opened.device->last_error();
  return look;
}

std::vector<double> scaled(const Vec3& v, double unit) { return {v.x() / unit, v.y() / unit, v.z() / unit}; }

std::vector<int> pressed_buttons(std::uint32_t mask) {
  std::vector<int> pressed;
  for (int bit = 0; bit < 32; ++bit) {
    if ((mask >> static_cast<unsigned>(bit) & 1U) != 0) pressed.push_back(bit);
  }
  return pressed;
}

void print_json(const Look& look) {
  const Quat& q = look.last.orientation_D;
  Json json;
  json["name"] = look.name;
  json["reads"] = look.reads;
  json["new_samples"] = look.fresh;
  json["position_mm"] = scaled(look.last.position_D, kMillimetre);
  json["orientation_wxyz"] = {q.w(), q.x(), q.y(), q.z()};
  json["velocity_m_per_s"] = scaled(look.last.velocity_D, 1.0);
  json["gripper"] = look.last.gripper;
  json["buttons"] = pressed_buttons(look.last.buttons);
  json["fault"] = haptics::name_of(look.last.fault);
  json["trouble"] = look.last_error;
  std::cout << json_text(json, -1) << '\n';
}

void print_lines(const Look& look) {
  const auto list = [](const auto& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : " ") + shortest(value);
    return text;
  };
  const Quat& q = look.last.orientation_D;
  const std::vector<int> pressed = pressed_buttons(look.last.buttons);
  std::cout << look.name << '\n'
            << "  new samples  " << look.fresh << " in " << look.reads << " reads, one per millisecond\n"
            << "  position     " << list(scaled(look.last.position_D, kMillimetre)) << " mm\n"
            << "  orientation  " << list(std::vector<double>{q.w(), q.x(), q.y(), q.z()}) << " (w x y z)\n"
            << "  velocity     " << list(scaled(look.last.velocity_D, 1.0)) << " m/s\n"
            << "  gripper      " << shortest(look.last.gripper) << " (0 closed, 1 open)\n"
            << "  buttons      " << (pressed.empty() ? "none pressed" : list(pressed) + " pressed") << '\n'
            << "  state        "
            << (look.last.fault == haptics::Fault::kNone ? "no fault" : haptics::describe(look.last.fault))
            << '\n';
  if (!look.last_error.empty()) std::cout << "  error        " << look.last_error << '\n';
}

int try_device(const DevicesFlags& flags) {
  const Look look = look_at(flags.try_one);
  if (flags.as_json) {
    print_json(look);
  } else {
    print_lines(look);
  }
  return look.last.fault == haptics::Fault::kNone ? kDone : kFault;
}

}  // namespace

void add_devices(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<DevicesFlags>();
  CLI::App* command =
      program.add_subcommand("devices", "List the available devices, and why others are unavailable");
  command->add_option("--try", flags->try_one,
                      "KIND[:PATH], e.g. forcedimension:/path/libdhd.so: open that device at zero force and "
                      "print its name, version, pose and buttons; exit code 3 when it reports a fault");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n  palpate devices\n  palpate devices --try forcedimension --json\n"
      "  palpate devices test forcedimension");
  add_device_test(*command, exit_code);
  command->callback([flags, command, &exit_code] {
    if (!command->get_subcommands().empty()) return;  // which has run by itself
    exit_code = flags->try_one.empty() ? list_devices(flags->as_json) : try_device(*flags);
  });
}

}  // namespace palpate::app

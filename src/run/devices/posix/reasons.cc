#include "run/devices/reasons.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

#include "io/system/files.h"

namespace palpate::devices {
namespace {

namespace fs = std::filesystem;

/// USB vendor and product numbers. An empty product matches every product of the vendor.
struct UsbNumber {
  std::string_view vendor;
  std::string_view product;
};

// Numbers in packaging/60-palpate.rules (docs/devices.md).
constexpr UsbNumber kForceDimensionNumbers[] = {{"1451", ""}, {"0403", "cb48"}};
constexpr UsbNumber kTouchNumbers[] = {{"2988", ""}, {"0301", "2988"}};
constexpr const char* kRuleFolders[] = {"etc/udev/rules.d", "run/udev/rules.d", "usr/local/lib/udev/rules.d",
                                        "usr/lib/udev/rules.d", "lib/udev/rules.d"};
constexpr unsigned kHaplyPort = 10001;
constexpr unsigned kOldHaplyPort = 10000;  // port of protocols before 3.1

std::string first_line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// Entries of a folder, sorted by name. Empty when the folder cannot be read.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    entries.push_back(at->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool begins(const fs::path& file, std::string_view start) {
  return file.filename().string().compare(0, start.size(), start) == 0;
}

bool is_there(const fs::path& file) {
  std::error_code error;  // an error counts as absent: these are only hints
  return fs::exists(file, error);
}

/// Name of a device node on the machine itself, such as /dev/ttyACM0.
std::string name_of_node(const Machine& machine, const fs::path& node) {
  return "/" + node.lexically_relative(machine.root).string();
}

/// Process that has a node open, as in "Touch_Diagnostic (process 4242)". Empty when this user can see no
/// such process.
std::string holder_of(const Machine& machine, const std::string& node) {
  for (const fs::path& process : entries_of(machine.root / "proc")) {
    const std::string id = process.filename().string();
    if (id.find_first_not_of("0123456789") != std::string::npos || id == std::to_string(process_id()))
      continue;
    for (const fs::path& file : entries_of(process / "fd")) {
      std::error_code error;
      if (fs::read_symlink(file, error) == node) {
        return fmt::format("{} (process {})", first_line_of(process / "comm"), id);
      }
    }
  }
  return {};
}

bool has_udev_rule(const Machine& machine, const UsbNumber& number) {
  for (const char* folder : kRuleFolders) {
    for (const fs::path& file : entries_of(machine.root / folder)) {
      std::ifstream in(file);
      for (std::string line; std::getline(in, line);) {
        const bool names_it =
            line.find(fmt::format("idVendor}}==\"{}\"", number.vendor)) != std::string::npos &&
            line.find(number.product) != std::string::npos;
        if (names_it && line.front() != '#') return true;
      }
    }
  }
  return false;
}

Reason rights_reason(const Machine& machine, const std::string& node, const UsbNumber& number) {
  if (has_udev_rule(machine, number)) {
    return {node +
                " is not open to this user, although a udev rule names the device: log in at this "
                "computer (not by ssh) and plug the device in again after",
            "sudo udevadm control --reload"};
  }
  const std::string product =
      number.product.empty() ? "" : fmt::format(R"(ATTRS{{idProduct}}=="{}", )", number.product);
  return {node + " is not open to this user, and no udev rule names the device",
          fmt::format(
              R"(echo 'SUBSYSTEM=="usb|tty|hidraw", ATTRS{{idVendor}}=="{}", {}MODE="0660", TAG+="uaccess"' )"
              "| sudo tee /etc/udev/rules.d/60-haptic-{}.rules   # then plug it in again",
              number.vendor, product, number.vendor)};
}

void add_reasons_of_node(const Machine& machine, const fs::path& node, const UsbNumber& number,
                         std::vector<Reason>& reasons) {
  const std::string name = name_of_node(machine, node);
  if (is_there(node) && !machine.may_open(node)) reasons.push_back(rights_reason(machine, name, number));
  const std::string holder = holder_of(machine, name);
  if (holder.empty()) return;
  reasons.push_back({fmt::format("{} is in use by {}: end that program", name, holder), "fuser -v " + name});
}

/// Serial ports and hidraw devices that the kernel made for a USB device.
std::vector<fs::path> ports_of(const Machine& machine, const fs::path& device) {
  std::vector<fs::path> ports;
  std::error_code error;
  for (fs::recursive_directory_iterator at(device, error), end; !error && at != end; at.increment(error)) {
    const std::string folder = at->path().parent_path().filename().string();
    if (folder == "tty" || folder == "hidraw") ports.push_back(machine.root / "dev" / at->path().filename());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

fs::path usb_node(const Machine& machine, const fs::path& device) {
  const auto number = [&](const char* file) { return std::atoi(first_line_of(device / file).c_str()); };
  return machine.root / fmt::format("dev/bus/usb/{:03}/{:03}", number("busnum"), number("devnum"));
}

/// Calls `look` for each USB device with one of these numbers. @return the number of such devices
template <std::size_t n, typename Look>
int for_each_usb_device(const Machine& machine, const UsbNumber (&numbers)[n], const Look& look) {
  int found = 0;
  for (const fs::path& device : entries_of(machine.root / "sys/bus/usb/devices")) {
    const std::string vendor = first_line_of(device / "idVendor");
    const std::string product = first_line_of(device / "idProduct");
    for (const UsbNumber& number : numbers) {
      if (vendor != number.vendor || (!number.product.empty() && product != number.product)) continue;
      look(device, number);
      ++found;
    }
  }
  return found;
}

std::vector<Reason> likeliest(std::vector<Reason> reasons) {
  if (reasons.size() > kMaxReasons) reasons.resize(kMaxReasons);
  return reasons;
}

/// Why the loader does not find a vendor's library, with the command that helps.
Reason library_reason(const Machine& machine, const std::string& file, const std::string& product,
                      const std::string& command) {
  for (const char* folder : {"usr/local/lib", "usr/lib", "usr/lib/x86_64-linux-gnu"}) {
    if (!is_there(machine.root / folder / file)) continue;
    return {fmt::format("/{}/{} is there, and the system's loader does not find it", folder, file),
            "sudo ldconfig"};
  }
  return {product + " is not installed", command};
}

bool listens(const Machine& machine, unsigned port) {
  const std::string wanted = fmt::format(":{:04X} ", port);
  for (const char* table : {"proc/net/tcp", "proc/net/tcp6"}) {
    std::ifstream in(machine.root / table);
    for (std::string line; std::getline(in, line);) {
      // The columns are sl, local address:port, remote address:port and state. State 0A is a listening port.
      const std::size_t local = line.find(wanted);
      const bool listening = line.find(":0000 0A ") != std::string::npos;
      if (listening && local != std::string::npos && local < line.find(":0000 0A ")) return true;
    }
  }
  return false;
}

/// Adds the reasons that concern the files of Touch_Setup and the folder where the vendor's library reads
/// them.
void add_touch_setup_reasons(const Machine& machine, std::vector<Reason>& reasons) {
  const std::string home = machine.variable("GTDD_HOME");
  if (home.empty()) {
    if (!machine.variable("SUDO_USER").empty()) {
      reasons.push_back({"GTDD_HOME is not set under sudo", "sudo -E palpate devices --try touch"});
      return;
    }
    const std::string user = machine.variable("HOME") + "/.3dsystems";  // folder of newer drivers
    const bool users_own = is_there(machine.root / fs::path(user).relative_path());
    reasons.push_back({"GTDD_HOME is not set, must be the folder that Touch_Setup wrote to",
                       "export GTDD_HOME=" + (users_own ? user : "/usr/share/3DSystems")});
    return;
  }
  const fs::path folder = machine.root / fs::path(home).relative_path();
  const std::vector<fs::path> files = entries_of(folder / "config");
  const bool paired = std::any_of(files.begin(), files.end(),
                                  [](const fs::path& file) { return file.extension() == ".config"; });
  if (!is_there(folder)) {
    reasons.push_back({fmt::format("GTDD_HOME = \"{}\": there is no such folder", home),
                       "export GTDD_HOME=/usr/share/3DSystems"});
  } else if (!paired) {
    reasons.push_back({fmt::format("no arm is set up in {}/config", home), "Touch_Setup"});
  }
}

}  // namespace

std::string Machine::variable_of_process(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): at set-up only
  return value == nullptr ? "" : value;
}

bool Machine::may_read_and_write(const fs::path& file) { return access(file.c_str(), R_OK | W_OK) == 0; }

std::vector<Reason> forcedimension_reasons(const Machine& machine, bool library) {
  std::vector<Reason> reasons;
  if (!library) {
    reasons.push_back(library_reason(machine, "libdhd.so.3", "Force Dimension's SDK",
                                     "sudo cp libdhd.so.3 /usr/local/lib && sudo ldconfig"));
  }
  const int found = for_each_usb_device(
      machine, kForceDimensionNumbers, [&](const fs::path& device, const UsbNumber& number) {
        add_reasons_of_node(machine, usb_node(machine, device), number, reasons);
        for (const fs::path& part : entries_of(device)) {
          std::error_code error;
          if (fs::read_symlink(part / "driver", error).filename() != "ftdi_sio") continue;
          reasons.push_back({"the kernel's serial driver holds the Falcon",
                             fmt::format("echo {} | sudo tee /sys/bus/usb/drivers/ftdi_sio/unbind",
                                         part.filename().string())});
        }
      });
  if (found == 0) {
    reasons.push_back({"no Force Dimension device (1451) and no Falcon (0403:cb48) is on USB, switched on",
                       "lsusb -d 1451: ; lsusb -d 0403:cb48"});
  }
  return likeliest(std::move(reasons));
}

std::vector<Reason> touch_reasons(const Machine& machine, bool library) {
  std::vector<Reason> reasons;
  if (!library) {
    reasons.push_back(library_reason(machine, "libHD.so", "OpenHaptics with the Touch Device Driver",
                                     "ldconfig -p | grep -e libHD -e libPhantomIOLib42"));
  }
  add_touch_setup_reasons(machine, reasons);
  const int found =
      for_each_usb_device(machine, kTouchNumbers, [&](const fs::path& device, const UsbNumber& number) {
        const std::vector<fs::path> ports = ports_of(machine, device);
        for (const fs::path& port : ports) add_reasons_of_node(machine, port, number, reasons);
        if (!ports.empty()) return;
        reasons.push_back(
            {"an arm is on USB, and the kernel made no /dev/ttyACM* of it", "sudo modprobe cdc_acm"});
      });
  if (found == 0) {
    reasons.push_back({"no arm (2988 or 0301:2988) is on USB, switched on; one on Ethernet is not seen here",
                       "lsusb -d 2988: ; lsusb -d 0301:2988"});
  }
  return likeliest(std::move(reasons));
}

std::vector<Reason> haply_reasons(const Machine& machine) {
  std::vector<Reason> reasons;
  if (!listens(machine, kHaplyPort)) {
    bool installed = false;
    for (const char* folder : {"etc/systemd/system", "usr/lib/systemd/system", "lib/systemd/system"}) {
      installed = installed || is_there(machine.root / folder / "haply-inverse-service.service");
    }
    if (installed && listens(machine, kOldHaplyPort)) {
      reasons.push_back(
          {"the service listens on port 10000 alone: it is older than 3.1, or its port was changed",
           "sudo apt install ./haply-inverse-service*.deb"});
    } else if (installed) {
      reasons.push_back({"Haply's Inverse Service is installed and does not run",
                         "sudo systemctl start haply-inverse-service"});
    } else {
      reasons.push_back({"Haply's Inverse Service is not installed (from Haply, alone or with Haply Hub)",
                         "sudo apt install ./haply-inverse-service*.deb"});
    }
  }
  bool port = false;
  for (const fs::path& node : entries_of(machine.root / "dev")) {
    if (!begins(node, "ttyACM") && !begins(node, "ttyUSB")) continue;
    port = true;
    const std::string name = name_of_node(machine, node);
    if (!machine.may_open(node)) {
      reasons.push_back({name + " is not open to this user; a service that Haply Hub starts needs it",
                         "sudo usermod -aG dialout $USER   # then log in again"});
    }
    const std::string holder = holder_of(machine, name);
    if (holder.empty() || holder.compare(0, 5, "haply") == 0) continue;
    reasons.push_back({fmt::format("{} is in use by {}", name, holder), "fuser -v " + name});
  }
  if (!port) {
    reasons.push_back(
        {"no serial port: the Inverse3 is not plugged in or has no power", "ls /dev/ttyACM* /dev/ttyUSB*"});
  }
  return likeliest(std::move(reasons));
}

std::vector<Reason> mouse_reasons(const Machine& machine) {
  if (!machine.variable("DISPLAY").empty() || !machine.variable("WAYLAND_DISPLAY").empty()) return {};
  return {{"there is no display, and the window of `palpate run` needs one (not its page: run --page)",
           "ssh -X HOST"}};
}

std::vector<Reason> gamepad_reasons(const Machine& machine) {
  std::vector<Reason> reasons = mouse_reasons(machine);
  bool pad = false;
  bool open = false;
  for (const fs::path& input : entries_of(machine.root / "sys/class/input")) {
    if (!begins(input, "js")) continue;
    pad = true;
    for (const fs::path& part : entries_of(input / "device")) {
      const fs::path node = machine.root / "dev/input" / part.filename();
      if (!begins(part, "event")) continue;
      open = open || machine.may_open(node);
      if (machine.may_open(node)) continue;
      reasons.push_back({name_of_node(machine, node) + (is_there(node) ? " is not open to this user"
                                                                       : " is missing, as in a container"),
                         is_there(node) ? "sudo usermod -aG input $USER   # then log in again"
                                        : "docker run --device /dev/input"});
    }
  }
  if (open) return mouse_reasons(machine);
  if (!pad) reasons.push_back({"no gamepad is plugged in or paired", "ls /sys/class/input/ | grep js"});
  if (!pad && !is_there(machine.root / "sys/module/joydev")) {
    reasons.push_back({"the kernel's module for gamepads is not loaded", "sudo modprobe joydev"});
  }
  return likeliest(std::move(reasons));
}

}  // namespace palpate::devices

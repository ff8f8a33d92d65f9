#pragma once
#include <string>
#include <vector>

namespace palpate::devices {

/// A reason why a kind of device cannot be used on this machine.
struct Reason {
  std::string what;     // "/dev/ttyACM0 is not open to this user"
  std::string command;  // that repairs it, or shows the cause

  bool operator==(const Reason&) const = default;
};

/// Availability of one kind of device on this machine, for the user.
struct Probe {
  std::string kind;               // a name of src/io/scene/device_kinds.h
  bool available = false;         // a run could open one now
  std::string text;               // one line: the found device, or the missing part
  bool library = true;            // the vendor's library is installed, or the kind needs none
  std::vector<Reason> reasons{};  // causes, the most likely first
};

}  // namespace palpate::devices

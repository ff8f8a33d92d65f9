#pragma once
#include <string>
#include <vector>

namespace palpate::devices {

/// A reason why a kind of device cannot be used on this machine.
struct Reason {
  std::string what;     // "/dev/ttyACM0 is not open to this user"
  std::string command;  // that mends it, or shows what is wrong

  bool operator==(const Reason&) const = default;
};

/// What there is of one kind of device, for people.
struct Probe {
  std::string kind;               // a name of src/io/scene/device_kinds.h
  bool available = false;         // a run could open one now
  std::string words;              // what there is, or what is missing; one line
  bool library = true;            // the maker's library is installed, or the kind has none
  std::vector<Reason> reasons{};  // what stands in the way, the likeliest first
};

}  // namespace palpate::devices

#pragma once
#include <string>

namespace palpate::devices {

/// What is there of one kind of device, for people.
struct Probe {
  std::string kind;        // a name of src/io/scene/device_kinds.h
  bool available = false;  // a run could open one now
  std::string words;       // what is there, or what is missing and what would help; one line
};

}  // namespace palpate::devices

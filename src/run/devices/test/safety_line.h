#pragma once
#include <cmath>
#include <cstdio>
#include <string>

namespace palpate::test {

/// One fault that a test injected, and its outcome. tools/update_safety makes the table of docs/safety.md
/// from these lines. It runs the test programs with --gtest_filter='*Safety*', so a test that prints a line
/// needs "Safety" in its suite's or its own name. No text may contain '|' or a line break.
struct SafetyLine {
  std::string device;     // kind, as in a scene: "emulated"
  std::string fault;      // "freeze", "wrong units", ...
  std::string injected;   // what was done: "the same sample for 100 ms while pressing with 1.2 N"
  double zero_within_ms;  // from the tick that latched the fault to zero force; NaN: no fault was due
  std::string cause;      // the fault that the rows keep (haptics::name_of)
  std::string recovery;   // what followed the end of the fault: "reset, then engaged again after 1.3 s"
  bool survived;          // whether all expectations of the test were met
};

/// Prints "SAFETY kind|fault|injected|zero within ms|recorded cause|recovery|survived", one line.
inline void tell(const SafetyLine& line) {
  std::string zero = "-";
  if (std::isfinite(line.zero_within_ms)) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", line.zero_within_ms);
    zero = text;
  }
  std::printf("SAFETY %s|%s|%s|%s|%s|%s|%s\n", line.device.c_str(), line.fault.c_str(), line.injected.c_str(),
              zero.c_str(), line.cause.c_str(), line.recovery.c_str(), line.survived ? "yes" : "no");
}

}  // namespace palpate::test

#pragma once
// The stand-in for OpenHaptics' HD library as a test sees it: simulated arms, the calls that they received,
// and a scheduler with its own thread. It is plain data behind one exported function. `mutex` guards all of
// it.
#include <condition_variable>
#include <mutex>
#include <vector>

namespace palpate::devices::stand_in {

inline constexpr int kHdArms = 2;

/// One simulated arm; numbers are in the vendor's frame and units.
struct HdArm {
  const char* name = "Default Device";
  double position[3] = {0.0, 0.0, 0.0};  // mm
  double velocity[3] = {0.0, 0.0, 0.0};  // mm/s
  double transform[16] = {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  int buttons = 0;
  bool held = true;                                    // its safety switch is closed
  bool in_inkwell = false;                             // its inkwell switch is open
  double max_force = 3.3;                              // N
  double continuous_force = 0.0;                       // N; 0: not reported
  std::vector<double> temperatures = {0.1, 0.1, 0.1};  // of its motors; empty: not reported
  int temperatures_asked = 0;
  unsigned calibration = 0x5000;
  int calibration_style = 4;
  unsigned after_update = 0x5000;  // calibration state after hdUpdateCalibration

  // Faults.
  unsigned init_error = 0;
  unsigned enable_error = 0;
  unsigned begin_error = 0;  // at the beginning of every frame
  unsigned frame_error = 0;  // at the end of every frame

  // Effects of the calls.
  bool open = false;
  bool force_enabled = false;
  int opens = 0;
  int closes = 0;
  int updates = 0;  // calls of hdUpdateCalibration
  unsigned update_style = 0;
  unsigned long frames = 0;
  double force[3] = {0.0, 0.0, 0.0};  // N, last set
};

struct HdWorld {
  std::mutex mutex;
  HdArm arms[kHdArms];
  unsigned start_error = 0;
  bool silent = false;   // the scheduler runs but does not call back
  bool stepped = false;  // it calls back once per step in `asked` instead of at 1 kHz
  unsigned long asked = 0;
  unsigned long done = 0;           // callbacks of stepped frames
  std::condition_variable changed;  // asked or done
  bool running = false;
  unsigned long rate = 0;  // Hz, as requested
  int starts = 0;
  int callbacks = 0;  // callbacks that are scheduled now
  int illegal = 0;    // calls for a state, force or frame outside the scheduler's thread or a frame
  std::vector<const char*> order;  // steps of closing: "zero", "stop", "disable force", "close"
};

/// Name and type of the exported function that gives the library's data.
inline constexpr const char* kHdEntry = "palpate_hd_stand_in";
using HdEntry = HdWorld* (*)();

}  // namespace palpate::devices::stand_in

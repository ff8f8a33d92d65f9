#pragma once
// The stand-in for Force Dimension's library as a test sees it: simulated devices and the commands that they
// received. It is plain data behind one exported function, so that the library can be opened and closed.

namespace palpate::devices::stand_in {

inline constexpr int kDevices = 4;

/// One simulated device. A test sets its pose, or a hand and the force move its mass.
struct Device {
  double position[3] = {0.0, 0.0, 0.0};  // m
  double rotation[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  double velocity[3] = {0.0, 0.0, 0.0};  // m/s
  double gripper_angle = 0.0;            // rad
  unsigned buttons = 0;
  int type = 0;  // 60: a Falcon
  bool has_wrist = true;
  bool has_gripper = true;

  double mass = 0.0;                       // kg, moved 1 ms per command; 0: the test sets the pose
  double damping = 0.0;                    // N s/m
  double hand_force[3] = {0.0, 0.0, 0.0};  // N

  // Faults: the results of the calls and the status that the device reports.
  int pose_result = 0;  // 1: time-guarded, the last sample again
  int velocity_result = 0;
  int status_result = 0;
  int write_result = 0;  // 2: a motor is saturated
  int enable_result = 0;
  int open_result = 0;
  int error = 0;  // number of the error behind a negative result
  bool powered = true;
  bool uncalibrated = false;
  int force_off_cause = 0;  // not 0: the force goes off, and stays off until the cause is 0 again

  // Effects of the calls.
  bool open = false;
  bool force_on = false;
  bool brakes = false;
  int watchdog = -1;  // steps of 125 us; -1: never set
  int opens = 0;
  int closes = 0;
  unsigned long writes = 0;
  double force[3] = {0.0, 0.0, 0.0};  // N, last written
  double torque[3] = {0.0, 0.0, 0.0};
  double gripper_force = 0.0;
  double guarded_position[3] = {0.0, 0.0, 0.0};  // m, result of a time-guarded call
};

struct Library {
  int version[4] = {3, 17, 1, 0};
  int count = 1;  // connected devices, or -1
  bool expert = false;
  Device devices[kDevices];
};

/// Name and type of the exported function that gives the library's data.
inline constexpr const char* kEntry = "palpate_stand_in";
using Entry = Library* (*)();

}  // namespace palpate::devices::stand_in

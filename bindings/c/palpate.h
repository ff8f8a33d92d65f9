#pragma once
// Palpate's C interface (C99): an organ and instruments are loaded, the program around it ticks at its own
// rate with samples of its own device and gets back what the device is to give; the deformed surface is read
// back for the picture. One shared library, libpalpate.so.
//
// Units are SI (m, N, N m, s), quaternions are w x y z, the world is right-handed with z up. Every function
// but those that return a pointer or a number returns a palpate_status; what is wrong is then told by
// palpate_last_error(), one line that names the field, its value and what would be right. Nothing is thrown,
// no signal handler is set, nothing is printed. All memory that a caller sees is the caller's, but for what
// palpate_open() and palpate_law_open() make and texts, which live as said.
//
// Who may call: [setup] may allocate, read files and take seconds; not while another thread is inside any
// function for the same object. [rt] never allocates, locks or calls the system: for the thread of the haptic
// loop, one thread at a time for one simulation. [picture] for one further thread, which may run beside [rt].
// [any] from any thread at any time. Different simulations know nothing of one another.
//
// Every struct that crosses begins with its own size: set all to zero, then struct_size = sizeof it. A size
// that is not this library's is refused, so a program that was compiled with another header finds out.
#include <stddef.h>
#include <stdint.h>

/// The version of this interface: it changes when a program must be recompiled, and is the library's
/// SONAME (libpalpate.so.0).
#define PALPATE_ABI_VERSION 0

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// How a call went.
typedef int32_t palpate_status;
#define PALPATE_OK 0
#define PALPATE_ERROR_USE 1    // called wrongly: a null pointer, a wrong size, out of order
#define PALPATE_ERROR_INPUT 2  // a scene, a file or a number is bad
#define PALPATE_ERROR_OTHER 3  // no memory, and what else the system refuses

#define PALPATE_MAX_HANDS 4

/// What palpate_result.phase says.
#define PALPATE_APPROACH 0
#define PALPATE_PRESS 1
#define PALPATE_PULL 2

/// Why a hand's force is zero: palpate_result.fault. A fault latches until palpate_reset_fault(). The same
/// numbers are for palpate_sample.fault: what the program knows to be wrong with its device.
#define PALPATE_FAULT_NONE 0
#define PALPATE_FAULT_NOT_FINITE 1    // a sample or a force was not finite
#define PALPATE_FAULT_DEVICE 2        // the device could not be read, or refused a command
#define PALPATE_FAULT_STALE_SAMPLE 3  // the sample was older than 5 ms
#define PALPATE_FAULT_STALLED_LOOP 4  // the program's loop stood still
#define PALPATE_FAULT_FORCE_OFF 5     // the device switched its force off

/// Bits of palpate_result.status.
#define PALPATE_STARTED_INSIDE (UINT32_C(1) << 0)  // no force until the tool has been outside the organ
#define PALPATE_CONTACTS_FULL (UINT32_C(1) << 1)   // more than four contacts wanted on one part of a tool
#define PALPATE_GRIP_RELEASED (UINT32_C(1) << 2)   // past the grip's limit: it has let go
#define PALPATE_JUMP (UINT32_C(1) << 3)            // moved faster than any hand: contacts are reset
#define PALPATE_FORCE_CLAMPED (UINT32_C(1) << 8)   // the gate held the force at its largest
#define PALPATE_FORCE_SLEWED (UINT32_C(1) << 9)    // the gate held back its change
#define PALPATE_TORQUE_CLAMPED (UINT32_C(1) << 10)
#define PALPATE_TORQUE_SLEWED (UINT32_C(1) << 11)
#define PALPATE_ENERGY_DAMPED (UINT32_C(1) << 12)  // the passivity controller acted
#define PALPATE_DUTY_HIGH (UINT32_C(1) << 13)  // RMS force over 10 s above what the device gives without end
#define PALPATE_DUTY_LIMITED (UINT32_C(1) << 14)  // the force was lowered: that over 60 s, or warm motors

// ---- The library

/// [any] PALPATE_ABI_VERSION of the library that was found at run time. A program compares it with its own.
PALPATE_API uint32_t palpate_abi_version(void);

/// [any] "0.2.0". Lives for ever.
PALPATE_API const char* palpate_version(void);

/// [any] What was wrong with the calling thread's last call that did not return PALPATE_OK; "" before. Lives
/// until that thread's next such call. A call that goes well leaves it.
PALPATE_API const char* palpate_last_error(void);

/// [any] A fault for people: "the device could not be read, or refused a command". Lives for ever.
PALPATE_API const char* palpate_fault_words(uint32_t fault);

// ---- A simulation: one organ, its instruments, one a hand

typedef struct palpate_simulation palpate_simulation;

typedef struct palpate_options {
  size_t struct_size;
  // The scene, at most one of the two; neither: the gallbladder press (task "pull": the heart).
  const char* scene_file;    // TOML (docs/file-formats.md)
  const char* scene_text;    // the same as a text
  const char* scene_folder;  // that relative paths in scene_text start from; null: the working folder
  const char* task;          // "press" or "pull", over the scene's; null: the scene's
  const char* record_file;   // every tick goes to this HDF5 file; null: none
  // 0: a recording that cannot keep up loses rows, and palpate_close() says so. 1: palpate_tick() waits for
  // the disk instead, and is not [rt].
  int32_t record_waits;
  // 0: a hand holds the devices. The force then waits until the hand has been still outside the tissue and
  // rises by a ramp, and the passivity controller acts. 1: nobody does, samples come from a path or a
  // recording, and all force is there at once. Never 1 with a device that can push. A device that the scene
  // says is held (emulated, haply ...) stays so.
  int32_t no_hand;
  int32_t no_cache;     // 1: the prepared organ is neither taken from the user's cache nor put there
  int32_t reserved;     // 0
  double surface_edge;  // m: the visible surface is divided until no edge is longer; 0: as the organ's mesh
  // Told now and then how far palpate_open() is, 0..1, on the calling thread; may be null.
  void (*progress)(double share, const char* what, void* user);
  void* progress_user;
} palpate_options;

/// [setup] Reads and checks the scene and all it names, and prepares the organ: some seconds for a fine organ
/// the first time. On success *simulation is to be closed by palpate_close(), else it is null.
PALPATE_API palpate_status palpate_open(const palpate_options* options, palpate_simulation** simulation);

/// [setup] Ends the recording, if there is one, and frees all. Null is allowed. When the recording failed or
/// rows are missing from it the return says so; all is freed nevertheless.
PALPATE_API palpate_status palpate_close(palpate_simulation* simulation);

typedef struct palpate_info {
  size_t struct_size;
  uint32_t hands;           // 1 .. PALPATE_MAX_HANDS
  uint32_t held;            // a bit a hand: a hand holds its device
  double rate;              // Hz, ticks a second: the program has to tick at it
  double max_force;         // N, no larger one is ever given
  double max_torque;        // N m
  uint64_t seed;            // of the touch noise
  uint64_t scripted_ticks;  // until palpate_scripted_sample() has nothing more to say
  size_t vertices;          // of the visible surface
  size_t triangles;
  size_t remarks;                          // for palpate_remark()
  uint32_t tool_parts[PALPATE_MAX_HANDS];  // rigid parts of each hand's instrument
} palpate_info;

/// [any] What was loaded.
PALPATE_API palpate_status palpate_get_info(const palpate_simulation* simulation, palpate_info* info);

/// [any] The scene's name. Lives as long as the simulation.
PALPATE_API const char* palpate_name(const palpate_simulation* simulation);

/// [any] What a user should be told of the scene (repairs to meshes, warnings); one line each, null past the
/// last. Lives as long as the simulation.
PALPATE_API const char* palpate_remark(const palpate_simulation* simulation, size_t index);

/// One reading of one device, taken at one moment, in the device's own frame (the scene's [device] maps it
/// into the world: base and workspace_scale).
typedef struct palpate_sample {
  size_t struct_size;
  double position[3];     // m
  double orientation[4];  // w x y z, unit
  double velocity[3];     // m/s
  double gripper;         // 0 closed .. 1 open
  double age;             // s since the device took the sample; over 5 ms is a fault
  uint32_t buttons;       // a bit a button
  uint32_t fault;         // PALPATE_FAULT_...; a sample with a fault needs no pose
} palpate_sample;

/// What one hand gets at one tick, and why.
typedef struct palpate_result {
  size_t struct_size;
  uint64_t tick;
  double time;  // s, tick / rate
  // After the gate, in the device's own frame: what the program writes to the device, as it is.
  double device_force[3];   // N, on the hand
  double device_torque[3];  // N m, about the handle's origin
  double gripper_force;     // N
  // The same in the world, and what contact found there.
  double force[3];      // N
  double torque[3];     // N m
  double tissue_force;  // N, norm before the gate
  double noise_force;   // N, signed along the normal
  double friction;      // N
  double distance;      // m, tool to organ, negative inside
  double depth;         // m, of the contact with the largest force
  double contact[3];    // m, on the rest surface; without contact the nearest point
  double normal[3];
  double tool_position[3];     // m, of the handle
  double tool_orientation[4];  // w x y z
  double gripper;
  // J that hand and organ's own motion have put into the tissue's force so far and not got back
  double energy;
  double engagement;      // share of force and noise that is let through, 0 .. 1
  uint32_t phase;         // PALPATE_APPROACH, PALPATE_PRESS or PALPATE_PULL
  uint32_t cutoff_layer;  // of the layered law; 0 without contact
  uint32_t saturated;     // 1: past the last layer, the force holds
  uint32_t status;        // bits, PALPATE_STARTED_INSIDE ...
  uint32_t fault;         // PALPATE_FAULT_... that is latched
  uint32_t reserved;
} palpate_result;

/// [rt] The next haptic tick: one sample of every hand in, one result of every hand out; `hands` is
/// palpate_info.hands. Ticks count from 0; the same samples give the same results bit for bit. It reads no
/// clock: the program keeps palpate_info.rate. It has no watchdog either: when the program's loop stood still
/// for 20 ms or more, the program has to take the force from the device itself, and to give the next sample
/// with PALPATE_FAULT_STALLED_LOOP. A bad sample is no error but a fault of its hand. On an error no tick was
/// made.
PALPATE_API palpate_status palpate_tick(palpate_simulation* simulation, const palpate_sample* samples,
                                        palpate_result* results, size_t hands);

/// [any] Clears the latched faults of the hands in `hand_bits` (bit 0 the first) at the next tick. Held hands
/// get force again after they have been still outside the tissue.
PALPATE_API palpate_status palpate_reset_fault(palpate_simulation* simulation, uint32_t hand_bits);

/// [setup] Back to before tick 0. Refused while recording: close it and open it again.
PALPATE_API palpate_status palpate_restart(palpate_simulation* simulation);

/// [rt] What a scripted device would give at a tick: the scene's own path or recording, else from above the
/// organ's middle to 12 mm of depth or pull, and back. For first steps and tests without a device. Held hands
/// wait a second before they go, so that they are let through to the force.
PALPATE_API palpate_status palpate_scripted_sample(palpate_simulation* simulation, uint32_t hand,
                                                   uint64_t tick, palpate_sample* sample);

// ---- The picture

/// Where all things were at the tick that the surface belongs to. World frame.
typedef struct palpate_picture {
  size_t struct_size;
  uint64_t tick;
  double organ_position[3];                       // m
  double organ_orientation[4];                    // w x y z
  double tool_position[PALPATE_MAX_HANDS][3];     // m, of the handle
  double tool_orientation[PALPATE_MAX_HANDS][4];  // w x y z
  double gripper[PALPATE_MAX_HANDS];              // 0 closed .. 1 open
} palpate_picture;

/// [picture] Takes the newest tick and moves the visible surface by it (before the first tick: at rest).
/// Allocates. Contact is always solved against the rest surface: this is for the eye.
PALPATE_API palpate_status palpate_surface_update(palpate_simulation* simulation, palpate_picture* picture);

/// [picture] The surface's vertices as of palpate_surface_update(), x y z in turn [m], in the organ's frame
/// (place them by palpate_picture's organ pose). @param capacity vertices that fit, >= palpate_info.vertices
PALPATE_API palpate_status palpate_surface_vertices(const palpate_simulation* simulation, double* xyz,
                                                    size_t capacity);

/// [any] Its triangles: three vertex indices each, counter-clockwise from outside. They never change.
/// @param capacity triangles that fit, >= palpate_info.triangles
PALPATE_API palpate_status palpate_surface_triangles(const palpate_simulation* simulation, int32_t* corners,
                                                     size_t capacity);

// ---- The instruments, for whoever draws them: rigid parts, which do not change

typedef struct palpate_part {
  size_t struct_size;
  const char* name;  // "left"; lives as long as the simulation
  size_t vertices;
  size_t triangles;
  int32_t is_jaw;  // 1: it turns with the gripper
  int32_t reserved;
} palpate_part;

/// [any] What one part of a hand's instrument is. @param part less than palpate_info.tool_parts[hand]
PALPATE_API palpate_status palpate_tool_part(const palpate_simulation* simulation, uint32_t hand,
                                             uint32_t part, palpate_part* info);

/// [any] Its vertices, x y z in turn [m], in the handle's frame with the jaws closed.
/// @param capacity vertices that fit, >= palpate_part.vertices
PALPATE_API palpate_status palpate_part_vertices(const palpate_simulation* simulation, uint32_t hand,
                                                 uint32_t part, double* xyz, size_t capacity);

/// [any] Its triangles, as palpate_surface_triangles(). The mesh may be open.
PALPATE_API palpate_status palpate_part_triangles(const palpate_simulation* simulation, uint32_t hand,
                                                  uint32_t part, int32_t* corners, size_t capacity);

/// [any] Where the part stands in the handle's frame when the gripper is that far open (0 closed .. 1 open):
/// position [m] and orientation, w x y z. In the world: palpate_picture's tool pose times this.
PALPATE_API palpate_status palpate_part_pose(const palpate_simulation* simulation, uint32_t hand,
                                             uint32_t part, double gripper, double position[3],
                                             double orientation[4]);

// ---- The law alone

typedef struct palpate_law palpate_law;

typedef struct palpate_response {
  size_t struct_size;
  double depth;          // m, what the layers give way by
  double force;          // N, what they carry; less than asked for when saturated
  double stiffness;      // N/m, dF/dD; of the layer below at a joint
  int32_t cutoff_layer;  // 1-based
  int32_t saturated;     // 1: past the last layer
} palpate_response;

/// [setup] The law of a tissue, layered or smooth as the tissue says. @param tissue a built-in name or a
/// tissue file @param direction "press" or "pull" @param rate Hz, which decides how many layers move On
/// success *law is to be closed by palpate_law_close(), else it is null.
PALPATE_API palpate_status palpate_law_open(const char* tissue, const char* direction, double rate,
                                            palpate_law** law);

/// [setup] Null is allowed.
PALPATE_API void palpate_law_close(palpate_law* law);

/// [rt] Force and stiffness at a depth [m]; from any number of threads at once. A depth that is negative or
/// not finite is refused.
PALPATE_API palpate_status palpate_law_force_at(const palpate_law* law, double depth,
                                                palpate_response* response);

/// [rt] The inverse: depth and stiffness under a force [N], in the same way.
PALPATE_API palpate_status palpate_law_depth_under(const palpate_law* law, double force,
                                                   palpate_response* response);

// ---- The touch noise alone

/// [rt] Sample number `tick` of a hand's steady noise [N], signed: standard deviation gain / (distance +
/// threshold), gain / threshold at distance 0; bounded at six of those. The same numbers give the same
/// sample.
/// @param gain N m @param threshold m, > 0 @param distance m, >= 0
PALPATE_API palpate_status palpate_noise_sample(double gain, double threshold, uint64_t seed, uint32_t hand,
                                                uint64_t tick, double distance, double* force);

#ifdef __cplusplus
}
#endif

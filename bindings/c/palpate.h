#pragma once
// Palpate's C interface (C99), in one shared library, libpalpate.so. Your program opens a scene with an organ
// and instruments. It calls one function per haptic tick, at its own rate, with samples of its own devices,
// and receives the forces for the devices. It can read the deformed surface for display.
//
// Units are SI (m, N, N m, s). Quaternions are w x y z. The world frame is right-handed with z up. All
// functions return a palpate_status, except those that return a pointer or a number. A null pointer or a
// wrong struct_size gives PALPATE_ERROR_USE. After an error, palpate_last_error() returns one line with the
// field, its value and the accepted values. No function throws, prints or installs a signal handler. The
// caller owns all memory, except objects from palpate_open() and palpate_law_open() and the returned texts,
// whose lifetimes are stated below.
//
// Threads. [setup]: may allocate, read files and take seconds; no other thread may use the same object
// meanwhile. [rt]: never allocates, locks or calls the system, for the thread of the haptic loop; one thread
// at a time per simulation. [picture]: for one further thread, which may run beside [rt]. [any]: from any
// thread at any time. Different simulations are independent.
//
// Every struct that the caller passes begins with its size. Set the struct to zero, then struct_size to
// sizeof the struct. Later versions add fields at the end only: a program compiled with an older header
// passes shorter structs, and the fields that they lack have their defaults. A larger struct than the
// library's gives PALPATE_ERROR_USE.
#include <stddef.h>
#include <stdint.h>

/// Version of the binary interface. It changes when programs must be recompiled, and is part of the library's
/// SONAME (libpalpate.so.0).
#define PALPATE_ABI_VERSION 0

#if defined(_WIN32) && defined(PALPATE_BUILDS_DLL)
#define PALPATE_API __declspec(dllexport)
#elif defined(_WIN32)
#define PALPATE_API __declspec(dllimport)
#elif defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// Result of a call.
typedef int32_t palpate_status;
#define PALPATE_OK 0
#define PALPATE_ERROR_USE 1    // invalid call: a null pointer, a wrong size, a wrong order
#define PALPATE_ERROR_INPUT 2  // invalid scene, file or number
#define PALPATE_ERROR_OTHER 3  // no memory, or another failure of the system

#define PALPATE_MAX_HANDS 4

/// Values of palpate_result.phase.
#define PALPATE_APPROACH 0
#define PALPATE_PRESS 1
#define PALPATE_PULL 2
#define PALPATE_INSERT 3  // a needle in the tissue

/// Cause of a hand's zero force (palpate_result.fault). A fault latches until palpate_reset_fault(). In
/// palpate_sample.fault the program reports faults of its device with the same values.
#define PALPATE_FAULT_NONE 0
#define PALPATE_FAULT_NOT_FINITE 1    // a sample or a force was not finite
#define PALPATE_FAULT_DEVICE 2        // the device could not be read, or refused a command
#define PALPATE_FAULT_STALE_SAMPLE 3  // the sample was older than 5 ms
#define PALPATE_FAULT_STALLED_LOOP 4  // the program's loop stalled
#define PALPATE_FAULT_FORCE_OFF 5     // the device switched its force off
#define PALPATE_FAULT_UNSTABLE 6      // the passivity controller could not keep the energy bound

/// Bits of palpate_result.status.
#define PALPATE_STARTED_INSIDE (UINT32_C(1) << 0)  // no force until the tool has been outside the organ
#define PALPATE_CONTACTS_FULL (UINT32_C(1) << 1)   // a part of the tool has more than four contacts
#define PALPATE_GRIP_RELEASED (UINT32_C(1) << 2)   // the force exceeded the grip limit, the grasp let go
#define PALPATE_JUMP (UINT32_C(1) << 3)            // the tool moved faster than any hand: contacts reset
#define PALPATE_EXTRAPOLATED (UINT32_C(1) << 4)    // deeper than the tissue's source.max_depth_mm
#define PALPATE_AT_HUB (UINT32_C(1) << 5)          // a needle is in up to its hub, which pushes
#define PALPATE_FORCE_CLAMPED (UINT32_C(1) << 8)   // limited to palpate_info.max_force
#define PALPATE_FORCE_SLEWED (UINT32_C(1) << 9)    // its change per tick was limited
#define PALPATE_TORQUE_CLAMPED (UINT32_C(1) << 10)
#define PALPATE_TORQUE_SLEWED (UINT32_C(1) << 11)
#define PALPATE_ENERGY_DAMPED (UINT32_C(1) << 12)  // the passivity controller acted
#define PALPATE_DUTY_HIGH (UINT32_C(1) << 13)     // RMS force over 10 s exceeds the device's continuous force
#define PALPATE_DUTY_LIMITED (UINT32_C(1) << 14)  // force lowered: RMS over 60 s too high, or warm motors

// ---- The library

/// [any] PALPATE_ABI_VERSION of the loaded library. Compare it with the header's.
PALPATE_API uint32_t palpate_abi_version(void);

/// [any] The library's version, for example "0.2.0". Valid forever.
PALPATE_API const char* palpate_version(void);

/// [any] The message of the calling thread's last call that did not return PALPATE_OK; "" before any.
/// Valid until the thread's next failing call. A successful call does not change it.
PALPATE_API const char* palpate_last_error(void);

/// [any] The description of a fault: "the device could not be read, or refused a command". Valid forever.
PALPATE_API const char* palpate_fault_words(uint32_t fault);

// ---- A simulation: one organ, one instrument per hand

typedef struct palpate_simulation palpate_simulation;

typedef struct palpate_options {
  size_t struct_size;
  // At most one of scene_file and scene_text. Without both: the built-in gallbladder press (task "pull": the
  // heart).
  const char* scene_file;    // TOML (docs/file-formats.md)
  const char* scene_text;    // TOML text
  const char* scene_folder;  // folder of relative paths in scene_text; null: the working folder
  const char* task;          // "press", "pull", "palpate" or "insert"; null: the scene's task
  const char* record_file;   // file for every tick, CSV if it ends in .csv, else HDF5; null: no recording
  // 0: a recording that is too slow loses rows, which palpate_close() reports. 1: palpate_tick() waits for
  // the disk and is not [rt].
  int32_t record_waits;
  // 0: a hand holds the device. The force starts by a ramp after the hand was still outside the tissue, and
  // the passivity controller acts. 1: no hand, samples come from a path or a recording, and the full force
  // applies at once. Use 1 only if no device can push. Device kinds that a hand always holds (emulated, haply
  // ...) ignore it.
  int32_t no_hand;
  int32_t no_cache;     // 1: the user's cache of prepared organs is neither read nor written
  int32_t reserved;     // 0
  double surface_edge;  // m, longest edge of the visible surface, 1e-4 to 1; 0: edges of the organ's mesh
  // Reports the progress of palpate_open(), 0 to 1, on the calling thread; may be null.
  void (*progress)(double share, const char* what, void* user);
  void* progress_user;
} palpate_options;

/// [setup] Reads and checks the scene and its files, and prepares the organ. A fine organ takes some seconds
/// the first time. On success, close *simulation by palpate_close(); on error it is null.
/// @return PALPATE_ERROR_USE if two scenes are given; PALPATE_ERROR_INPUT for an invalid scene, file or
/// option, or a recording that cannot be created
PALPATE_API palpate_status palpate_open(const palpate_options* options, palpate_simulation** simulation);

/// [setup] Closes the recording, if any, and frees everything. Null is allowed.
/// @return PALPATE_ERROR_INPUT if the recording failed or rows are missing; everything is freed even so
PALPATE_API palpate_status palpate_close(palpate_simulation* simulation);

typedef struct palpate_info {
  size_t struct_size;
  uint32_t hands;           // 1 .. PALPATE_MAX_HANDS
  uint32_t held;            // bit per hand: a hand holds its device
  double rate;              // Hz, ticks per second that the program must keep
  double max_force;         // N, largest force of a result
  double max_torque;        // N m
  uint64_t seed;            // of the touch noise
  uint64_t scripted_ticks;  // number of ticks with a scripted motion
  size_t vertices;          // of the visible surface
  size_t triangles;
  size_t remarks;                          // number of remarks for palpate_remark()
  uint32_t tool_parts[PALPATE_MAX_HANDS];  // number of rigid parts of each hand's instrument
} palpate_info;

/// [any] Describes the loaded scene.
PALPATE_API palpate_status palpate_get_info(const palpate_simulation* simulation, palpate_info* info);

/// [any] The scene's name. Valid as long as the simulation.
PALPATE_API const char* palpate_name(const palpate_simulation* simulation);

/// [any] A remark on the scene for the user (mesh repair or warning), one line; null past the last. Valid as
/// long as the simulation.
PALPATE_API const char* palpate_remark(const palpate_simulation* simulation, size_t index);

/// One sample of one device, in the device frame. The scene's [device] maps it to the world frame (base and
/// workspace_scale).
typedef struct palpate_sample {
  size_t struct_size;
  double position[3];     // m
  double orientation[4];  // w x y z, unit
  double velocity[3];     // m/s
  double gripper;         // 0 closed .. 1 open
  double age;             // s since the device took the sample; over 5 ms is a fault
  uint32_t buttons;       // bit per button
  uint32_t fault;         // PALPATE_FAULT_...; a sample with a fault needs no pose
} palpate_sample;

/// Result of one hand at one tick.
typedef struct palpate_result {
  size_t struct_size;
  uint64_t tick;
  double time;  // s, tick / rate
  // Output of the gate in the device frame. Write it to the device unchanged.
  double device_force[3];   // N, on the hand
  double device_torque[3];  // N m, about the handle's origin
  double gripper_force;     // N
  // Force and contact in the world frame:
  double force[3];      // N
  double torque[3];     // N m
  double tissue_force;  // N, norm before the gate
  double noise_force;   // N, signed along the normal
  double friction;      // N
  double distance;      // m, tool to organ, negative inside
  double depth;         // m, penetration depth of the contact with the largest force
  double contact[3];    // m, on the rest surface; without contact the nearest point
  double normal[3];
  double tool_position[3];     // m, of the handle
  double tool_orientation[4];  // w x y z
  double gripper;
  // J, work of the hand and of the organ motion on the tissue force that was not returned; outside the tissue
  // a surplus is reset to 0
  double energy;
  double engagement;      // gain of force and noise (force ramp), 0 .. 1
  uint32_t phase;         // PALPATE_APPROACH, PALPATE_PRESS, PALPATE_PULL or PALPATE_INSERT
  uint32_t cutoff_layer;  // layer of the layered law; 0 without contact
  uint32_t saturated;     // 1: past the last layer, the force stays constant
  uint32_t status;        // bits, PALPATE_STARTED_INSIDE ...
  uint32_t fault;         // latched PALPATE_FAULT_...
  uint32_t layer;         // of the tissue at a needle's tip, from 1; 0: in none
} palpate_result;

/// [rt] Computes the next haptic tick from one sample per hand, and writes one result per hand. Ticks count
/// from 0. The same samples give the same results bit for bit. It reads no clock: the program must call it at
/// palpate_info.rate. It has no watchdog: if the program's loop stalled for 20 ms or more, the program must
/// set the device's force to zero itself and pass the next sample with PALPATE_FAULT_STALLED_LOOP. A bad
/// sample is not an error; it latches a fault of its hand.
/// @param hands palpate_info.hands
/// @return PALPATE_ERROR_USE for a wrong call; then no tick was computed
PALPATE_API palpate_status palpate_tick(palpate_simulation* simulation, const palpate_sample* samples,
                                        palpate_result* results, size_t hands);

/// [any] Clears the latched faults of some hands at the next tick. The force of a held hand starts again by a
/// ramp, after the hand was still outside the tissue.
/// @param hand_bits bit 0 is the first hand
PALPATE_API palpate_status palpate_reset_fault(palpate_simulation* simulation, uint32_t hand_bits);

/// [setup] Resets the simulation to the state before tick 0. @return PALPATE_ERROR_USE while recording; then
/// close and open the simulation instead
PALPATE_API palpate_status palpate_restart(palpate_simulation* simulation);

/// [rt] Sample of a scripted device at a tick, for first steps and tests without a device. It follows the
/// scene's path or recording. Without one, the tool moves from above the middle of the organ to 12 mm of
/// depth or pull, and back. A held hand waits one second first, until its force has started.
/// @return PALPATE_ERROR_USE for an invalid hand
PALPATE_API palpate_status palpate_scripted_sample(palpate_simulation* simulation, uint32_t hand,
                                                   uint64_t tick, palpate_sample* sample);

// ---- Live changes of the tissue and the touch noise
//
// A recording contains each change. The next tick applies a change, or a later one while other changes wait,
// because a tick applies one. The functions that set allocate and may wait for another caller, so do not call
// them from the thread of the haptic loop. After an error nothing has changed. palpate_restart() restores the
// scene's parameters.

/// [any] Replaces the tissue: force law, relaxation, displacement profile, friction, damping and grip limit.
/// Reads the file if `tissue` is one.
/// @param tissue name of a built-in tissue or a tissue file
/// @return PALPATE_ERROR_INPUT for an unknown tissue, an invalid file, another reference radius than the
/// scene's, or when 32 changes wait
PALPATE_API palpate_status palpate_set_tissue(palpate_simulation* simulation, const char* tissue);

/// [any] Name of a number of the tissue, as in tissue files (docs/file-formats.md): "k1_N_per_m",
/// "contact.friction"; null past the last. Valid forever.
PALPATE_API const char* palpate_tissue_field(size_t index);

/// [any] Changes one number of the tissue and keeps the others.
/// @param field a name of palpate_tissue_field()
/// @param value in the unit at the end of the name ("rest_length_mm": mm), not in SI
/// @return PALPATE_ERROR_INPUT for an unknown name, a value out of range, or when 32 changes wait
PALPATE_API palpate_status palpate_set_tissue_value(palpate_simulation* simulation, const char* field,
                                                    double value);

/// [any] One number of the tissue as the scene or the last change gives it, in the unit of its name. May wait
/// for another caller. @return PALPATE_ERROR_INPUT for an unknown name
PALPATE_API palpate_status palpate_get_tissue_value(const palpate_simulation* simulation, const char* field,
                                                    double* value);

/// [any] Switches the touch noise on or off and sets its strength. The crossfade takes 50 ms.
/// @param enabled 0: off
/// @param gain N m, >= 0
/// @param threshold m, > 0
/// @return PALPATE_ERROR_INPUT for an invalid gain or threshold, or when 32 changes wait
PALPATE_API palpate_status palpate_set_noise(palpate_simulation* simulation, int32_t enabled, double gain,
                                             double threshold);

/// [any] The touch noise as the scene or the last change gives it. May wait for another caller.
PALPATE_API palpate_status palpate_get_noise(const palpate_simulation* simulation, int32_t* enabled,
                                             double* gain, double* threshold);

// ---- Inclusions: spheres in the organ of another stiffness (docs/lumps.md)

typedef struct palpate_inclusion {
  size_t struct_size;
  double position[3];      // m, of the centre, in the organ frame
  double radius;           // m
  double stiffness_ratio;  // Young's modulus divided by that of the tissue, 0.1 to 100
  const char* name;        // valid as long as the simulation
  int32_t visible;         // 0: hidden, for a search; do not draw it
  int32_t reserved;
} palpate_inclusion;

/// [any] Number of inclusions of the scene, visible and hidden; 0 for a null simulation.
PALPATE_API size_t palpate_inclusion_count(const palpate_simulation* simulation);

/// [any] The inclusion as the scene or the last palpate_set_inclusion() gives it. May wait for another thread
/// in palpate_set_inclusion(). @param index less than palpate_inclusion_count()
/// @return PALPATE_ERROR_USE for an inclusion that does not exist
PALPATE_API palpate_status palpate_get_inclusion(const palpate_simulation* simulation, size_t index,
                                                 palpate_inclusion* inclusion);

/// [any] Moves an inclusion and sets its stiffness ratio; a recording contains the change. The next tick
/// applies the change, or a later one while other changes wait. Allocates and may wait for another caller, so
/// do not call it from the thread of the haptic loop.
/// @param inclusion position and stiffness_ratio; the other fields are not used
/// @return PALPATE_ERROR_USE for an inclusion that does not exist; PALPATE_ERROR_INPUT for a ratio out of
/// range, a position that is not inside the organ by the radius, or when 32 changes wait
PALPATE_API palpate_status palpate_set_inclusion(palpate_simulation* simulation, size_t index,
                                                 const palpate_inclusion* inclusion);

// ---- The picture

/// Poses at the tick of the surface, in the world frame.
typedef struct palpate_picture {
  size_t struct_size;
  uint64_t tick;
  double organ_position[3];                       // m
  double organ_orientation[4];                    // w x y z
  double tool_position[PALPATE_MAX_HANDS][3];     // m, of the handle
  double tool_orientation[PALPATE_MAX_HANDS][4];  // w x y z
  double gripper[PALPATE_MAX_HANDS];              // 0 closed .. 1 open
} palpate_picture;

/// [picture] Deforms the visible surface as at the newest tick (at rest before the first tick). Allocates.
/// The surface is only for display: contact is always computed on the rest surface.
/// @return PALPATE_ERROR_OTHER without memory
PALPATE_API palpate_status palpate_surface_update(palpate_simulation* simulation, palpate_picture* picture);

/// [picture] Vertices of the surface of the last palpate_surface_update(), x y z in turn [m], in the organ
/// frame. The organ's pose is in palpate_picture.
/// @param capacity vertices that fit in xyz, >= palpate_info.vertices
/// @return PALPATE_ERROR_USE if the capacity is too small
PALPATE_API palpate_status palpate_surface_vertices(const palpate_simulation* simulation, double* xyz,
                                                    size_t capacity);

/// [any] Triangles of the surface: three vertex indices each, counter-clockwise from outside. They never
/// change.
/// @param capacity triangles that fit in corners, >= palpate_info.triangles
/// @return PALPATE_ERROR_USE if the capacity is too small
PALPATE_API palpate_status palpate_surface_triangles(const palpate_simulation* simulation, int32_t* corners,
                                                     size_t capacity);

// ---- The instruments, for display: rigid parts with constant meshes

typedef struct palpate_part {
  size_t struct_size;
  const char* name;  // "left"; valid as long as the simulation
  size_t vertices;
  size_t triangles;
  int32_t is_jaw;  // 1: it rotates with the gripper
  int32_t reserved;
} palpate_part;

/// [any] Describes one part of a hand's instrument. @param part less than palpate_info.tool_parts[hand]
/// @return PALPATE_ERROR_USE for a hand or part that does not exist
PALPATE_API palpate_status palpate_tool_part(const palpate_simulation* simulation, uint32_t hand,
                                             uint32_t part, palpate_part* info);

/// [any] Vertices of a part, x y z in turn [m], in the handle frame with closed jaws.
/// @param capacity vertices that fit in xyz, >= palpate_part.vertices
/// @return PALPATE_ERROR_USE for an invalid part or if the capacity is too small
PALPATE_API palpate_status palpate_part_vertices(const palpate_simulation* simulation, uint32_t hand,
                                                 uint32_t part, double* xyz, size_t capacity);

/// [any] Triangles of a part: three vertex indices each, counter-clockwise from outside. The mesh may be
/// open.
/// @param capacity triangles that fit in corners, >= palpate_part.triangles
/// @return PALPATE_ERROR_USE for an invalid part or if the capacity is too small
PALPATE_API palpate_status palpate_part_triangles(const palpate_simulation* simulation, uint32_t hand,
                                                  uint32_t part, int32_t* corners, size_t capacity);

/// [any] Pose of a part in the handle frame: position [m] and orientation w x y z. Its pose in the world
/// frame is the tool pose of palpate_picture times this pose.
/// @param gripper 0 closed .. 1 open
/// @return PALPATE_ERROR_USE for an invalid part, PALPATE_ERROR_INPUT for an invalid gripper
PALPATE_API palpate_status palpate_part_pose(const palpate_simulation* simulation, uint32_t hand,
                                             uint32_t part, double gripper, double position[3],
                                             double orientation[4]);

// ---- The force law alone

typedef struct palpate_law palpate_law;

typedef struct palpate_response {
  size_t struct_size;
  double depth;          // m, sum of the layers' deformations
  double force;          // N, carried by the layers; less than the given force when saturated
  double stiffness;      // N/m, dF/dD; at the end of a layer that of this layer
  int32_t cutoff_layer;  // cut-off layer, 1-based
  int32_t saturated;     // 1: beyond the last layer
} palpate_response;

/// [setup] Force law of a tissue; the tissue selects the layered or the smooth law. On success, close *law by
/// palpate_law_close(); on error it is null.
/// @param tissue name of a built-in tissue or a tissue file
/// @param direction "press" or "pull"
/// @param rate Hz, loop rate; it limits the number of layers
/// @return PALPATE_ERROR_INPUT for an unknown tissue, direction or invalid rate
PALPATE_API palpate_status palpate_law_open(const char* tissue, const char* direction, double rate,
                                            palpate_law** law);

/// [setup] Frees a law. Null is allowed.
PALPATE_API void palpate_law_close(palpate_law* law);

/// [rt] Force and stiffness at a depth [m]. Several threads may use one law at a time.
/// @return PALPATE_ERROR_INPUT for a depth that is negative or not finite
PALPATE_API palpate_status palpate_law_force_at(const palpate_law* law, double depth,
                                                palpate_response* response);

/// [rt] Depth and stiffness under a force [N], the inverse of palpate_law_force_at(). Several threads may use
/// one law at a time. @return PALPATE_ERROR_INPUT for a force that is negative or not finite
PALPATE_API palpate_status palpate_law_depth_under(const palpate_law* law, double force,
                                                   palpate_response* response);

// ---- The touch noise alone

/// [rt] Sample number `tick` of a hand's touch noise [N], signed, in the steady state. The standard deviation
/// is gain / (distance + threshold); samples are bounded at six standard deviations. Equal arguments give the
/// same sample.
/// @param gain N m
/// @param threshold m, > 0
/// @param distance m, >= 0; 0 in contact
/// @return PALPATE_ERROR_INPUT for an invalid gain, threshold or distance
PALPATE_API palpate_status palpate_noise_sample(double gain, double threshold, uint64_t seed, uint32_t hand,
                                                uint64_t tick, double distance, double* force);

#ifdef __cplusplus
}
#endif

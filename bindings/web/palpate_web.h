#pragma once
// What palpate.js calls besides palpate.h: reading structs, snapshots, hands that follow a pointer, and
// pictures by WebGL2. Conventions as in palpate.h. Vectors are x y z [m], in the world frame.
#include "bindings/c/palpate.h"

extern "C" {

/// The structs of palpate.h that palpate.js reads and writes, as JSON: {"palpate_sample": {"size": 96,
/// "fields": [["position", "f64", OFFSET, COUNT], ...]}, ...}. Valid forever.
const char* palpate_web_layout(void);

/// The built-in scenes as JSON: [{"name": "press", "title": "Press", "line": "...", "toml": "..."}, ...].
/// Valid forever.
const char* palpate_web_scenes(void);

/// The names of the built-in tissues as JSON. Valid forever.
const char* palpate_web_tissues(void);

/// As palpate_open(), with what the flags --organ, --organ-unit, --tissue, --device and --seed of `palpate
/// run` replace. Each may be null.
palpate_status palpate_web_open(const palpate_options* options, const char* organ, const char* organ_unit,
                                const char* tissue, const char* device, const char* seed,
                                palpate_simulation** simulation);
/// The loaded scene as JSON: {"task": "press", "organ": "gallbladder", "tissue": "gallbladder", "tools":
/// ["curved-forceps"], "jaws": true, "lumps": 0, "tolerance": 0.01}. Valid until the next call.
const char* palpate_web_describe(const palpate_simulation* simulation);

/// Number of bytes of a snapshot.
size_t palpate_web_snapshot_size(void);
/// Copies the state after the newest tick. @param capacity palpate_web_snapshot_size()
palpate_status palpate_web_snapshot(palpate_simulation* simulation, void* bytes, size_t capacity);

/// Writes all ticks so far to the recording's file.
palpate_status palpate_web_flush_recording(palpate_simulation* simulation);

/// A hand that follows a pointer (run/devices/target_follower.h), from the start of the scripted motion.
struct palpate_web_follower;
palpate_status palpate_web_follower_open(palpate_simulation* simulation, uint32_t hand,
                                         palpate_web_follower** follower);
void palpate_web_follower_close(palpate_web_follower* follower);
/// Position of the handle, unit direction of the tool and opening of the jaws at the start: 7 numbers.
void palpate_web_follower_start(const palpate_web_follower* follower, double start[7]);
/// One tick towards a target.
palpate_status palpate_web_follower_advance(palpate_web_follower* follower, const double target[3],
                                            double gripper, palpate_sample* sample);
/// Moves a target to the nearest point that the hand can reach.
void palpate_web_follower_reach(const palpate_web_follower* follower, double target[3]);

/// A hand under a pointer: a tool that rides on the organ (run/devices/surface_rider.h), followed by a hand
/// as above. The simulation outlives it.
struct palpate_web_rider;
palpate_status palpate_web_rider_open(palpate_simulation* simulation, uint32_t hand,
                                      palpate_web_rider** rider);
void palpate_web_rider_close(palpate_web_rider* rider);
/// The pointer's line of sight: origin and unit direction. @param ray null: the pointer is elsewhere, and the
/// tool stays
void palpate_web_rider_point_at(palpate_web_rider* rider, const double ray[6]);
/// Changes the set depth [m]; positive presses.
void palpate_web_rider_press(palpate_web_rider* rider, double deeper);
/// 1: lifts the tool off the organ; 0: brings it back.
void palpate_web_rider_park(palpate_web_rider* rider, int32_t parked);
/// Set depth under the surface [m]; negative: height above it.
double palpate_web_rider_depth(const palpate_web_rider* rider);
/// Moves on. @param seconds since the last call @param dragging 1: the jaws hold tissue @param pace factor of
/// the speed, 0 to 1
void palpate_web_rider_move(palpate_web_rider* rider, double seconds, int32_t dragging, double pace);
/// One tick of the hand towards the rider's target.
palpate_status palpate_web_rider_advance(palpate_web_rider* rider, double gripper, palpate_sample* sample);

/// Pictures of a simulation. At every call the canvas's WebGL2 context is current; the simulation outlives
/// the view.
struct palpate_web_view;
palpate_status palpate_web_view_open(palpate_simulation* simulation, int32_t width, int32_t height,
                                     palpate_web_view** view);
void palpate_web_view_close(palpate_web_view* view);
/// Draws a snapshot to the canvas, whose size is width x height pixels.
palpate_status palpate_web_view_draw(palpate_web_view* view, const void* bytes, size_t size, int32_t width,
                                     int32_t height);
/// Draws poses and contacts as numbers: position and orientation (w x y z) of the organ, then those of each
/// hand, its gripper and its number of contacts. Each contact has a point and direction (organ frame), depth,
/// tip radius, half-width, and 1 for a pull.
palpate_status palpate_web_view_draw_state(palpate_web_view* view, const double* numbers, size_t count,
                                           int32_t width, int32_t height);
/// Eye, target, up, vertical angle of view [deg]: 10 numbers.
void palpate_web_view_camera(const palpate_web_view* view, double camera[10]);
palpate_status palpate_web_view_set_camera(palpate_web_view* view, const double camera[10]);
void palpate_web_view_orbit(palpate_web_view* view, double right, double up);
void palpate_web_view_pan(palpate_web_view* view, double right, double up);
void palpate_web_view_zoom(palpate_web_view* view, double factor);
/// Frames the contact of the first hand in the last drawn state, or takes the view of the window's start.
palpate_status palpate_web_view_frame(palpate_web_view* view, int32_t close_up);
/// Moves back a little if a tool or a contact of the last drawn state is outside the picture. @return 1:
/// moved
int32_t palpate_web_view_keep_in_frame(palpate_web_view* view);
/// Marks over the picture (app/window/mark_shapes.h) as JSON: {"lines": [[x1, y1, x2, y2, width, colour],
/// ...], "triangles": [[x1, y1, x2, y2, x3, y3, colour], ...], "words": [[x, y, colour, "1.25 N"], ...]}.
/// Colours: 0 text, 1 force, 2 to 4 x to z, 5 plate, 6 steel, 7 to 14 layers. @param which 1 force, 2 scale,
/// 4 axes, 8 section along a needle, 16 its shaft inside @param letters size of
/// letters, in the unit of width and height. Valid until the next call.
const char* palpate_web_view_marks(palpate_web_view* view, double width, double height, double letters,
                                   uint32_t which);
/// Motion of a hand's tool across its axis for a motion by fractions of the picture's height.
palpate_status palpate_web_view_steer(const palpate_web_view* view, uint32_t hand, double right, double up,
                                      double way[3]);
/// Line of sight through a point of the picture (0 .. 1 from its upper left corner): origin and unit
/// direction, 6 numbers.
void palpate_web_view_ray(const palpate_web_view* view, double x, double y, double ray[6]);
/// The first point of the rest surface on that line, in the world frame and in the organ frame: 6 numbers.
/// @return 1: there is one; 0: none
int32_t palpate_web_view_pick(const palpate_web_view* view, double x, double y, double point[6]);
/// Colours by displacement up to `range` [m]; 0: natural colours.
palpate_status palpate_web_view_show_displacement(palpate_web_view* view, double range);
/// Shows or hides the surgical drape under the organ, initially hidden.
palpate_status palpate_web_view_show_drape(palpate_web_view* view, int32_t shown);
/// @param inclusions centre (organ frame), radius [m], stiffness ratio: 5 numbers each
palpate_status palpate_web_view_show_inclusions(palpate_web_view* view, const double* inclusions,
                                                size_t count);
/// @param marks point of the surface (organ frame) and render::SurfaceMark::Kind: 4 numbers each
palpate_status palpate_web_view_show_marks(palpate_web_view* view, const double* marks, size_t count);
/// @param quality 0 full, 1 balanced, 2 fast, -1 adapts to the time that pictures take
palpate_status palpate_web_view_set_quality(palpate_web_view* view, int32_t quality);
int32_t palpate_web_view_quality(const palpate_web_view* view);
/// Name of the graphics driver. Valid as long as the view.
const char* palpate_web_view_driver(const palpate_web_view* view);

/// Bytes of the heap in use.
size_t palpate_web_memory_in_use(void);
}

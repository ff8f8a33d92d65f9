#pragma once
// Test objects: the built-in organs and instruments with any number of triangles, and one path of the hand
// for all of them. The same bits on every machine.
#include <cstddef>
#include <string>

#include "core/haptics/simulation.h"
#include "palpate/mesh.h"
#include "palpate/scene.h"
#include "palpate/tool.h"
#include "palpate/tool_path.h"

#include "bench/measure/account.h"

namespace palpate::bench {

enum class Shape { kFlat, kCurved };

/// [setup] Divides each triangle into parts x parts. Flat: the surface is unchanged. Curved: new vertices lie
/// on curved triangles given by the vertex normals (Phong tessellation with shape factor 3/4 [Boubekeur and
/// Alexa 2008]), so that a finer mesh is rounder. A closed mesh stays closed. @throws std::invalid_argument
/// when parts < 1.
[[nodiscard]] geometry::TriangleMesh tessellate(const geometry::TriangleMesh& mesh, int parts, Shape shape);

/// [setup] Number of parts per edge for which a mesh of `triangles` triangles gets closest to `wanted`; at
/// least 1.
[[nodiscard]] int parts_for(std::size_t triangles, std::size_t wanted) noexcept;

/// [setup] The scene of a task (press: gallbladder, pull: heart), its organ with about `organ_triangles` and
/// its tool with about `tool_triangles` triangles; 0: as built in. @throws InputError as scene::load.
[[nodiscard]] scene::Scene bench_scene(const std::string& task, std::size_t organ_triangles,
                                       std::size_t tool_triangles);

/// [any] Number of triangles of all parts.
[[nodiscard]] std::size_t triangle_count(const geometry::Tool& tool) noexcept;

/// [setup] Path of hand 0: the scene's own (scene::default_path), with an approach from 10 mm higher and 20
/// mm aside and the same way back. The handle always oscillates by 0.5 mm and two thirds of a degree. Begins
/// and ends at the same pose. @throws InputError as scene::default_path.
[[nodiscard]] scene::ToolPath hand_path(const scene::Scene& scene);

/// [setup] Heap memory in use [bytes], over all threads.
[[nodiscard]] std::size_t bytes_in_use();

/// A prepared scene, and the cost of its preparation.
struct Prepared {
  haptics::SimulationWorld world;
  PreparationAccount account;
};

/// [setup] Prepares a scene: median time of up to five runs within a second, and the memory that one keeps.
/// @throws InputError as scene::make_world.
[[nodiscard]] Prepared prepare(const scene::Scene& scene);

}  // namespace palpate::bench

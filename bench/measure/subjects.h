#pragma once
#include <cstddef>
#include <string>

#include "palpate/mesh.h"
#include "palpate/scene.h"
#include "palpate/tool.h"
#include "palpate/tool_path.h"

// What is measured: the built-in organs and instruments with any number of triangles, and one way of the hand
// for all of them. The same bits on every machine.
namespace palpate::bench {

enum class Shape { kFlat, kCurved };

/// [setup] Every triangle into parts x parts. Flat: the surface stays where it is. Curved: the new vertices
/// lie on the curved triangles that the vertex normals span [Boubekeur and Alexa 2008, Phong tessellation,
/// 3/4], so that a finer mesh is a rounder one. Closed stays closed.
/// @throws std::invalid_argument when parts < 1.
[[nodiscard]] geometry::TriangleMesh tessellate(const geometry::TriangleMesh& mesh, int parts, Shape shape);

/// [setup] Into how many parts each edge of `triangles` triangles goes to come nearest to `wanted` in all; at
/// least 1.
[[nodiscard]] int parts_for(std::size_t triangles, std::size_t wanted) noexcept;

/// [setup] The scene of a task (press: gallbladder, pull: heart) with its organ at about `organ_triangles`
/// and its tool at about `tool_triangles`; 0: as built in. @throws InputError as scene::load.
[[nodiscard]] scene::Setup subject(const std::string& task, std::size_t organ_triangles,
                                   std::size_t tool_triangles);

/// [any] Triangles of all parts.
[[nodiscard]] std::size_t triangle_count(const geometry::Tool& tool) noexcept;

/// [setup] The way of hand 0: the scene's own (scene::default_path), reached from 10 mm higher and 20 mm
/// aside and left the same way, and never still: the handle sways by half a millimetre and two thirds of a
/// degree. Begins and ends at one pose. @throws InputError as scene::default_path.
[[nodiscard]] scene::ToolPath hand_path(const scene::Setup& setup);

}  // namespace palpate::bench

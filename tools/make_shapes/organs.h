#pragma once
#include <vector>

#include "palpate/mesh.h"

#include "tools/make_shapes/cut_vessel.h"

namespace palpate::geometry {

/// Resolution of a built-in mesh: the paper's counts, 30,000 or 75,000 triangles. The library divides each of
/// the 75,000 triangles into four (src/io/shapes/mesh_archive.h).
enum class Detail { kPaper, k30k, k75k };

/// [setup] A human gallbladder with fundus, body, Hartmann's pouch, curved neck and cystic duct, which has
/// its spiral fold and is cut off: 1,057 vertices and 2,110 triangles, or 30,000 or 75,000 triangles; closed,
/// metres. The long axis is x (fundus at -x), the broad side of the body faces +z.
[[nodiscard]] TriangleMesh make_gallbladder(Detail detail);

/// [setup] A human heart with its great vessels cut off: 3,208 vertices and 6,412 triangles, or 30,000 or
/// 75,000 triangles with all coronary vessels; closed, metres. Anterior view from +z with +y up: the front
/// wall of the ventricles faces +z, the apex points to +x and -y (the patient's left), the vessels leave
/// towards +y.
[[nodiscard]] TriangleMesh make_heart(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> heart_vessels();

/// [setup] A human right kidney with renal artery, renal vein and ureter cut off, and slight foetal lobes:
/// 3,002 vertices and 6,000 triangles, or 30,000 or 75,000 triangles; closed, metres. Anterior view from +z
/// with +y up: the upper pole points to +y, the hilum faces +x (the middle of the body). From front to back
/// the hilum has vein, artery and renal pelvis.
[[nodiscard]] TriangleMesh make_kidney(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> kidney_vessels();

/// [setup] A human liver with a sharp lower margin: 3,502 vertices and 7,000 triangles, or 30,000 or 75,000
/// triangles; closed, metres. The falciform ligament's stump and the notch of the round ligament separate the
/// right and left lobe. The caudate and quadrate lobes are below, around the porta hepatis. Portal vein,
/// hepatic artery and bile duct are cut off. The surface has the empty fossa of the gallbladder, the groove
/// and stump of the inferior vena cava, and the impressions of kidney, colon, stomach and heart. Anterior
/// view from +z with +y up: the left lobe's tip points to +x (the patient's left).
[[nodiscard]] TriangleMesh make_liver(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> liver_vessels();

}  // namespace palpate::geometry

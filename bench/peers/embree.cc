// Embree: one exact nearest-point query of the organ.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <embree3/rtcore.h>

#include "bench/peers/peer_list.h"

namespace palpate::bench::peers {
namespace {

using Point = std::array<float, 3>;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
float dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point along(const Point& a, const Point& d, float t) {
  return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}

/// Nearest point of a triangle by its seven regions (Ericson 2005, 5.1.5).
Point nearest_on(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point ab = minus(b, a);
  const Point ac = minus(c, a);
  const float d1 = dot(ab, minus(p, a));
  const float d2 = dot(ac, minus(p, a));
  if (d1 <= 0.0F && d2 <= 0.0F) return a;
  const float d3 = dot(ab, minus(p, b));
  const float d4 = dot(ac, minus(p, b));
  if (d3 >= 0.0F && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0F && d1 >= 0.0F && d3 <= 0.0F) return along(a, ab, d1 / (d1 - d3));
  const float d5 = dot(ab, minus(p, c));
  const float d6 = dot(ac, minus(p, c));
  if (d6 >= 0.0F && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0F && d2 >= 0.0F && d6 <= 0.0F) return along(a, ac, d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  const float to_c = d4 - d3;
  const float to_b = d5 - d6;
  if (va <= 0.0F && to_c >= 0.0F && to_b >= 0.0F) return along(b, minus(c, b), to_c / (to_c + to_b));
  const float sum = va + vb + vc;
  return along(along(a, ab, vb / sum), ac, vc / sum);
}

struct Organ {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  ~Organ() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

/// Called for candidate triangles; without a callback Embree finds nothing on triangles.
bool look_at(RTCPointQueryFunctionArguments* arguments) {
  const auto* organ = static_cast<const Organ*>(arguments->userPtr);
  const auto& corners = organ->triangles[arguments->primID];
  const Point p = {arguments->query->x, arguments->query->y, arguments->query->z};
  const Point to = minus(
      nearest_on(p, organ->vertices[corners[0]], organ->vertices[corners[1]], organ->vertices[corners[2]]),
      p);
  const float distance = std::sqrt(dot(to, to));
  if (!(distance < arguments->query->radius)) return false;
  arguments->query->radius = distance;
  return true;
}

template <typename Item>
void* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<Item>& items) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Item), items.size());
  if (buffer != nullptr) std::copy(items.begin(), items.end(), static_cast<Item*>(buffer));
  return buffer;
}

void* open_organ(const PalpatePeerMesh* mesh, const PalpatePeerMesh* /*parts*/, size_t /*part_count*/) {
  auto organ = std::make_unique<Organ>();
  for (size_t v = 0; v < mesh->vertex_count; ++v) {
    organ->vertices.push_back({static_cast<float>(mesh->vertices[3 * v]),
                               static_cast<float>(mesh->vertices[3 * v + 1]),
                               static_cast<float>(mesh->vertices[3 * v + 2])});
  }
  for (size_t t = 0; t < mesh->triangle_count; ++t) {
    organ->triangles.push_back({static_cast<std::uint32_t>(mesh->triangles[3 * t]),
                                static_cast<std::uint32_t>(mesh->triangles[3 * t + 1]),
                                static_cast<std::uint32_t>(mesh->triangles[3 * t + 2])});
  }
  organ->device = rtcNewDevice(nullptr);
  if (organ->device == nullptr) return nullptr;
  organ->scene = rtcNewScene(organ->device);
  rtcSetSceneBuildQuality(organ->scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(organ->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const bool filled =
      new_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, organ->vertices) != nullptr &&
      new_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, organ->triangles) != nullptr;
  if (filled) {
    rtcSetGeometryPointQueryFunction(geometry, look_at);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(organ->scene, geometry);
    rtcCommitScene(organ->scene);
  }
  rtcReleaseGeometry(geometry);
  return filled ? organ.release() : nullptr;
}

double ask(void* opened, const double* /*poses*/, const double* point) {
  auto* organ = static_cast<Organ*>(opened);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query{};
  query.x = static_cast<float>(point[0]);
  query.y = static_cast<float>(point[1]);
  query.z = static_cast<float>(point[2]);
  query.radius = std::numeric_limits<float>::infinity();
  rtcPointQuery(organ->scene, &query, &context, nullptr, organ);
  return static_cast<double>(query.radius);
}

void close_organ(void* opened) { delete static_cast<Organ*>(opened); }

}  // namespace

PalpatePeer embree() {
  return {"Embree", "one nearest point, unsigned, single precision", 1, 0, open_organ, ask, close_organ};
}

}  // namespace palpate::bench::peers

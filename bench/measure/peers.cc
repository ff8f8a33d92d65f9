#include "bench/measure/peers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <dlfcn.h>

#include "core/base/text.h"
#include "core/geometry/signed_distance.h"
#include "io/system/clock.h"
#include "io/system/plugin.h"

#include "bench/measure/bench_scene.h"

namespace palpate::bench {
namespace {

constexpr double kSameAnswer = 20e-6;  // m, difference allowed between single and double precision
constexpr std::size_t kTrial = 24;     // queries that estimate how many there is time for
constexpr std::size_t kTrialInOrder = 3;
constexpr std::size_t kChecks = 60;

/// A mesh in the form of the shared library.
struct PlainMesh {
  std::vector<double> vertices;
  std::vector<std::int32_t> triangles;

  explicit PlainMesh(const geometry::TriangleMesh& mesh) {
    for (const Vec3& v : mesh.vertices) vertices.insert(vertices.end(), {v.x(), v.y(), v.z()});
    for (const geometry::Triangle& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
  }
  [[nodiscard]] PalpatePeerMesh view() const {
    return {vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3};
  }
};

/// A peer with organ and tool loaded, and the poses in its terms.
class LoadedPeer final {
 public:
  LoadedPeer(const PalpatePeer& peer, const PeerComparison& question)
      : peer_(&peer), scene_(&question.scene), tips_(tip_points(question.scene, question.way)) {
    const PlainMesh organ(question.scene.organ);
    std::vector<PlainMesh> parts;
    for (const geometry::ToolPart& part : tool().parts) parts.emplace_back(part.mesh);
    std::vector<PalpatePeerMesh> views;
    for (const PlainMesh& part : parts) views.push_back(part.view());
    const PalpatePeerMesh view = organ.view();
    opened_ = peer.open(&view, views.data(), views.size());
    if (opened_ == nullptr)
      throw std::runtime_error(std::string("bench: ") + peer.name + " refused the organ");
    const Pose to_organ = question.scene.organ_pose.inverse();
    for (const PathPoint& at : question.way) {
      for (const geometry::ToolPart& part : tool().parts) {
        const Pose pose = to_organ * at.handle_W * geometry::part_pose(part, at.gripper);
        poses_.push_back({pose.position.x(), pose.position.y(), pose.position.z(), pose.rotation.w(),
                          pose.rotation.x(), pose.rotation.y(), pose.rotation.z()});
      }
    }
  }
  ~LoadedPeer() { peer_->close(opened_); }
  LoadedPeer(const LoadedPeer&) = delete;
  LoadedPeer& operator=(const LoadedPeer&) = delete;

  /// The peer's answer at point `i` of the path.
  double at(std::size_t i) {
    return peer_->ask(opened_, poses_[i * tool().parts.size()].data(), tips_[i].data());
  }
  [[nodiscard]] const Vec3& tip(std::size_t i) const { return tips_[i]; }

 private:
  [[nodiscard]] const geometry::Tool& tool() const { return scene_->tools[0]; }

  const PalpatePeer* peer_;
  const scene::Scene* scene_;
  std::vector<Vec3> tips_;
  std::vector<std::array<double, 7>> poses_;  // of all parts, per point of the path
  void* opened_ = nullptr;
};

/// Stride along the path for which the time suffices.
std::size_t stride_for(LoadedPeer& loaded, const PalpatePeer& peer, const PeerComparison& question) {
  const std::size_t count = question.way.size();
  const std::size_t trials = peer.in_order != 0 ? kTrialInOrder : kTrial;
  const std::int64_t begun = thread_cpu_ns();
  for (std::size_t i = 0; i < trials; ++i) loaded.at(peer.in_order != 0 ? 0 : i * count / trials);
  const double each = static_cast<double>(thread_cpu_ns() - begun) * 1e-9 / static_cast<double>(trials);
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(each * static_cast<double>(count) / question.seconds)));
}

/// Compares with Palpate's distance: of the tool's tip, or of the whole tool.
void check_answers(LoadedPeer& loaded, const PalpatePeer& peer, const PeerComparison& question) {
  if (peer.in_order != 0) return;  // it returns no distance
  const geometry::SignedDistance surface(question.scene.organ);
  const std::size_t step = std::max<std::size_t>(1, question.way.size() / kChecks);
  for (std::size_t i = 0; i < question.way.size(); i += step) {
    const double own =
        peer.one_point != 0 ? std::abs(surface.nearest(loaded.tip(i)).distance) : question.way[i].distance;
    const bool outside = question.way[i].phase == contact::Phase::kApproach && own > 1e-3;
    const double answer = loaded.at(i);
    if ((peer.one_point == 0 && !outside) || std::abs(answer - own) <= kSameAnswer) continue;
    throw std::runtime_error(std::string("bench: ") + peer.name + " finds " + shortest(answer * 1e3) +
                             " mm where palpate finds " + shortest(own * 1e3) + " mm");
  }
}

}  // namespace

const std::vector<SupportedPeer>& supported_peers() {
  static const std::vector<SupportedPeer> known = {
      {"Bullet", "libbullet-dev"}, {"FCL", "libfcl-dev"}, {"Embree", "libembree-dev"}};
  return known;
}

std::filesystem::path peers_library() { return folder_of_program() / "libpalpate_peers.so"; }

Peers::Peers(const std::filesystem::path& library) {
  // It stays open until the program ends, because threads of a peer may live that long.
  void* opened = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (opened == nullptr) return;
  using List = const PalpatePeer* (*)(std::size_t*);
  const auto list = reinterpret_cast<List>(dlsym(opened, "palpate_peers"));
  if (list == nullptr) return;
  std::size_t count = 0;
  const PalpatePeer* first = list(&count);
  all_.assign(first, first + count);
}

std::vector<std::string> Peers::missing() const {
  std::vector<std::string> lines;
  for (const SupportedPeer& known : supported_peers()) {
    const bool there = std::any_of(all_.begin(), all_.end(),
                                   [&](const PalpatePeer& peer) { return known.name == peer.name; });
    if (there) continue;
    lines.push_back(known.name + " is not compared with: it was not there when palpate was built (Debian: " +
                    known.package + ")");
  }
  return lines;
}

PeerAccount measure_peer(const PalpatePeer& peer, const PeerComparison& question) {
  LoadedPeer loaded(peer, question);
  check_answers(loaded, peer, question);
  const std::size_t at_once = peer.one_point != 0 ? kPointsAtOnce : 1;
  const std::size_t stride = peer.one_point != 0 ? 1 : stride_for(loaded, peer, question);
  std::vector<double> contact_us;
  std::vector<double> approach_us;
  bool touched = peer.one_point != 0;
  for (std::size_t first = 0; first + at_once <= question.way.size(); first += std::max(stride, at_once)) {
    const std::int64_t begun = thread_cpu_ns();
    double answer = 0.0;
    for (std::size_t i = first; i < first + at_once; ++i) answer = loaded.at(i);
    const double spent = static_cast<double>(thread_cpu_ns() - begun) / kNanosecondsPerMicrosecond /
                         static_cast<double>(at_once);
    if (question.way[first].phase != contact::Phase::kApproach) {
      contact_us.push_back(spent);
      touched = touched || answer <= 0.0;
    } else if (question.way[first].distance <= kNear) {
      approach_us.push_back(spent);
    }
  }
  if (!touched) contact_us.clear();  // the tool never touched the organ in its simulation
  PeerAccount account;
  account.name = peer.name;
  account.does = peer.does;
  account.scene = question.scene.name;
  account.organ_triangles = question.scene.organ.triangles.size();
  account.tool_triangles = peer.one_point != 0 ? 0 : triangle_count(question.scene.tools[0]);
  account.contact = figures_of(std::move(contact_us));
  account.approach = figures_of(std::move(approach_us));
  return account;
}

}  // namespace palpate::bench

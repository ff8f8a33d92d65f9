// normals_by_clusters(): the averaged normals of fine meshes.
#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "core/base/index.h"
#include "core/base/parallel.h"
#include "core/contact/averaged_normals.h"
#include "core/contact/normal_clusters.h"
#include "core/contact/patch_sums.h"

namespace palpate::contact {
namespace {

constexpr float kClusterSlack = 1.00001F;  // the same
constexpr double kClustersInRadius = 4.0;  // a cluster's cell is at most this part of it
// Of the radius. A cluster this small that borders on what the surface leads to counts as led to, wherever
// the border is: else a fold whose rim passes just outside the reach would have to be asked about point by
// point.
constexpr float kSmall = 0.125F;
// Of the radius. A triangle of no longer edges has one weight instead of one for each edge's middle; the
// difference is in triangles that cross the end of the reach, below 0.001 degrees.
constexpr double kShortEdge = 1.0 / 32.0;

/// Averages at all sides that begin in one cluster, "home", after another; one a thread. Clusters are taken
/// in three lists: those that lie within reach of every point of home; those beside them, some triangles of
/// which are in reach of every point; and the rest, about which each point is asked.
class ClusterFlood final {
 public:
  ClusterFlood(const SurfaceView& surface, const Sides& sides, const NormalClusters& clusters, double radius)
      : surface_(surface),
        sides_(sides),
        clusters_(clusters),
        radius_(radius),
        reach_(static_cast<float>(radius)),
        state_(clusters.size(), 0) {}

  void average(std::int32_t home, std::vector<NormalAndSlope>& normals) {
    collect_targets(home);
    if (targets_.empty()) return;
    spread(home);
    for (std::size_t first = 0; first < targets_.size(); first += kTogether) {
      const std::span<const Wanted> group =
          std::span(targets_).subspan(first, std::min(kTogether, targets_.size() - first));
      const Crowd crowd = crowd_of(group);
      SharedSum sum = *shared_;
      sift(doubtful_, crowd, sum, still_doubtful_);
      for (const Wanted& wanted : group) {
        Target target{wanted.point, wanted.reference_rounded, wanted.bends, sum.at(wanted.point, radius_)};
        if (wanted.bends) target.slope = sum.slope_at(wanted.point, radius_);
        add_doubtful(target);
        ask_for_the_rest(target);
        normals[at(wanted.side)] = NormalAndSlope::of(target.sum, target.slope, wanted.reference);
      }
    }
    for (const std::vector<std::int32_t>* list : {&within_, &beside_, &rest_}) {
      for (const std::int32_t cluster : *list) state_[at(cluster)] = 0;
    }
  }

 private:
  struct Wanted {
    std::int32_t side;
    Vec3 point;
    Vec3 reference;
    std::array<float, 3> reference_rounded;
    bool bends;  // whether a triangle there is so long that its normals bend
  };
  /// Several points and where they look, as one thing.
  struct Crowd {
    Vec3 centre;
    std::array<float, 3> reference;  // mean
    float size;                      // no point is farther from `centre`
    float turned;                    // no reference is farther from `reference`
  };
  /// A block that some points must look at for themselves; `centre` from home's.
  struct Doubtful {
    std::array<float, 3> centre;
    float reach;
    std::array<float, 3> axis;
    float spread;
    std::int32_t block;
  };
  static constexpr std::size_t kTogether = 6;  // points that sift the blocks together
  static constexpr std::uint8_t kCertain = 1;  // some triangles are in reach of every point, or this one
  static constexpr std::uint8_t kListed = 2;   // in rest_, not known to be in reach

  void collect_targets(std::int32_t home) {
    targets_.clear();
    const std::size_t end = at(clusters_.cluster(at(home) + 1).first_triangle);
    for (std::size_t i = at(clusters_.cluster(at(home)).first_triangle); i < end; ++i) {
      for (std::int32_t c = 0; c < 3; ++c) {
        const std::int32_t triangle = clusters_.triangles()[i];
        const std::int32_t side = sides_.of_corner[at(3 * triangle + c)];
        if (sides_.first_corner[at(side)] != 3 * triangle + c) continue;
        fan_.collect(surface_, 3 * triangle + c);
        const Vec3& reference = fan_.reference();
        targets_.push_back({side, surface_.mesh.vertices[at(surface_.mesh.triangles[at(triangle)][at(c)])],
                            reference, rounded(reference), has_long_edge(fan_.triangles())});
      }
    }
  }

  /// Normals of triangles with short edges bend by less than 0.01 degrees where the surface is curved like
  /// the reach: that is not worked out.
  [[nodiscard]] bool has_long_edge(std::span<const std::int32_t> triangles) const {
    const double longest = radius_ * kShortEdge;
    return std::any_of(triangles.begin(), triangles.end(), [&](std::int32_t triangle) {
      const geometry::Triangle& corners = surface_.mesh.triangles[at(triangle)];
      for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 edge =
            surface_.mesh.vertices[at(corners[(e + 1) % 3])] - surface_.mesh.vertices[at(corners[e])];
        if (edge.squaredNorm() > longest * longest) return true;
      }
      return false;
    });
  }

  [[nodiscard]] static Crowd crowd_of(std::span<const Wanted> group) {
    Vec3 low = group.front().point;
    Vec3 high = low;
    Vec3 reference = Vec3::Zero();
    for (const Wanted& wanted : group) {
      low = low.cwiseMin(wanted.point);
      high = high.cwiseMax(wanted.point);
      reference += wanted.reference;
    }
    reference /= static_cast<double>(group.size());
    double size = 0.0;
    double turned = 0.0;
    Crowd crowd{0.5 * (low + high), rounded(reference), 0.0F, 0.0F};
    for (const Wanted& wanted : group) {
      size = std::max(size, (wanted.point - crowd.centre).norm());
      turned = std::max(turned, (wanted.reference - reference).norm());
    }
    crowd.size = static_cast<float>(size) * kClusterSlack;
    crowd.turned = static_cast<float>(turned) * kClusterSlack;
    return crowd;
  }

  /// Splits blocks into those that count in full for every point of a crowd (added to `sum`), those that
  /// count for none, and those that remain doubtful.
  void sift(std::span<const Doubtful> blocks, const Crowd& crowd, SharedSum& sum,
            std::vector<Doubtful>& doubtful) const {
    doubtful.clear();
    const std::array<float, 3> centre = rounded(crowd.centre - centre_);
    const float near = std::max(0.0F, kWithin * reach_ - crowd.size);
    const float far = reach_ + crowd.size;
    for (const Doubtful& block : blocks) {
      const float squared = squared_distance(block.centre, centre);
      if (squared >= (far + block.reach) * (far + block.reach)) continue;
      const Turn turn = turn_of(block.axis, block.spread + crowd.turned, crowd.reference);
      if (turn == Turn::kAway) continue;
      const float inner = near - block.reach;
      if (turn == Turn::kTowards && inner > 0.0F && squared <= inner * inner) {
        sum.add(clusters_.blocks()[at(block.block)].patch);
      } else {
        doubtful.push_back(block);
      }
    }
  }

  void add_doubtful(Target& target) const {
    const std::array<float, 3> point = rounded(target.point - centre_);
    const float inverse = 1.0F / (reach_ * reach_);
    for (const Doubtful& near : still_doubtful_) {
      const std::array<float, 3> u{point[0] - near.centre[0], point[1] - near.centre[1],
                                   point[2] - near.centre[2]};
      const float squared = dot(u, u);
      if (squared >= (reach_ + near.reach) * (reach_ + near.reach)) continue;
      const Turn turn = turn_of(near.axis, near.spread, target.reference);
      if (turn == Turn::kAway) continue;
      const Block& block = clusters_.blocks()[at(near.block)];
      const float inner = kWithin * reach_ - near.reach;
      if (turn == Turn::kTowards && inner > 0.0F && squared <= inner * inner) {
        add_whole(block.patch, u, inverse, target);
      } else {
        add_singly(clusters_, block, u, reach_, turn == Turn::kTowards, target);
      }
    }
  }

  /// Fills the lists and adds up what counts in full for every point of home.
  void spread(std::int32_t home) {
    const Patch& patch = clusters_.cluster(at(home)).patch;
    centre_ = exact(patch.centre);
    const float near = reach_ - patch.reach;  // within this of home's centre: in reach of every point
    const float far = reach_ + patch.reach;   // beyond it: of none
    Crowd crowd = crowd_of(targets_);
    crowd.centre = centre_;
    crowd.size = patch.reach;
    shared_.emplace(centre_);
    within_.clear();
    beside_.clear();
    rest_.clear();
    all_blocks_.clear();
    take(home, near, crowd);
    for (std::size_t i = 0; i < within_.size(); ++i) {
      for_neighbours(within_[i], [&](const NormalClusters::Neighbour& next) {
        if (state_[at(next.cluster)] == 0) take(next.cluster, near, crowd);
      });
    }
    const auto go_on_from = [&](std::int32_t cluster) {
      for_neighbours(cluster, [&](const NormalClusters::Neighbour& next) {
        const Patch& other = clusters_.cluster(at(next.cluster)).patch;
        if (state_[at(next.cluster)] != 0 ||
            reach_of(other, from_centre(other, centre_), far) == Reach::kOut) {
          return;
        }
        const bool is_small = other.reach <= kSmall * reach_ && patch.reach <= kSmall * reach_;
        const bool is_certain =
            state_[at(cluster)] == kCertain && (is_small || has_border_within(next, near));
        state_[at(next.cluster)] = is_certain ? kCertain : kListed;
        (is_certain ? beside_ : rest_).push_back(next.cluster);
      });
    };
    for (std::size_t i = 0; i < beside_.size(); ++i) go_on_from(beside_[i]);
    for (std::size_t i = 0; i < rest_.size(); ++i) go_on_from(rest_[i]);
    for (const std::int32_t cluster : beside_) list_blocks(cluster);
    sift(all_blocks_, crowd, *shared_, doubtful_);
  }

  void list_blocks(std::int32_t cluster) {
    const std::size_t end = at(clusters_.cluster(at(cluster) + 1).first_block);
    for (std::size_t i = at(clusters_.cluster(at(cluster)).first_block); i < end; ++i) {
      const Patch& patch = clusters_.blocks()[i].patch;
      all_blocks_.push_back({rounded(exact(patch.centre) - centre_), patch.reach, patch.axis, patch.spread,
                             static_cast<std::int32_t>(i)});
    }
  }

  /// Whether an end of an edge between the two clusters is nearer to home's centre than `near`.
  [[nodiscard]] bool has_border_within(const NormalClusters::Neighbour& next, float near) const {
    if (near <= 0.0F) return false;
    const double squared = static_cast<double>(near) * static_cast<double>(near);
    for (std::size_t i = at(next.first_link); i < at(next.last_link); ++i) {
      const geometry::Triangle& from = surface_.mesh.triangles[at(clusters_.links()[i].from)];
      const geometry::Triangle& to = surface_.mesh.triangles[at(clusters_.links()[i].to)];
      for (const std::int32_t corner : from) {
        if ((surface_.mesh.vertices[at(corner)] - centre_).squaredNorm() >= squared) continue;
        if (std::find(to.begin(), to.end(), corner) != to.end()) return true;
      }
    }
    return false;
  }

  void take(std::int32_t index, float near, const Crowd& crowd) {
    const Patch& patch = clusters_.cluster(at(index)).patch;
    state_[at(index)] = kCertain;
    if (near <= 0.0F || reach_of(patch, from_centre(patch, centre_), near) != Reach::kWhole) {
      beside_.push_back(index);
      return;
    }
    within_.push_back(index);
    switch (turn_of(patch.axis, patch.spread + crowd.turned, crowd.reference)) {
      case Turn::kAway:
        break;
      case Turn::kTowards:
        shared_->add(patch);
        break;
      case Turn::kPartly:
        list_blocks(index);
        break;
    }
  }

  /// Of the rest, what the surface leads to within reach of this point.
  void ask_for_the_rest(Target& target) {
    waiting_.clear();
    for (const std::int32_t cluster : rest_) {
      const Patch& patch = clusters_.cluster(at(cluster)).patch;
      if (reach_of(patch, from_centre(patch, target.point), reach_) != Reach::kOut)
        waiting_.push_back(cluster);
    }
    found_.clear();
    for (bool more = true; more;) {
      more = false;
      for (std::int32_t& cluster : waiting_) {
        if (cluster < 0 || !led_to(cluster, target.point)) continue;
        state_[at(cluster)] = kCertain;
        found_.push_back(cluster);
        const std::array<float, 3> u = from_centre(clusters_.cluster(at(cluster)).patch, target.point);
        add_cluster(clusters_, cluster, u, reach_of(clusters_.cluster(at(cluster)).patch, u, reach_), reach_,
                    target);
        cluster = -1;
        more = true;
      }
    }
    for (const std::int32_t cluster : found_) state_[at(cluster)] = kListed;
  }

  /// Whether triangles on either side of a border with what is certain are both in reach.
  [[nodiscard]] bool led_to(std::int32_t cluster, const Vec3& point) const {
    bool found = false;
    for_neighbours(cluster, [&](const NormalClusters::Neighbour& next) {
      if (found || state_[at(next.cluster)] != kCertain) return;
      for (std::size_t i = at(next.first_link); i < at(next.last_link) && !found; ++i) {
        const NormalClusters::Link& link = clusters_.links()[i];
        found = in_reach(link.from, point) && in_reach(link.to, point);
      }
    });
    return found;
  }

  template <typename Do>
  void for_neighbours(std::int32_t cluster, const Do& act) const {
    const std::size_t end = at(clusters_.cluster(at(cluster) + 1).first_neighbour);
    for (std::size_t i = at(clusters_.cluster(at(cluster)).first_neighbour); i < end; ++i) {
      act(clusters_.neighbours()[i]);
    }
  }

  [[nodiscard]] bool in_reach(std::int32_t triangle, const Vec3& point) const {
    const geometry::Triangle& corners = surface_.mesh.triangles[at(triangle)];
    return std::any_of(corners.begin(), corners.end(), [&](std::int32_t corner) {
      return (surface_.mesh.vertices[at(corner)] - point).squaredNorm() < radius_ * radius_;
    });
  }

  const SurfaceView& surface_;
  const Sides& sides_;
  const NormalClusters& clusters_;
  double radius_;
  float reach_;
  SideFan fan_;
  std::vector<Wanted> targets_;
  std::optional<SharedSum> shared_;
  std::vector<std::uint8_t> state_;       // of each cluster; 0: not met
  Vec3 centre_ = Vec3::Zero();            // of home
  std::vector<Doubtful> all_blocks_;      // of clusters that are neither in full for all points nor for none
  std::vector<Doubtful> doubtful_;        // of these, for home
  std::vector<Doubtful> still_doubtful_;  // of these, for the points that are together
  std::vector<std::int32_t> within_;
  std::vector<std::int32_t> beside_;
  std::vector<std::int32_t> rest_;
  std::vector<std::int32_t> waiting_;  // of the rest, in reach of the point that is asked about
  std::vector<std::int32_t> found_;
};

}  // namespace

std::vector<NormalAndSlope> normals_by_clusters(const SurfaceView& surface, const Sides& sides, double radius,
                                                const Share& share) {
  constexpr std::size_t kBatch = 1024;  // clusters between two words on how far it is
  constexpr std::size_t kGrain = 32;
  const NormalClusters clusters(surface, radius / kClustersInRadius, radius * kShortEdge);
  std::vector<NormalAndSlope> normals(sides.first_corner.size());
  std::mutex mutex;
  std::vector<std::unique_ptr<ClusterFlood>> idle;
  for (std::size_t from = 0; from < clusters.size(); from += kBatch) {
    if (share) share(static_cast<double>(from) / static_cast<double>(clusters.size()));
    for_ranges(std::min(kBatch, clusters.size() - from), kGrain, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<ClusterFlood> flood;
      {
        const std::lock_guard lock(mutex);
        if (!idle.empty()) {
          flood = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!flood) flood = std::make_unique<ClusterFlood>(surface, sides, clusters, radius);
      for (std::size_t home = from + begin; home < from + end; ++home) {
        flood->average(static_cast<std::int32_t>(home), normals);
      }
      const std::lock_guard lock(mutex);
      idle.push_back(std::move(flood));
    });
  }
  return normals;
}

}  // namespace palpate::contact

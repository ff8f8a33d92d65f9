#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/organ_surface.h"
#include "core/contact/tool_tissue.h"
#include "core/model/relaxation.h"
#include "palpate/pose.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"
#include "palpate/tool_contact.h"

namespace palpate::contact {

struct PartState;

/// A piece of the channel that a needle has cut: from `start` to the next piece's start, or to its end.
struct ChannelPiece {
  double start = 0.0;  // [m] along the shaft, from the entry
  int layer = 0;       // from 0; kOutsideLayers: beyond the organ's far side
};
inline constexpr int kOutsideLayers = -1;

/// The straight line of a shaft across the channel: lateral position over the way along the channel.
struct ShaftLine {
  Vec3 at_entry = Vec3::Zero();  // [m], perpendicular to the channel
  Vec3 slope = Vec3::Zero();     // per metre of way, perpendicular to the channel
  [[nodiscard]] Vec3 at(double way) const noexcept { return at_entry + way * slope; }
};

/// A needle in layered tissue: from the puncture of the surface until it has left (see the head of
/// needle.cc). Organ frame S. Plain data of fixed size; a copy continues with the same results.
///
/// Invariants while inside: length_ <= cut_ <= the shaft's length (length_ below 0: the tip is out and the
/// tissue still snaps back); the channel's pieces start at increasing lengths, the first at 0.
class NeedleInsertion final {
 public:
  /// [rt] Punctures the surface if a contact presses the tip with the first layer's force. To be called
  /// before the tick's motion, with the contacts of the last tick. @param tool_S pose of the handle then
  /// @return whether the needle is inside now
  bool try_puncture(const OrganSurface& surface, const ToolTissue& tissue,
                    const std::vector<model::TissueLayer>& layers, const geometry::Needle& needle,
                    const Pose& tool_S, std::span<PartState> parts) noexcept;

  /// [any] Punctures a flat surface at z = 0 of a tissue below it, straight down, for fits to records along
  /// one line. @param depth of the press there [m] @param memory of its force
  void puncture_flat(const std::vector<model::TissueLayer>& layers, double depth, double force,
                     const model::RelaxationState& memory) noexcept;

  /// [rt] One tick inside. @param surface null after puncture_flat() @param tool_S pose of the handle
  /// @param period T [s]
  void advance(const OrganSurface* surface, const ToolTissue& tissue,
               const std::vector<model::TissueLayer>& layers, const geometry::Needle& needle,
               const Pose& tool_S, double period) noexcept;

  /// [rt] The tool jumped: out without a fade.
  void release_at_once() noexcept { *this = {}; }

  /// [rt] Changes the relaxation from the next tick on.
  void change_relaxation(const model::Relaxation& now, const model::Relaxation& before) noexcept {
    now.convert_history(memory_, before);
  }

  [[nodiscard]] bool is_inside() const noexcept { return inside_; }
  /// [rt] Force [N] and torque [N m] on the tool; the torque is about the handle's origin.
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }
  [[nodiscard]] const Vec3& torque() const noexcept { return torque_; }
  /// [rt] Where it went in, and its direction inwards then.
  [[nodiscard]] const SurfacePoint& entry() const noexcept { return entry_; }
  [[nodiscard]] const Vec3& direction() const noexcept { return direction_; }
  /// [rt] u [m]: displacement of the tissue at the entry along the direction; negative: drawn outwards.
  [[nodiscard]] double displacement() const noexcept { return displacement_; }
  /// [rt] z [m]: way of the tip from the entry along the direction.
  [[nodiscard]] double way() const noexcept { return displacement_ + length_; }
  /// [rt] Radius of curvature at the tip and radius of the shaft [m], for pictures.
  [[nodiscard]] double tip_radius() const noexcept { return tip_radius_; }
  [[nodiscard]] double radius() const noexcept { return radius_; }
  /// [rt] Of the law at that displacement.
  [[nodiscard]] const model::ContactResponse& response() const noexcept { return response_; }
  /// [rt] Of the last advance(); `left` only after the needle has left.
  [[nodiscard]] const InsertedNeedle& state() const noexcept { return state_; }
  void clear_state() noexcept { state_ = {}; }

 private:
  static constexpr std::size_t kMaxPieces = 2 * model::kMaxTissueLayers + 1;

  struct Tick;  // what one tick's steps share

  [[nodiscard]] double elastic_at(const TissueLaws& laws, double displacement) const noexcept;
  [[nodiscard]] double displacement_under(const TissueLaws& laws, double elastic) const noexcept;
  [[nodiscard]] double shaft_friction(const Tick& tick) const noexcept;
  [[nodiscard]] double tip_bound(const Tick& tick) const noexcept;
  [[nodiscard]] int layer_at_tip() const noexcept;
  [[nodiscard]] bool is_at_hub(const geometry::Needle& needle) const noexcept;
  [[nodiscard]] double rated_slip(const Tick& tick, const model::Relaxation::Line& line, double bound,
                                  double most) const noexcept;
  void slip_inwards(const Tick& tick, const model::Relaxation::Line& line) noexcept;
  void slip_outwards(const Tick& tick, const model::Relaxation::Line& line) noexcept;
  [[nodiscard]] double cut(const Tick& tick, double way) noexcept;
  void enter(const Tick& tick, int layer, bool punctured) noexcept;
  void bind_sideways(const Tick& tick, const ShaftLine& shaft) noexcept;

  bool inside_ = false;
  SurfacePoint entry_;               // on the rest surface
  Vec3 origin_ = Vec3::Zero();       // of the way along the channel
  Vec3 direction_ = Vec3::UnitZ();   // a, unit
  double amplitude_ = 1.0;           // of the law, for place, size and slant of the entry
  double slant_ = 1.0;               // cosine of the angle between direction and surface normal
  model::RelaxationState memory_{};  // of the axial force
  double displacement_ = 0.0;        // u [m]
  double length_ = 0.0;              // L of the shaft inside [m]
  double cut_ = 0.0;                 // longest L so far: the channel's length [m]
  double front_depth_ = 0.0;         // of the channel's end below the surface [m]
  std::int32_t guess_ = -1;          // triangle nearest to it
  int beyond_ = 0;                   // layer behind the membrane at the channel's end
  bool at_membrane_ = false;
  double surplus_ = 0.0;  // of the tip's bound after a puncture, falls to 0 [N]
  std::array<ChannelPiece, kMaxPieces> pieces_{};
  std::size_t piece_count_ = 0;
  ShaftLine rest_;             // of the channel's springs
  double bound_length_ = 0.0;  // of the shaft that they hold [m]
  double tip_radius_ = 0.0;
  double radius_ = 0.0;
  Vec3 force_ = Vec3::Zero();
  Vec3 torque_ = Vec3::Zero();
  model::ContactResponse response_{};
  InsertedNeedle state_{};
};

}  // namespace palpate::contact

// A draw list some of whose items stand elsewhere, at one time after another, and a ray caster for it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// The list is copied once, however often its items are placed.
///
/// Lifetime  the list of set() must live until the last place().
class MovedWorld {
 public:
  /// Another list, or the same one after a change.
  void set(const DrawList& list);

  /// The list with these items elsewhere. All calls after one set() have the same items in the same order, or none.
  /// `threads` of the caster are those of the frame's caster, and the same in all calls.
  const DrawList& place(std::span<const ItemPlace> places, unsigned threads);

  /// A caster into the list of the last place().
  RayCaster& caster() { return *caster_; }

  /// Lists copied since it was made.
  std::uint64_t copies() const { return copies_; }

 private:
  const DrawList* list_ = nullptr;
  bool copied_ = false;
  DrawList moved_;
  std::unique_ptr<RayCaster> caster_;  // null until something has moved
  std::uint64_t copies_ = 0;
};

}  // namespace simvis

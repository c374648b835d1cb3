// The element `visibility_flags`: which sensors see the shapes of parts, by 32 bits.
//
//   <element type="visibility_flags" name="MARKERS" insert_at="ROOT" parts="MARKER_*" flags="2"/>
//   <element type="visibility_flags" name="VISOR" insert_at="ROOT" part="HELMET" material="Glass" flags="4"/>
//   <sensor type="camera" name="EYE" insert_at="ROBOT" visibility_mask="5"/>
//
// Rule     a sensor sees a shape if its attribute `visibility_mask` and the flags of the shape share a bit, as SDF's
//          <visibility_mask> and <visibility_flags> say. Both have all bits where nothing is said.
// Reach    see shape_selection.h; what was inserted at a part has flags of its own.
// Effects  those of the attribute `ignore`, see simvis/ignored_items.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/shape_selection.h"

namespace simvis {

inline constexpr std::uint32_t kAllVisibilityFlags = 0xFFFFFFFF;

/// The flags of shapes.
struct VisibilityFlags {
  std::string element;                        ///< name of the element
  std::uint32_t flags = kAllVisibilityFlags;  ///< 0: no sensor sees the shapes
  ShapeSelection shapes;                      ///< that have the flags
};

/// Those of a scene, in any order. Valid until an element `visibility_flags` is made or removed.
std::vector<const VisibilityFlags*> visibility_flags_of(const Scene& scene);

class VisibilityFlagsElement : public Element {
 public:
  /// Throws InputError at the attribute: no flags, no such material or name, a pattern that matches nothing, or a part
  /// that has flags already.
  explicit VisibilityFlagsElement(const ElementContext& context);
  void update(ParameterView) override {}
};

}  // namespace simvis

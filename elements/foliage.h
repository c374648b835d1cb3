// The element `foliage`: fades the leaves of a part, to show what they hide and how they affect a sensor.
//
//   <element type="foliage" name="LEAVES" insert_at="ROOT" part="TREE" transparency="60"/>
//
// Leaves   All materials of the part with the alpha mode mask or blend count as leaves, because leaves are usually cut
//          out of a picture. Opaque materials, such as those of trunks, do not change. Parts that were inserted at the
//          tree keep their leaves. The factors of several elements on one part multiply.
// Parameters  transparency (live), in %. At 0 leaves look as in the file. Between 0 and 100 a masked leaf is blended:
//          each texel that passes the alpha cutoff covers 1 - transparency of the background. A blended leaf covers its
//          alpha times that share. Depth cameras and scanners measure a leaf that covers at least one half. At 100
//          leaves are not drawn.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class FoliageElement : public Element {
 public:
  /// Throws InputError at the attribute if the part does not exist or has no masked or blended materials.
  explicit FoliageElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A leaf material, and the number of this element's change in it.
  struct Leaves {
    std::shared_ptr<MaterialNode> material;
    std::size_t number;
  };
  std::vector<Leaves> leaves_;
};

}  // namespace simvis

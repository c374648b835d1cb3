// The element `foliage`: lets the leaves of a part fade, to see what they hide and what they do to a sensor.
//
//   <element type="foliage" name="LEAVES" insert_at="ROOT" part="TREE" transparency="60"/>
//
// Leaves   the part's materials of the alpha modes mask and blend: what has holes is cut out of a picture, as leaves
// are.
//          Trunks, of opaque materials, stay as they are.
//          Parts that were inserted at the tree keep theirs; several elements on one part act together.
// Parameters  transparency (live): in %. At 0 leaves are as in the file. Between, a masked leaf is blended, all that
//          its cutoff keeps alike: it covers 1 - transparency of what lies behind; a blended one covers its alpha times
//          that. Depth cameras and scanners meet what covers at least one half. At 100 leaves are gone: nothing is
//          drawn.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class FoliageElement : public Element {
 public:
  /// Throws InputError at the attribute: no such part, a part without masked or blended materials.
  explicit FoliageElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A material of leaves, and which of its changes is this element's.
  struct Leaves {
    std::shared_ptr<MaterialNode> material;
    std::size_t number;
  };
  std::vector<Leaves> leaves_;
};

}  // namespace simvis

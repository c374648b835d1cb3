// The element `sky`: sets the background where no surface is hit, and the ambient light.
//
//   <element type="sky" name="SKY" insert_at="ROOT" red="0.2" green="0.4" blue="0.9" ambient_blue="0.5"/>
//
// Parameters  red green blue, ambient_red ambient_green ambient_blue (live): linear radiance. A surface with the base
//          colour c shows c times the ambient radiance. The defaults are the values of a scene without this element.
// Several  If a scene has several sky elements, the last one in traversal order applies.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class SkyElement : public Element {
 public:
  explicit SkyElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<EnvironmentNode> node_;
};

}  // namespace simvis

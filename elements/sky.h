// The element `sky`: what is seen where nothing is hit, and the light that comes from all around.
//
//   <element type="sky" name="SKY" insert_at="ROOT" red="0.2" green="0.4" blue="0.9" ambient_blue="0.5"/>
//
// Parameters  red green blue, ambient_red ambient_green ambient_blue (live): linear radiance. A surface of base colour
// c
//          shows c times the ambient radiance. The defaults are those of a scene without this element.
// Several  the last in order of traversal counts.
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

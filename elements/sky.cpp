// The element `sky`: sets the background where no surface is hit, and the ambient light.
//
//   <element type="sky" name="SKY" insert_at="ROOT" red="0.2" green="0.4" blue="0.9" ambient_blue="0.5"/>
//
// Parameters  red green blue, ambient_red ambient_green ambient_blue (live): linear radiance. A surface with the base
//          colour c shows c times the ambient radiance. The defaults are the values of a scene without this element.
// Several  If a scene has several sky elements, the last one in traversal order applies.
#include <simvis/element.h>
#include <simvis/node.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

class SkyElement : public Element {
 public:
  explicit SkyElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<EnvironmentNode> node_;
};

constexpr AttributeLimits kSkyRadiance{.min = 0, .max = 1e12};

const AttributeRows<Environment> kSkyRows{
    color_rows(&Environment::background, "", kSkyRadiance, "linear radiance seen where nothing is hit"),
    color_rows(&Environment::ambient, "ambient_", kSkyRadiance, "linear radiance that arrives from all around")};

const ElementRegistration kSkyRegistration({
    .name = "sky",
    .summary = "Sets the background and the ambient light.",
    .notes = "Of several sky elements the last one counts.",
    .attributes = kSkyRows.table(),
    .create = create_element<SkyElement>,
});

}  // namespace

SkyElement::SkyElement(const ElementContext& context) : node_(std::make_shared<EnvironmentNode>(Environment())) {
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void SkyElement::update(ParameterView values) {
  Environment environment;
  kSkyRows.set(environment, values);
  node_->set_environment(environment);
}

}  // namespace simvis

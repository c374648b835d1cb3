#include "elements/sky.h"

#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

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

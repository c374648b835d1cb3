#include "elements/sky.h"

namespace simvis {
namespace {

constexpr AttributeSpec radiance(std::string_view name, std::string_view by_default, std::string_view text) {
  return {.name = name, .default_value = by_default, .text = text, .min = 0, .max = 1e12, .live = true};
}
constexpr AttributeSpec background(std::string_view name, std::string_view by_default) {
  return radiance(name, by_default, "linear radiance seen where nothing is hit");
}
constexpr AttributeSpec ambient(std::string_view name) {
  return radiance(name, "0.3", "linear radiance that arrives from all around");
}

// The defaults are the values of Environment.
constexpr AttributeSpec kSkyAttributes[] = {
    background("red", "0.55"), background("green", "0.68"), background("blue", "0.85"),
    ambient("ambient_red"),    ambient("ambient_green"),    ambient("ambient_blue"),
};

const ElementRegistration kSkyRegistration({
    .name = "sky",
    .summary = "Sets the background and the ambient light.",
    .notes = "Of several sky elements the last one counts.",
    .attributes = kSkyAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<SkyElement>(context);
    },
});

}  // namespace

SkyElement::SkyElement(const ElementContext& context) : node_(std::make_shared<EnvironmentNode>(Environment())) {
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void SkyElement::update(ParameterView values) {
  node_->set_environment({.ambient = glm::vec3(values[3], values[4], values[5]),
                          .background = glm::vec3(values[0], values[1], values[2])});
}

}  // namespace simvis

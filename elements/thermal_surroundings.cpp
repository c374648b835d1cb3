#include "elements/thermal_surroundings.h"

#include <utility>

#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

constexpr AttributeLimits kSurroundings_k{.min = 0, .max = kMaxTemperature_k};

const AttributeRows<ThermalSurroundings> kSurroundingsRows{
    row(&ThermalSurroundings::ambient_k, "ambient", "K", kSurroundings_k,
        "temperature of what surfaces reflect, and of surfaces without an element temperature")
        .live(),
    row(&ThermalSurroundings::sky_k, "sky", "K", kSurroundings_k, "temperature that is seen where nothing is hit")
        .live()};

const ElementRegistration kSurroundingsRegistration({
    .name = "thermal_surroundings",
    .summary = "Sets the temperatures of the surroundings and of the sky, for thermal cameras.",
    .notes = "A scene has at most one. Without it both are 293.15 K.",
    .attributes = kSurroundingsRows.table(),
    .create = create_element<ThermalSurroundingsElement>,
});

// Holds the numbers in the scene graph, so that they leave the scene with their element.
class SurroundingsNode : public Separator {
 public:
  explicit SurroundingsNode(std::shared_ptr<const ThermalSurroundings> surroundings)
      : surroundings_(std::move(surroundings)) {}
  const ThermalSurroundings& surroundings() const { return *surroundings_; }

 private:
  std::shared_ptr<const ThermalSurroundings> surroundings_;
};

}  // namespace

const ThermalSurroundings* thermal_surroundings_of(const Scene& scene) {
  for (const NodePtr& child : scene.root()->children()) {
    if (const auto* const node = dynamic_cast<const SurroundingsNode*>(child.get())) return &node->surroundings();
  }
  return nullptr;
}

ThermalSurroundingsElement::ThermalSurroundingsElement(const ElementContext& context)
    : surroundings_(std::make_shared<ThermalSurroundings>()) {
  if (thermal_surroundings_of(context.scene) != nullptr) {
    fail_at(context.command.where, "the scene already has an element of type thermal_surroundings, expected one");
  }
  context.scene.insert_in_world(context.command, std::make_shared<SurroundingsNode>(surroundings_));
}

void ThermalSurroundingsElement::update(ParameterView values) { kSurroundingsRows.set(*surroundings_, values); }

}  // namespace simvis

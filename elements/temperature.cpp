#include "elements/temperature.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "engine/base/read_error.h"
#include "scenegraph/picture_reader.h"

namespace simvis {
namespace {

constexpr std::string_view kWhite = "temperature_white";

// Live rows in the order in which update() reads them.
constexpr AttributeSpec kTemperatureRows[] = {
    {.name = "texture",
     .kind = AttributeKind::file,
     .text = "grey picture on the shapes: black is `temperature`, white is `temperature_white`; default: none"},
    {.name = "temperature",
     .default_value = "293.15",
     .unit = "K",
     .text = "temperature of the surface",
     .min = 0,
     .max = kMaxTemperature_k,
     .live = true},
    {.name = "emissivity",
     .default_value = "1",
     .text = "share of a black body's radiance that it emits; it reflects the rest of what surrounds it",
     .min = 0,
     .max = 1,
     .live = true},
    {.name = kWhite,
     .default_value = "293.15",
     .unit = "K",
     .text = "with texture: temperature where the texture is white",
     .min = 0,
     .max = kMaxTemperature_k,
     .live = true},
};

const ElementRegistration kTemperatureRegistration({
    .name = "temperature",
    .summary = "Gives the shapes of parts a temperature and an emissivity, for thermal cameras.",
    .notes = "Shapes without one have the temperature of the surroundings, see thermal_surroundings, and emit as black "
             "bodies. The element with the nearest name of a shape takes precedence, then one with a material, over "
             "one of the whole part. What is inserted at a part later belongs to other parts.",
    .attributes = with_selection_rows(kTemperatureRows),
    .create = create_element<TemperatureElement>,
});

// Holds the heat in the scene graph, so that it leaves the scene with its element.
class HeatNode : public Separator {
 public:
  explicit HeatNode(std::shared_ptr<const SelectedHeat> selected) : selected_(std::move(selected)) {}
  const SelectedHeat& selected() const { return *selected_; }

 private:
  std::shared_ptr<const SelectedHeat> selected_;
};

// The picture with its greys as alpha, which is sampled without the curve of sRGB.
std::shared_ptr<const Texture> heat_texture(const ElementContext& context) {
  if (!context.attributes.is_set("texture")) return nullptr;
  const Location where = context.attributes.where("texture");
  const std::filesystem::path file = (context.command.folder / context.attributes.text("texture")).lexically_normal();
  if (!is_input_file(file)) fail_at(where, "attribute \"texture\": there is no picture " + in_quotes(file.string()));
  Texture texture;
  try {
    texture = picture_reader().texture(file);
  } catch (const InputError& error) {
    fail_at(where, "attribute \"texture\": " + std::string(error.what()));
  }
  texture.name = file.filename().string();
  for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
    const unsigned sum = unsigned{texture.rgba[i]} + texture.rgba[i + 1] + texture.rgba[i + 2];
    texture.rgba[i + 3] = static_cast<std::uint8_t>((sum + 1) / 3);
  }
  return std::make_shared<const Texture>(std::move(texture));
}

void check_free(const ElementContext& context, const SelectedHeat& selected) {
  for (const SelectedHeat* const other : temperatures_of(context.scene)) {
    const std::optional<SharedShapes> shared = shared_shapes(selected.shapes, other->shapes);
    if (!shared) continue;
    fail_at(selection_place(context), in_quotes(shared->point) + " already has a temperature from element " +
                                          in_quotes(other->element) + shared->which() +
                                          ", expected one temperature for each part");
  }
}

}  // namespace

std::vector<const SelectedHeat*> temperatures_of(const Scene& scene) {
  std::vector<const SelectedHeat*> all;
  for (const NodePtr& child : scene.root()->children()) {
    if (const auto* const node = dynamic_cast<const HeatNode*>(child.get())) all.push_back(&node->selected());
  }
  return all;
}

TemperatureElement::TemperatureElement(const ElementContext& context)
    : selected_(std::make_shared<SelectedHeat>(SelectedHeat{.element = context.command.require("name").value,
                                                            .shapes = selected_shapes(context, "temperature"),
                                                            .heat = {}})) {
  check_free(context, *selected_);
  selected_->heat.texture = heat_texture(context);
  if (selected_->heat.texture == nullptr && context.command.find(kWhite) != nullptr) {
    fail_at(context.attributes.where(kWhite),
            "attribute \"temperature_white\": there is no white without a texture, expected the attribute \"texture\" "
            "too");
  }
  context.scene.insert_in_world(context.command, std::make_shared<HeatNode>(selected_));
}

void TemperatureElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  if (selected_->heat.texture != nullptr) return;
  std::erase_if(live_rows, [](const AttributeSpec& row) { return row.name == kWhite; });
}

void TemperatureElement::update(ParameterView values) {
  SurfaceHeat& heat = selected_->heat;
  heat.temperature_k = values[0];
  heat.emissivity = values[1];
  if (heat.texture != nullptr) heat.white_k = values[2];
}

}  // namespace simvis

#include "elements/temperature.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "engine/base/read_error.h"
#include "scenegraph/language/attribute_rows.h"
#include "scenegraph/picture_reader.h"

namespace simvis {
namespace {

AttributeRows<TemperatureDesc> temperature_rows() {
  using Desc = TemperatureDesc;
  constexpr AttributeLimits kTemperature{.min = 0, .max = kMaxTemperature_k};
  return {row(&Desc::texture, AttributeKind::file, "texture",
              "grey picture on the shapes: black is `temperature`, white is `temperature_white`; default: none"),
          row(&Desc::temperature_k, "temperature", "K", kTemperature, "temperature of the surface").live(),
          row(&Desc::emissivity, "emissivity", "", {.min = 0, .max = 1},
              "share of a black body's radiance that it emits; it reflects the rest of what surrounds it")
              .live(),
          row(&Desc::white_k, "temperature_white", "K", kTemperature,
              "with texture: temperature where the texture is white")
              .live()
              .only("with a texture", &Desc::has_texture)};
}
const AttributeRows<TemperatureDesc> kTemperatureRows = temperature_rows();

const ElementRegistration kTemperatureRegistration({
    .name = "temperature",
    .summary = "Gives the shapes of parts a temperature and an emissivity, for thermal cameras.",
    .notes = "Shapes without one have the temperature of the surroundings, see thermal_surroundings, and emit as black "
             "bodies. The element with the nearest name of a shape takes precedence, then one with a material, over "
             "one of the whole part. What is inserted at a part later belongs to other parts.",
    .attributes = with_selection_rows(kTemperatureRows.table()),
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
std::shared_ptr<const Texture> heat_texture(const ElementContext& context, const std::string& name) {
  const Location where = context.attributes.where("texture");
  const std::filesystem::path file = (context.command.folder / name).lexically_normal();
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
    : desc_(kTemperatureRows.read(context.command, context.attributes)),
      selected_(std::make_shared<SelectedHeat>(SelectedHeat{.element = context.command.require("name").value,
                                                            .shapes = selected_shapes(context, "temperature"),
                                                            .heat = {}})) {
  check_free(context, *selected_);
  if (desc_.has_texture()) selected_->heat.texture = heat_texture(context, desc_.texture);
  context.scene.insert_in_world(context.command, std::make_shared<HeatNode>(selected_));
}

void TemperatureElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  kTemperatureRows.adapt(desc_, live_rows);
}

void TemperatureElement::update(ParameterView values) {
  kTemperatureRows.set(desc_, values);
  SurfaceHeat& heat = selected_->heat;
  heat.temperature_k = desc_.temperature_k;
  heat.emissivity = desc_.emissivity;
  heat.white_k = desc_.white_k;
}

}  // namespace simvis

// An element in a plug-in library: a square plate perpendicular to the x axis.
//
//     <element type="plate" name="PLATE" insert_at="ROOT" x="3" size="2"/>
//
// Parameter  x: where it stands, in metres. Its size cannot change while the scene runs.
#include <simvis/element.h>

namespace simvis {
namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "x", .default_value = "1", .unit = "m", .text = "where the plate stands", .live = true},
    {.name = "size", .default_value = "1", .unit = "m", .text = "length of its edges", .min = 0, .open_min = true},
};

std::shared_ptr<const Mesh> square(float size_m) {
  auto mesh = std::make_shared<Mesh>();
  mesh->name = "plate";
  const float h = size_m / 2;
  mesh->positions = {{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}};
  mesh->attributes.assign(4, {.normal = {-1, 0, 0}});
  mesh->indices = {0, 2, 1, 0, 3, 2};
  compute_bounds(*mesh);
  return mesh;
}

class Plate : public Element {
 public:
  explicit Plate(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
    auto material = std::make_shared<Material>();
    material->double_sided = true;
    auto group = std::make_shared<Separator>();
    group->add(transform_);
    group->add(std::make_shared<MaterialNode>(material));
    group->add(std::make_shared<Shape>(square(static_cast<float>(context.attributes.number("size")))));
    context.scene.insert(context.command, group);
  }

  void update(ParameterView values) override {
    glm::dmat4 matrix{1.0};
    matrix[3][0] = values[0];
    transform_->set_matrix(matrix);
  }

 private:
  std::shared_ptr<Transform> transform_;
};

const ElementRegistration kRegistration({
    .name = "plate",
    .summary = "a square plate across the x axis",
    .attributes = kAttributes,
    .create = create_element<Plate>,
});

}  // namespace
}  // namespace simvis

#include "python/core/written_elements.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/type_ptr.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include "python/core/arguments.h"
#include "python/core/errors.h"
#include "python/core/written_type.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

/// Never destroyed: the registry refers to the types for the rest of the program.
WrittenTypes& element_classes() {
  static auto* const all = new WrittenTypes;
  return *all;
}

/// A transform that an element inserted.
struct InsertedTransform {
  std::shared_ptr<Transform> node;
};

const ElementContext& element_context(const CreationContext& creation) {
  if (creation.element != nullptr) return *creation.element;
  throw InputError("this belongs into the __init__() of an element");
}

InsertedTransform insert_transform(const CreationContext& creation) {
  const ElementContext& context = element_context(creation);
  InsertedTransform transform{std::make_shared<Transform>()};
  context.scene.insert(context.command, transform.node);
  return transform;
}

using Positions = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Triangles = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

InsertedTransform insert_mesh(const CreationContext& creation, const Positions& positions, const Triangles& triangles,
                              const std::vector<float>& color) {
  const ElementContext& context = element_context(creation);
  if (color.size() != 3) throw InputError("color has " + std::to_string(color.size()) + " numbers, expected 3");
  auto mesh = std::make_shared<Mesh>();
  mesh->name = creation.name;
  for (std::size_t i = 0; i < positions.shape(0); ++i) {
    const glm::vec3 position(positions(i, 0), positions(i, 1), positions(i, 2));
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(position[axis])) throw InputError("positions: vertex " + std::to_string(i) + " is not finite");
    }
    mesh->positions.push_back(position);
  }
  mesh->attributes.resize(mesh->positions.size());
  for (std::size_t i = 0; i < triangles.shape(0); ++i) {
    glm::vec3 corners[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = triangles(i, c);
      if (vertex >= mesh->positions.size()) {
        throw InputError("triangles: vertex " + std::to_string(vertex) + " of triangle " + std::to_string(i) +
                         " does not exist, expected less than " + std::to_string(mesh->positions.size()));
      }
      mesh->indices.push_back(vertex);
      corners[c] = mesh->positions[vertex];
    }
    const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    for (std::size_t c = 0; c < 3; ++c) mesh->attributes[triangles(i, c)].normal += normal;
  }
  for (auto& attributes : mesh->attributes) {
    const float length = glm::length(attributes.normal);
    attributes.normal = length > 0 ? attributes.normal / length : glm::vec3(0, 0, 1);
  }
  if (mesh->indices.empty()) throw InputError("triangles: there are none, expected at least one");
  compute_bounds(*mesh);
  auto material = std::make_shared<Material>();
  material->base_color = glm::vec4(color[0], color[1], color[2], 1);
  material->double_sided = true;
  InsertedTransform transform{std::make_shared<Transform>()};
  auto group = std::make_shared<Separator>();
  group->add(transform.node);
  group->add(std::make_shared<MaterialNode>(material));
  group->add(std::make_shared<Shape>(mesh));
  context.scene.insert(context.command, group);
  return transform;
}

void set_matrix(const InsertedTransform& transform, const Matrix& rows) {
  require_scene_change();
  const glm::dmat4 matrix = to_matrix(rows);
  const double* const numbers = glm::value_ptr(matrix);
  if (!std::all_of(numbers, numbers + 16, [](double number) { return std::isfinite(number); })) {
    throw InputError("the matrix has a number that is not finite");
  }
  transform.node->set_matrix(matrix);
}

void set_pose(const InsertedTransform& transform, double x, double y, double z, double roll, double pitch, double yaw) {
  require_scene_change();
  for (const double value : {x, y, z, roll, pitch, yaw}) {
    if (!std::isfinite(value)) throw InputError("the pose has a number that is not finite");
  }
  transform.node->set_matrix(matrix_from_degrees({x, y, z}, roll, pitch, yaw));
}

class WrittenElement : public Element {
 public:
  WrittenElement(const WrittenType& type, nb::object object) : type_(type), object_(std::move(object)) {}

  void update(ParameterView values) override {
    const nb::gil_scoped_acquire locked;
    const SceneChange change;
    try {
      nb::dict named;
      for (std::size_t i = 0; i < values.size(); ++i) {
        named[nb::str(type_.live[i].data(), type_.live[i].size())] = values[i];
      }
      (*object_).attr("update")(named);
    } catch (nb::python_error& error) {
      keep_error(std::move(error));
    }
  }

 private:
  const WrittenType& type_;
  Owned object_;
};

std::unique_ptr<Element> create_element(const ElementContext& context) {
  const nb::gil_scoped_acquire locked;  // of the map too
  const WrittenType& type = *element_classes().at(context.command.require("type").value);
  CreationContext creation{context.command.require("name").value, values_of(context.attributes, type.rows), &context};
  return std::make_unique<WrittenElement>(type, make_object(type, creation, context.command));
}

void register_element(const nb::object& python_class, const std::string& name, const std::string& summary,
                      const nb::object& rows) {
  std::unique_ptr<WrittenType> type = describe_type(python_class, name, summary, rows);
  const WrittenType* const kept = keep_type(element_classes(), std::move(type), find_element_type(name) != nullptr);
  if (kept == nullptr) return;
  const ElementRegistration registration(
      {.name = kept->name, .summary = kept->summary, .attributes = kept->rows, .create = create_element});
}

}  // namespace

void bind_written_elements(nb::module_& module) {
  nb::class_<CreationContext>(module, "Context",
                              "What the constructor of an element or a sensor gets. Valid during the call.")
      .def_ro("name", &CreationContext::name, "The name in the scene.")
      .def_ro("attributes", &CreationContext::attributes,
              "The values of the table's rows; None where a row is not set.",
              nb::sig("def attributes(self) -> dict[str, typing.Any]"))
      .def("insert_transform", &insert_transform,
           "Inserts a transform at the insertion point; it moves what follows. Elements only.")
      .def(
          "insert_mesh", &insert_mesh, "positions"_a, "triangles"_a, "color"_a = std::vector<float>{0.8f, 0.8f, 0.8f},
          "Inserts a mesh: positions (n, 3) float32 in metres, triangles (m, 3) uint32, linear colour. Elements only.");
  nb::class_<InsertedTransform>(module, "Transform",
                                "A transform in the scene. It can be set in __init__() and update() only.")
      .def("set_matrix", &set_matrix, "matrix"_a, "(4, 4) float64, parent_from_child.")
      .def("set_pose", &set_pose, "x"_a = 0.0, "y"_a = 0.0, "z"_a = 0.0, "roll"_a = 0.0, "pitch"_a = 0.0, "yaw"_a = 0.0,
           "Metres and degrees: R = Rz(yaw) Ry(pitch) Rx(roll).");
  module.def("register_element", &register_element);
}

}  // namespace simvis::python

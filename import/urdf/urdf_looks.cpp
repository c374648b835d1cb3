#include "import/urdf/urdf_looks.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>

namespace simvis {
namespace {

// Half of the largest value of each colour, as sRGB.
constexpr glm::dvec4 kGrey{0.5, 0.5, 0.5, 1};

bool is_definition(const UrdfElement& material) {
  return material.child("color").has("rgba") || material.child("texture").has("filename");
}

// A colour, and what it is in place of the one that is written; empty: it is as written.
struct ReadColor {
  glm::dvec4 color;
  std::string instead{};
};
ReadColor read_color(const UrdfElement& color) {
  std::array<double, 4> rgba{0, 0, 0, 1};
  const bool has_alpha = color.parse("rgba", rgba);
  const bool is_color = has_alpha || color.parse("rgba", std::span(rgba).first(3));
  const bool is_in_range = std::ranges::all_of(rgba, [](double value) { return value >= 0 && value <= 1; });
  if (!is_color || !is_in_range) return {kGrey, "shown grey"};
  return {{rgba[0], rgba[1], rgba[2], rgba[3]}, has_alpha ? "" : "opaque"};
}

std::string reason_to_leave_out(const UrdfElement& written, const ModelShape& shape) {
  const bool is_mesh = shape.kind == ModelShape::Kind::mesh;
  for (int i = 0; i < 3; ++i) {
    if (is_mesh ? shape.size[i] == 0 : shape.size[i] <= 0) {
      return "has a " + std::string(written.tag()) + " whose size is not above 0";
    }
  }
  return is_mesh && written.text("filename").empty() ? "has a mesh without a filename" : "";
}

}  // namespace

UrdfLooks::UrdfLooks(const UrdfElement& robot, std::vector<std::string>& warnings) : warnings_(warnings) {
  for (const UrdfElement& each : robot.children("material")) add_definition(each);
  for (const UrdfElement& link : robot.children("link")) {
    for (const UrdfElement& visual : link.children("visual")) add_definition(visual.child("material"));
  }
}

void UrdfLooks::add_definition(const UrdfElement& material) {
  if (!is_definition(material) || material.name().empty()) return;
  const UrdfMaterial read = read_definition(material);
  const auto [first, is_new] = definitions_.emplace(read.name, read);
  if (!is_new && first->second != read) {
    warn(material, material, "is defined again in another way; the first definition counts");
  }
}

UrdfMaterial UrdfLooks::read_definition(const UrdfElement& material) {
  UrdfMaterial read{.name = material.name(), .texture = material.child("texture").text("filename")};
  const UrdfElement color = material.child("color");
  if (!color.has("rgba")) return read;
  const ReadColor found = read_color(color);
  read.color = found.color;
  if (!found.instead.empty()) {
    warn(color, material,
         "has rgba " + in_quotes(color.text("rgba")) + ", expected four numbers from 0 to 1; it is " + found.instead);
  }
  return read;
}

std::vector<UrdfVisual> UrdfLooks::visuals(const UrdfElement& link) {
  std::vector<UrdfVisual> all;
  for (const UrdfElement& each : link.children("visual")) {
    if (std::optional<UrdfVisual> read = visual(each, link)) all.push_back(*std::move(read));
  }
  return all;
}

std::optional<UrdfVisual> UrdfLooks::visual(const UrdfElement& element, const UrdfElement& link) {
  const auto leave_out = [&](const std::string& why) {
    warn(element, link, why + "; the visual is left out");
    return std::nullopt;
  };
  const UrdfElement shape = element.child("geometry").first_child();
  const std::string_view kind = shape.tag();
  if (kind.empty()) return leave_out("has a visual without a geometry");
  constexpr std::string_view kKinds[] = {"box", "cylinder", "capsule", "sphere", "mesh"};
  if (std::ranges::count(kKinds, kind) == 0) {
    return leave_out("has a visual of kind " + in_quotes(kind) + ", expected box, cylinder, capsule, sphere or mesh");
  }
  UrdfVisual read{.name = element.name(), .shape = read_urdf_shape(element), .mesh = {}, .material = {}};
  const std::string why = reason_to_leave_out(shape, read.shape);
  if (!why.empty()) return leave_out(why);
  if (kind == "mesh") read.mesh = shape.text("filename");
  if (kind == "mesh" && has_one_scale(shape)) {
    warn(element, link,
         "has a mesh whose scale is the one number " + format_number(read.shape.size.x) +
             "; it is taken for all three axes");
  }
  read.material = material(element, link);
  return read;
}

std::optional<UrdfMaterial> UrdfLooks::material(const UrdfElement& visual, const UrdfElement& link) {
  const UrdfElement written = visual.child("material");
  if (written.name().empty()) return is_definition(written) ? std::optional(read_definition(written)) : std::nullopt;
  const auto [known, is_new] = definitions_.try_emplace(written.name(), UrdfMaterial{written.name(), kGrey, {}});
  if (is_new) {
    warn(written, link, "has the material " + in_quotes(written.name()) + ", which is not defined; it is shown grey");
  }
  return known->second;
}

void UrdfLooks::warn(const UrdfElement& where, const UrdfElement& owner, const std::string& what) {
  warnings_.push_back(to_string(where.where()) + ": " + owner.says(what));
}

}  // namespace simvis

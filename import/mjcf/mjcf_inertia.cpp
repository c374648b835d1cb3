#include "import/mjcf/mjcf_inertia.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_geoms.h"
#include "import/mjcf/mjcf_solid.h"
#include "scenegraph/height_map.h"

namespace simvis {
namespace {

constexpr double kWater_kg_m3 = 1000;  // MuJoCo's default density

std::string compiler_text(const MjcfModel& model, const char* name, const std::string& fallback) {
  std::string text = fallback;
  for (const MjcfElement& compiler : model.sections("compiler")) text = compiler.written(name).value_or(text);
  return text;
}

// 32 bits; MuJoCo's default is the lowest one.
std::uint32_t read_mask(const MjcfElement& element, const char* name) {
  const std::optional<std::string> text = element.find(name);
  if (!text) return 1;
  if (const std::optional<std::uint32_t> mask = parse_bitmask(*text)) return *mask;
  element.fail("has " + std::string(name) + " " + in_quotes(*text) + ", expected " + std::string(kBitmaskExpected));
}

}  // namespace

std::optional<ModelInertial> read_mjcf_inertial(const MjcfBody& body) {
  const std::string from_geoms = compiler_text(body.element.model(), "inertiafromgeom", "auto");
  if (body.inertials.empty() || from_geoms == "true") return std::nullopt;
  const MjcfElement& element = body.inertials.front();
  ModelInertial inertial{.mass_kg = element.number("mass", 0), .link_from_inertia = mjcf_pose(element)};
  if (inertial.mass_kg < 0) element.fail("has a mass below 0");
  const std::vector<double> own = element.numbers("diaginertia", 3, 3), full = element.numbers("fullinertia", 6, 6);
  if (!full.empty()) {
    inertial.inertia_kg_m2 = {{full[0], full[3], full[4]}, {full[3], full[1], full[5]}, {full[4], full[5], full[2]}};
  } else if (!own.empty()) {
    for (int i = 0; i < 3; ++i) inertial.inertia_kg_m2[i][i] = own[static_cast<std::size_t>(i)];
  }
  return inertial;
}

// MuJoCo puts the mass of an empty body where the body's own place would be in the body's frame.
std::optional<ModelMassBounds> read_mjcf_mass_bounds(const MjcfBody& body) {
  ModelMassBounds bounds{.center_of_empty_m = glm::dvec3(body.parent_from_body[3])};
  for (const MjcfElement& compiler : body.element.model().sections("compiler")) {
    bounds.min_mass_kg = compiler.number("boundmass", bounds.min_mass_kg);
    bounds.min_moment_kg_m2 = compiler.number("boundinertia", bounds.min_moment_kg_m2);
    const std::string balances = compiler.text("balanceinertia", bounds.balances_moments ? "true" : "false");
    bounds.balances_moments = balances == "true";
    if (balances != "true" && balances != "false") {
      compiler.fail("has balanceinertia " + in_quotes(balances) + ", expected \"true\" or \"false\"");
    }
  }
  if (!(bounds.min_mass_kg > 0) && !(bounds.min_moment_kg_m2 > 0) && !bounds.balances_moments) return std::nullopt;
  return bounds;
}

MjcfShapes::MjcfShapes(const MjcfModel& model, MjcfAssets& assets, ImportReport& report)
    : assets_(assets), report_(report) {
  for (const MjcfElement& compiler : model.sections("compiler")) {
    if (const auto range = compiler.numbers("inertiagrouprange", 2, 2); !range.empty()) {
      first_group_ = range[0];
      last_group_ = range[1];
    }
  }
}

bool MjcfShapes::read_shape(const MjcfGeom& geom, ModelShape& shape) {
  const MjcfElement& element = geom.element;
  try {
    shape.link_from_shape = geom.body_from_frame * mjcf_geom_pose(element);
    const std::string type = element.text("type", "sphere");
    if (type == "mesh") {
      const MjcfMesh& mesh = assets_.mesh(element);
      if (mesh.shapes == nullptr) element.fail("has a mesh that cannot be read: " + mesh.error);
      shape.kind = ModelShape::Kind::nodes;
      shape.nodes = mesh.shapes;
      return true;
    }
    if (type == "hfield") {
      shape.kind = ModelShape::Kind::surface;
      const MjcfHeights& heights = assets_.heights(element);
      shape.surface = std::make_shared<const Mesh>(mesh_in_place({*heights.mesh, heights.place}));
      return true;
    }
    if (element.find("mesh")) element.fail("is a " + type + " that is fitted to a mesh, which is not taken over");
    if (type == "plane") {
      shape.kind = ModelShape::Kind::plane;
      return true;
    }
    read_mjcf_solid(element, type, shape);
    return true;
  } catch (const InputError& error) {
    report_.warn(without_word_error(error.what()) + "; physics leaves the geom out");
    return false;
  }
}

void MjcfShapes::add_solid(const MjcfGeom& geom, ModelLink& link) {
  const double group = geom.element.number("group", 0);
  if (group < first_group_ || group > last_group_) return;
  ModelSolid solid;
  solid.where = geom.element.at();
  const auto mass = geom.element.numbers("mass", 1, 1);
  if (!mass.empty()) solid.mass_kg = mass[0];
  solid.density_kg_m3 = geom.element.number("density", kWater_kg_m3);
  if (solid.mass_kg.value_or(0) < 0 || solid.density_kg_m3 < 0) geom.element.fail("has a mass or density below 0");
  if (geom.element.text("type", "sphere") == "hfield") return;
  const bool has_mass = solid.mass_kg ? *solid.mass_kg > 0 : solid.density_kg_m3 > 0;
  if (has_mass && read_shape(geom, solid)) link.solids.push_back(std::move(solid));
}

void MjcfShapes::add_collision(const MjcfGeom& geom, ModelLink& link) {
  const MjcfElement& element = geom.element;
  ModelCollision collision;
  collision.mask = {.category = read_mask(element, "contype"), .collides = read_mask(element, "conaffinity")};
  if (collision.mask.category == 0 && collision.mask.collides == 0) return;
  collision.where = element.at();
  if (!read_shape(geom, collision)) return;
  const std::vector<double> friction = element.numbers("friction", 1, 3);
  collision.friction = friction.empty() ? 1 : friction[0];
  if (*collision.friction < 0) element.fail("has a friction below 0");
  // A pair slides freely only if both geoms have the condim 1.
  if (element.number("condim", 3) == 1) collision.friction = 0;
  collision.larger_friction = true;
  if (element.number("condim", 3) > 3) report_.leave_out("friction against turning and rolling", element.at());
  for (const char* const soft : {"solref", "solimp", "margin", "gap", "priority", "solmix"}) {
    if (element.find(soft)) report_.leave_out("\"" + std::string(soft) + "\" of a geom", element.at());
  }
  link.collisions.push_back(std::move(collision));
}

}  // namespace simvis

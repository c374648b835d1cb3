#include "elements/dynamics/models.h"

#include <algorithm>
#include <utility>

#include "dynamics/mass.h"
#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/model_part.h"

namespace simvis {
namespace {

// SDF's own.
constexpr AttributeSpec kModelFrictionRow{.name = kFrictionRow.name,
                                          .default_value = "1",
                                          .text = "as that of a body; default: what the file says, else 1",
                                          .min = kFrictionRow.min,
                                          .max = kFrictionRow.max};
constexpr AttributeSpec kModelRestitutionRow{.name = kRestitutionRow.name,
                                             .default_value = "0",
                                             .text = "as that of a body; default: what the file says, else 0",
                                             .min = kRestitutionRow.min,
                                             .max = kRestitutionRow.max};
constexpr AttributeSpec kModelsRows[] = {kModelFrictionRow, kModelRestitutionRow};

const ElementRegistration kModelsRegistration({
    .name = "models",
    .summary = "Gives the models of an SDF world masses, collisions and joints.",
    .notes =
        "An element physics stands before it. Static models stand; others move as forces say. Joints have springs, "
        "damping, friction and limits, and no drives: an element robot drives those of a part with one model. "
        "Each body that nothing holds has parameters x_LINK to yaw_LINK, after the insertion point of its first "
        "link. The physics writes them and the values of the elements joint; a value that is set puts body or "
        "joint there, at rest.",
    .attributes = kModelsRows,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<ModelsElement>(context);
    },
});

MeshCollision collision_of(const SdfBody& body) {
  const auto is_fixed = [](const UrdfMovingJoint& joint) { return joint.kind == UrdfMovingJoint::Kind::fixed; };
  const bool moves = !body.stands || !std::ranges::all_of(body.model.joints, is_fixed);
  return moves ? MeshCollision::hull : MeshCollision::triangles;
}

void require_mass(const SdfBody& body, const RobotDescription& description) {
  const MassProperties& mass = description.body.mass;
  if (body.stands || (mass.mass_kg > 0 && is_possible(principal_inertia(mass.inertia_kg_m2)))) return;
  const UrdfMovedLink& link = body.model.links.front();
  fail_at(link.where, "link " + in_quotes(link.name) + " moves and has " +
                          (mass.mass_kg > 0 ? "an inertia that no body has" : "no mass") +
                          ", expected <inertial> with a mass and moments above 0 of which none is above the sum of the "
                          "two others, or a static model");
}

const std::string& first_link_of(const SdfBody& body) { return body.model.links[body.point.empty() ? 1 : 0].name; }

// Bodies that a joint holds at the world stand at one point, that of the part, but have names of their own.
Command command_of_body(const ElementContext& context, const std::string& link, const std::string& point,
                        bool is_free) {
  Command command;
  command.kind = CommandKind::element;
  command.where = context.command.where;
  command.folder = context.command.folder;
  const auto add = [&](const char* name, std::string value) {
    command.attributes.push_back({name, std::move(value), context.command.where});
  };
  add("type", "robot");
  add("name", context.command.require("name").value + "/" + link);
  add("insert_at", point);
  add("control", "none");
  add("base", is_free ? "free" : "fixed");
  return command;
}

}  // namespace

ModelsElement::ModelsElement(const ElementContext& context) {
  const ModelPart part = read_model_part(context, context.command.require("insert_at"), false);
  const SdfBodies sdf = read_sdf_bodies(part.request);
  for (const std::string& warning : sdf.warnings) context.scene.warn(warning);
  const RobotSurface surface = read_robot_surface(context);
  CollisionMeshes meshes(context.scene.pool());
  for (const SdfBody& body : sdf.bodies) {
    RobotDescription description =
        describe_robot(body.model, {.surface = surface, .collision = collision_of(body)}, meshes);
    require_mass(body, description);
    add(context, body, std::move(description), part.prefix);
  }
}

void ModelsElement::add(const ElementContext& context, const SdfBody& body, RobotDescription description,
                        const std::string& prefix) {
  const std::string point = body.point.empty() ? context.command.require("insert_at").value : prefix + body.point;
  const Command command = command_of_body(context, first_link_of(body), point, !body.stands);
  const AttributeValues attributes(command, find_element_type("robot")->attributes, kElementCommonAttributes);
  description.has_weight = body.has_weight;
  bodies_.push_back(std::make_unique<RobotElement>(
      ElementContext{
          .command = command, .attributes = attributes, .scene = context.scene, .find_element = context.find_element},
      std::move(description), prefix));
  if (body.stands) return;
  free_.push_back(bodies_.back().get());
  for (AttributeSpec row : kPoseRows) {
    row.name = row_names_.emplace_back(std::string(row.name) + "_" + body.point);
    rows_.push_back(row);
  }
}

void ModelsElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  live_rows.insert(live_rows.end(), rows_.begin(), rows_.end());
}

void ModelsElement::update(ParameterView values) {
  for (std::size_t i = 0; i < free_.size(); ++i) free_[i]->update(values.subspan(i * kPoseValues, kPoseValues));
}

void ModelsElement::advance(std::int64_t time_ns, std::span<double> values) {
  for (std::size_t i = 0; i < free_.size(); ++i) {
    free_[i]->advance(time_ns, values.subspan(i * kPoseValues, kPoseValues));
  }
}

}  // namespace simvis

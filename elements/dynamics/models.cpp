// The element `models`: the bodies of an SDF, MJCF or URDF file stand, fall and swing as physics says.
//
//   <element type="models" name="BODIES" insert_at="WORLD"/>
//
// Parameters  x_LINK y_LINK z_LINK (m), roll_LINK pitch_LINK yaw_LINK (deg), all live: what moves a body that nothing
//             holds, from its place in the file. LINK is the insertion point of its first link. The physics writes
//             them, and the values of the elements `joint` behind; a value that is set puts the body there, at rest.
//             Behind them target_JOINT, as of an element `robot`, for joints that the file's actuators drive.
#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>
#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/model_part.h"
#include "elements/dynamics/robot.h"
#include "engine/base/assert.h"
#include "import/model/model_description.h"

namespace simvis {
namespace {

class ModelsElement : public Element, public Stateful {
 public:
  /// Throws InputError: no physics; the part has no links or is scaled; what its format and robot_description.h say;
  /// a body that moves and has no mass.
  explicit ModelsElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return !bodies_.empty(); }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    for (const Body& body : bodies_) body.robot->archive(state);
  }

 private:
  struct Body {
    std::unique_ptr<RobotElement> robot;
    bool is_free = false;          // the first rows are those of its pose
    std::size_t rows = 0;          // of this body
    std::vector<double> values{};  // as RobotElement has them: the pose always stands in front
  };
  void add(const ElementContext& context, const ModelBody& body, RobotDescription description,
           const std::string& prefix);
  void constrain(const ElementContext& context, const ModelDescription& file);
  void keep_apart(const ElementContext& context, const ModelContacts& contacts);
  struct FoundLink {
    RobotElement* robot = nullptr;  // null: no body has it
    int link = -1, part = 0;
    glm::dmat4 link_from_part{1.0};
  };
  FoundLink find_link(const std::string& name) const;

  std::vector<Body> bodies_;
  std::vector<AttributeSpec> rows_;    // of all bodies
  std::deque<std::string> row_names_;  // of poses in rows_
};

// SDF's own.
constexpr AttributeSpec kModelFrictionRow{.name = kFrictionName,
                                          .default_value = "1",
                                          .text = "as that of a body; default: what the file says, else 1",
                                          .min = kFrictionLimits.min,
                                          .max = kFrictionLimits.max};
constexpr AttributeSpec kModelRestitutionRow{.name = kRestitutionName,
                                             .default_value = "0",
                                             .text = "as that of a body; default: what the file says, else 0",
                                             .min = kRestitutionLimits.min,
                                             .max = kRestitutionLimits.max};
constexpr AttributeSpec kModelsRows[] = {kModelFrictionRow, kModelRestitutionRow, kCategoryBitmaskRow,
                                         kCollideBitmaskRow, kSrdfRow};

const ElementRegistration kModelsRegistration({
    .name = "models",
    .summary = "Gives the bodies of an SDF, MJCF or URDF file masses, collisions and joints.",
    .notes = "Needs an element physics before it in the scene. Static models stand; others move as forces say. Joints "
             "have springs, damping, friction and limits, and the drives that an MJCF file says, with parameters "
             "target_JOINT: an element robot drives those of a part with one SDF or URDF model. Each body that nothing "
             "holds has parameters x_LINK to yaw_LINK, after the insertion point of its first link. The physics writes "
             "them and the values of the elements joint; a value that is set puts body or joint there, at rest.",
    .attributes = kModelsRows,
    .create = create_element<ModelsElement>,
});

MeshCollision collision_of(const ModelBody& body) {
  const auto is_fixed = [](const ModelJoint& joint) { return joint.kind == ModelJoint::Kind::fixed; };
  const bool moves = !body.is_static && (!body.stands() || !std::ranges::all_of(body.model.joints, is_fixed));
  return moves ? MeshCollision::hull : MeshCollision::triangles;
}

const std::string& first_link_of(const ModelBody& body) {
  return body.model.links[body.is_held && body.model.links.size() > 1 ? 1 : 0].name;
}

// Bodies that a joint holds at the world stand at one point, that of the part, but have names of their own.
Command command_of_body(const ElementContext& context, const std::string& link, const std::string& point, bool is_free,
                        bool has_drives) {
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
  add("control", has_drives ? "file" : "none");
  add("base", is_free ? "free" : "fixed");
  return command;
}

}  // namespace

ModelsElement::ModelsElement(const ElementContext& context) {
  const ModelPart part = find_model_part(context, context.command.require("insert_at"), "the models of a file");
  const ModelDescription& file = part.source.description(context.scene.pool());
  for (const std::string& warning : file.warnings) context.scene.warn(warning);
  const ModelContacts contacts = read_link_contacts(context, file);
  const RobotSurface surface = read_robot_surface(context);
  CollisionMeshes meshes(file.meshes, context.scene.pool());
  std::vector<RobotDescription> descriptions;
  for (const ModelBody& body : file.bodies) {
    RobotDescription& description = descriptions.emplace_back(describe_robot(context.scene, body.model,
                                                                             {.surface = surface,
                                                                              .collision = collision_of(body),
                                                                              .is_static = body.is_static,
                                                                              .base_moves = !body.stands()},
                                                                             meshes));
    description.has_drives = file.has_drives;
    set_link_contacts(contacts, description);
  }
  if (file.total_mass_kg) set_total_mass(descriptions, *file.total_mass_kg);
  for (std::size_t i = 0; i < descriptions.size(); ++i) {
    add(context, file.bodies[i], std::move(descriptions[i]), part.prefix);
  }
  constrain(context, file);
  keep_apart(context, contacts);
}

void ModelsElement::add(const ElementContext& context, const ModelBody& body, RobotDescription description,
                        const std::string& prefix) {
  const std::string point = body.point.empty() ? context.command.require("insert_at").value : prefix + body.point;
  const Command command = command_of_body(context, first_link_of(body), point, !body.stands(), description.has_drives);
  const AttributeValues attributes(command, find_element_type("robot")->attributes, kElementCommonAttributes);
  description.has_weight = body.has_weight;
  Body own{.robot = std::make_unique<RobotElement>(ElementContext{.command = command,
                                                                  .attributes = attributes,
                                                                  .scene = context.scene,
                                                                  .find_element = context.find_element,
                                                                  .seed = context.seed},
                                                   std::move(description), prefix),
           .is_free = !body.stands()};
  own.robot->set_carrier(body.carrier.empty() ? "" : prefix + body.carrier);
  const std::size_t before = rows_.size();
  if (own.is_free) {
    for (AttributeSpec row : kPoseRows) {
      row.name = row_names_.emplace_back(std::string(row.name) + "_" + body.point);
      rows_.push_back(row);
    }
  }
  own.robot->adapt_parameters(rows_);
  own.rows = rows_.size() - before;
  own.values.resize(own.rows + (own.is_free ? 0 : kPoseValues));
  bodies_.push_back(std::move(own));
}

ModelsElement::FoundLink ModelsElement::find_link(const std::string& name) const {
  for (const Body& body : bodies_) {
    if (const auto* const link = body.robot->find_link(name)) {
      return {body.robot.get(), link->link, body.robot->part_of(*link), link->link_from_part};
    }
  }
  return {};
}

void ModelsElement::constrain(const ElementContext& context, const ModelDescription& file) {
  for (const ModelConstraint& each : file.constraints) {
    const FoundLink a = find_link(each.a), b = each.b.empty() ? FoundLink() : find_link(each.b);
    SIMVIS_ASSERT(a.robot != nullptr && (each.b.empty() || b.robot != nullptr));
    if (a.robot == b.robot && a.link == b.link) continue;  // fixed joints hold them already
    DynamicConstraint made{.a = &a.robot->object(), .desc = {}};
    made.desc.kind =
        each.kind == ModelConstraint::Kind::point ? ConstraintDesc::Kind::point : ConstraintDesc::Kind::fixed;
    made.desc.a.link = a.link;
    made.desc.a_from_joint = a.link_from_part * each.a_from_joint;
    made.desc.b_from_joint = b.link_from_part * each.b_from_joint;
    a.robot->require_articulation();
    if (b.robot != nullptr) {
      made.b = &b.robot->object();
      made.desc.b = WorldLink{0, b.link};
      b.robot->require_articulation();
    }
    find_dynamic_scene(context)->add(made);
  }
}

// Pairs of links of one body are part of its description.
void ModelsElement::keep_apart(const ElementContext& context, const ModelContacts& contacts) {
  for (const ModelPair& pair : contacts.apart) {
    const FoundLink a = find_link(pair.a), b = find_link(pair.b);
    if (a.robot == nullptr || b.robot == nullptr || a.robot == b.robot) continue;
    find_dynamic_scene(context)->keep_apart({&a.robot->object(), a.part, &b.robot->object(), b.part});
  }
}

void ModelsElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  live_rows.insert(live_rows.end(), rows_.begin(), rows_.end());
}

void ModelsElement::update(ParameterView values) {
  std::size_t first = 0;
  for (Body& body : bodies_) {
    std::ranges::copy(values.subspan(first, body.rows), body.values.end() - static_cast<std::ptrdiff_t>(body.rows));
    body.robot->update(body.values);
    first += body.rows;
  }
}

void ModelsElement::advance(std::int64_t time_ns, std::span<double> values) {
  std::size_t first = 0;
  for (Body& body : bodies_) {
    if (body.is_free) body.robot->advance(time_ns, values.subspan(first, kPoseValues));
    first += body.rows;
  }
}

}  // namespace simvis

// Imports SDF worlds and models as parts: models and links become insertion points and visuals; joints, lights and
// sensors become commands.
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/node.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/model/model_frames.h"
#include "import/sdf/sdf_commands.h"
#include "import/sdf/sdf_document.h"
#include "import/sdf/sdf_dynamics.h"
#include "import/sdf/sdf_joints.h"
#include "import/sdf/sdf_labels.h"
#include "import/sdf/sdf_messages.h"
#include "import/sdf/sdf_readings.h"
#include "import/sdf/sdf_visuals.h"

namespace simvis {
namespace {

class SdfImport {
 public:
  SdfImport(const ImportRequest& request, ContentPool& pool)
      : request_(request),
        document_(std::make_shared<SdfDocument>(request)),
        visuals_(request, files_, *document_->meshes, report_,
                 request.up_given && request.up == UpAxis::y ? MeshFileAxes::y_up : MeshFileAxes::as_written, pool) {}

  PartContent run() {
    SdfReader(sdf_, files_, report_).read(request_.file);
    const ModelFence fence(request_.file);
    for (const auto& item : sdf_.world.items) name_models(*item, "");
    tree_ = make_sdf_tree(sdf_, poses_, names_, report_);
    read_sdf_joints(tree_, poses_, report_);
    std::set<std::string> points;
    for (const auto& link : tree_.links) points.insert(link->point);
    messages_ = SdfMessages(std::move(points));
    for (const auto& item : sdf_.world.items) add_model(sdf_.world, *item, 0);
    add_world_commands();
    visuals_.shown().require(sdf_.is_single_model);
    PartContent content;
    content.root = frames_.nodes();
    content.model = std::make_shared<SdfSource>(document_);
    content.commands = frames_.joint_commands(content.warnings);
    for (std::vector<std::string>* more : {&lights_, &sensors_, &labels_}) {
      std::move(more->begin(), more->end(), std::back_inserter(content.commands));
    }
    std::ranges::move(report_.release(), std::back_inserter(content.warnings));
    if (std::optional<std::string> outside = visuals_.shown().outside_warning()) {
      content.warnings.push_back(std::move(*outside));
    }
    for (std::string& warning : files_.release_warnings()) content.warnings.push_back(std::move(warning));
    for (const auto& file : sdf_.files) {
      for (std::string& warning : file->packages.release_warnings()) content.warnings.push_back(std::move(warning));
    }
    return content;
  }

 private:
  // The names of models come first, so that a link never takes one.
  void name_models(SdfItem& item, const std::string& prefix) {
    if (item.scope == nullptr) return;
    const bool is_single = sdf_.is_single_model && item.scope->outer == &sdf_.world;
    const bool is_named = !is_single && !item.scope->is_merged;
    if (is_named) model_points_[&item] = names_.point(prefix + item.name);
    const std::string inner = is_named ? prefix + item.name + "/" : prefix;
    for (const auto& each : item.scope->items) name_models(*each, inner);
  }

  void add_model(SdfScope& outer, SdfItem& model, std::size_t parent) {
    if (model.scope == nullptr) return;
    SdfScope& scope = *model.scope;
    ModelStep step{.place = poses_.item(outer, model)};
    if (const auto point = model_points_.find(&model); point != model_points_.end()) {
      step.point = point->second;
      step.object = ObjectKind::model;
    }
    const std::size_t own = frames_.add({.name = model.name, .parent = parent, .steps = {std::move(step)}});
    for (const auto& link : tree_.links) {
      if (link->scope == &scope && link->parent == nullptr) add_links(*link, poses_.scope(scope), own);
    }
    for (const auto& item : scope.items) add_model(scope, *item, own);
  }

  // A link and those that follow it, each within the frame of the one above.
  void add_links(SdfLink& first, const glm::dmat4& world_from_parent, std::size_t parent) {
    struct Pending {
      SdfLink* link;
      glm::dmat4 world_from_parent;
      std::size_t parent;
    };
    std::vector<Pending> open{{&first, world_from_parent, parent}};
    while (!open.empty()) {
      const Pending next = open.back();
      open.pop_back();
      const std::size_t own = add_link(*next.link, next.world_from_parent, next.parent);
      const std::vector<SdfLink*>& followers = next.link->followers;
      for (auto each = followers.rbegin(); each != followers.rend(); ++each) {
        open.push_back({*each, next.link->world_from_link, own});
      }
    }
  }

  // { joint's place, joint's point, link's place, link's point, visuals }, where a point for the joint stands only if
  // its place is not that of the link.
  std::size_t add_link(SdfLink& link, const glm::dmat4& world_from_parent, std::size_t parent) {
    ModelFrame frame{.name = link.item->name, .parent = parent};
    ModelStep step{.point = link.point, .object = ObjectKind::link};
    if (link.joint != nullptr && link.joint_point != link.point) {
      frame.steps.push_back({.place = rigid_inverse(world_from_parent) * link.world_from_joint,
                             .point = link.joint_point,
                             .joint = link.motion});
      step.place = rigid_inverse(link.world_from_joint) * link.world_from_link;
    } else {
      step.place = link.parent == nullptr ? poses_.item(*link.scope, *link.item)
                                          : rigid_inverse(world_from_parent) * link.world_from_link;
      if (link.joint != nullptr) step.joint = link.motion;
    }
    frame.steps.push_back(std::move(step));
    const std::size_t own = frames_.add(std::move(frame));
    add_joint_sensors(link);
    std::set<std::string> visuals;
    for (const SdfElement& child : link.item->element.children()) {
      if (child.tag() != "visual") {
        add_link_content(link, child);
      } else if (NodePtr node =
                     visuals_.make(child, link.item->name, [&] { return sdf_place_in(link, child, poses_); })) {
        visuals.insert(node->name);
        frames_.add_visual(own, std::move(node));
      }
    }
    try_to("label", [&] { add_labels(link, visuals); });
    try_to("visibility of its link", [&] { add_visibility_flags(link, visuals); });
    return own;
  }

  void add_joint_sensors(const SdfLink& link) {
    if (link.joint == nullptr) return;
    const SdfElement& element = link.joint->element;
    const bool is_measured = link.motion->kind != ModelJoint::Kind::fixed && link.motion->leader.empty();
    for (const SdfElement& child : element.children()) {
      if (child.tag() == "sensor") try_to("sensor", [&] { add_joint_sensor(link, child, is_measured); });
    }
  }

  void add_labels(const SdfLink& link, const std::set<std::string>& visuals) {
    if (is_labelled_as_whole(*link.scope)) {
      if (!labelled_.insert(link.scope).second) return;  // by another link of the model
      labels_.push_back(
          sdf_label_command({.number = *link.scope->label}, true, {names_.element(link.point + " class"), link.point}));
      return;
    }
    for (const SdfVisualNumber& label : sdf_link_labels(link.item->element, link.scope->label, visuals, report_)) {
      const std::string of = label.visual.empty() ? link.point : link.point + "/" + label.visual;
      labels_.push_back(sdf_label_command(label, false, {names_.element(of + " class"), link.point}));
    }
  }

  void add_visibility_flags(const SdfLink& link, const std::set<std::string>& visuals) {
    const auto flags_of = [](const SdfElement& visual) { return sdf_visibility_bits(visual, "visibility_flags"); };
    for (const SdfVisualNumber& flags :
         sdf_visual_numbers(link.item->element, visuals, "<visibility_flags>", flags_of, report_)) {
      const std::string of = flags.visual.empty() ? link.point : link.point + "/" + flags.visual;
      labels_.push_back(sdf_visibility_command(flags, {names_.element(of + " flags"), link.point}));
    }
  }

  void add_joint_sensor(const SdfLink& link, const SdfElement& sensor, bool is_measured) {
    if (sensor.attribute("type") != "force_torque" || !is_measured) {
      return report_.leave_out(is_measured ? "sensor of a joint of another type than force_torque"
                                           : "sensor of a joint that has no element joint",
                               sensor.at());
    }
    const SdfPlace place{names_.sensor(link.joint_name, sensor.name()), link.joint_point};
    glm::dmat4 turn = rigid_inverse(link.world_from_joint) * link.world_from_link;
    turn[3] = glm::dvec4(0, 0, 0, 1);
    sensors_.push_back(sdf_force_torque_command(sensor, link.joint_name, place, turn, report_));
  }

  void add_link_content(const SdfLink& link, const SdfElement& child) {
    const std::string_view tag = child.tag();
    if (tag == "light") {
      const SdfPlace place{names_.element(link.prefix + link.item->name + "/" + child.attribute("name")), link.point};
      try_to("light",
             [&] { lights_.push_back(sdf_light_command(child, place, sdf_place_in(link, child, poses_), report_)); });
    } else if (tag == "sensor") {
      try_to("sensor", [&] { add_sensor(link, child); });
    } else {
      report_unread(child, report_);
    }
  }

  void add_sensor(const SdfLink& link, const SdfElement& sensor) {
    const SdfPlace place{names_.sensor(link.prefix + link.item->name, sensor.name()), link.point};
    auto command =
        sdf_sensor_command(sensor, sdf_.first, place, sdf_place_in(link, sensor, poses_), messages_, report_);
    if (command) sensors_.push_back(std::move(*command));
  }

  // An element that is wrong is left out with a warning.
  template <class Action>
  void try_to(const std::string& what, const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      report_.warn(without_word_error(error.what()) + "; the " + what + " is left out");
    }
  }

  void add_world_commands() {
    for (const SdfWorldLight& light : sdf_.lights) {
      const SdfPlace place{names_.element(light.name), ""};
      try_to("light", [&] {
        lights_.push_back(sdf_light_command(light.element, place, poses_.pose(sdf_.world, light.pose, ""), report_));
      });
    }
    if (!sdf_.scene) return;
    try_to("scene", [&] {
      if (auto sky = sdf_sky_command(sdf_.scene, {names_.element("sky"), ""}, report_))
        lights_.push_back(std::move(*sky));
    });
  }

  const ImportRequest& request_;
  ImportReport report_;
  std::shared_ptr<SdfDocument> document_;
  SdfFiles& files_ = document_->files;
  SdfContent& sdf_ = document_->sdf;
  SdfPoses& poses_ = document_->poses;
  SdfNames& names_ = document_->names;
  SdfTree& tree_ = document_->tree;
  SdfVisuals visuals_;
  std::map<const SdfItem*, std::string> model_points_;
  SdfMessages messages_;
  std::set<const SdfScope*> labelled_;  // models as a whole
  ModelFrames frames_{request_.file.stem().string()};
  std::vector<std::string> lights_, sensors_, labels_;
};

PartContent import_sdf(const ImportRequest& request, ContentPool& pool) { return SdfImport(request, pool).run(); }

const PartImporterRegistration sdf_registration({".sdf", ".world"}, import_sdf);

}  // namespace
}  // namespace simvis

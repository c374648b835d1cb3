// Imports MJCF models as parts: bodies and sites become insertion points, geoms shapes, joints element commands.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/node.h>
#include <simvis/part_importer.h>
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_attachments.h"
#include "import/mjcf/mjcf_cameras.h"
#include "import/mjcf/mjcf_dynamics.h"
#include "import/mjcf/mjcf_geoms.h"
#include "import/mjcf/mjcf_joints.h"
#include "import/mjcf/mjcf_lights.h"
#include "import/model/joint_commands.h"
#include "import/model/model_frames.h"
#include "import/model/unique_names.h"

namespace simvis {
namespace {

constexpr int kMaxReplicates = 100'000;  // of a model
constexpr std::size_t kMaxAttachments = 10'000;
constexpr std::size_t kMaxContent = 1'000'000;  // elements in bodies, copies and attached ones included
// Sections that say nothing about what sensors see.
constexpr std::string_view kUnseenSections[] = {"compiler", "option",   "size",    "statistic", "default",
                                                "asset",    "visual",   "contact", "keyframe",  "worldbody",
                                                "sensor",   "actuator", "custom"};

class MjcfImport {
 public:
  MjcfImport(const ImportRequest& request, ContentPool& pool)
      : tree_(std::make_shared<MjcfTree>(request.file)), geoms_(request, *tree_, report_, pool), attachments_(*tree_) {}

  PartContent run() {
    for (const MjcfElement& world : model_.sections("worldbody")) {
      if (tree_->bodies.empty()) tree_->bodies.push_back({.element = world, .own = "", .name = ""});
      add_content(world, {});
    }
    read_equalities();
    resolve_joint_leaders();
    report_unread();
    geoms_.shown().require(true);
    PartContent content;
    content.root = frames_.nodes();
    if (!tree_->bodies.empty()) {
      const ModelFence fence(tree_->model().file());
      content.model = std::make_shared<MjcfSource>(tree_);
    }
    content.commands = frames_.joint_commands(content.warnings);
    for (std::string& light : lights_.commands(*tree_, elements_.add("sky")))
      content.commands.push_back(std::move(light));
    std::ranges::move(cameras_, std::back_inserter(content.commands));
    for (const MjcfModel& model : tree_->models)
      std::ranges::copy(model.warnings(), std::back_inserter(content.warnings));
    std::ranges::move(report_.release(), std::back_inserter(content.warnings));
    if (std::optional<std::string> outside = geoms_.shown().outside_warning()) {
      content.warnings.push_back(std::move(*outside));
    }
    return content;
  }

 private:
  // <equality><joint> with a straight line makes a joint follow another.
  void read_equalities() {
    if (model_.is_off("equality")) return;
    for (const MjcfSection& section : tree_->sections("equality")) {
      for (const MjcfElement& each : section.element.children()) read_equality(each, section.prefix);
    }
  }

  void read_equality(const MjcfElement& each, const std::string& prefix) {
    if (each.tag() == "connect" || each.tag() == "weld") return;  // which physics takes over
    const std::string leader = each.text("joint2");
    std::vector<double> c = each.numbers("polycoef", 1, 5);
    if (c.empty()) c = {0, 1};
    c.resize(5, 0);
    const bool is_line = each.tag() == "joint" && !leader.empty() && c[2] == 0 && c[3] == 0 && c[4] == 0;
    if (!is_line || !each.flag("active", true)) {
      return report_.leave_out("<equality> that is no line between two joints", each.at());
    }
    const auto found = placed_.find(prefix + each.text("joint1"));
    if (found == placed_.end()) return;
    ModelJoint& joint = placed_joint(found->second);
    const auto other = placed_.find(prefix + leader);
    joint.leader = other == placed_.end() ? prefix + leader : placed_joint(other->second).name;
    joint.multiplier = c[1];
    joint.offset = c[0];
  }

  ModelJoint& placed_joint(const std::pair<std::size_t, std::size_t>& place) {
    return *frames_[place.first].steps[place.second].joint;
  }

  // The bodies keep the joints without their leaders: to physics, an equality is a constraint.
  void resolve_joint_leaders() {
    resolve_leaders(frames_.joints(), [&](const ModelJoint& joint, const std::string& what) {
      report_.warn(joint.where, "joint " + in_quotes(joint.name) + " " + what + "; it moves by itself");
    });
  }

  void report_unread() {
    for (const MjcfElement& section : model_.top()) {
      const bool is_known = std::ranges::count(kUnseenSections, section.tag()) > 0 || section.tag() == "equality";
      if (!is_known) report_.leave_out("element <" + std::string(section.tag()) + ">", section.at());
    }
  }

  // Where content stands: a frame of the part, a body by its number, and the frame's place within the body.
  struct Inside {
    std::size_t frame = 0, body = 0;
    glm::dmat4 body_from_frame{1.0};
    int depth = 0;
    std::string suffix{}, prefix{};  // of names, by the <replicate> and <attach> elements around
    double copies = 1;               // that the <replicate> elements around make

    std::string name(const std::string& own) const { return prefix + own + suffix; }
    Inside deeper(const glm::dmat4& frame_from_content) const {
      return {frame, body, body_from_frame * frame_from_content, depth + 1, suffix, prefix, copies};
    }
  };

  // What stands in a body or a frame. The calls are nested as these are.
  void add_content(const MjcfElement& parent, const Inside& inside) {
    if (inside.depth > kMaxMjcfDepth) parent.fail("is nested too deeply");
    for (const MjcfElement& child : parent.children()) {
      if (++content_ > kMaxContent) child.fail("is one of more than " + std::to_string(kMaxContent) + " elements");
      const std::string_view tag = child.tag();
      if (tag == "geom") {
        tree_->bodies[inside.body].geoms.push_back({child, inside.body_from_frame});
        if (NodePtr geom = geoms_.make(child)) frames_.add_visual(inside.frame, std::move(geom));
      } else if (tag == "body") {
        add_body(child, inside);
      } else if (tag == "frame") {
        add_content(child, inside_frame(inside, mjcf_pose(child)));
      } else if (tag == "replicate") {
        add_replicates(child, inside);
      } else if (tag == "attach") {
        add_attached(child, inside);
      } else if (tag == "site") {
        add_point(child, "site", mjcf_pose(child), inside);
      } else if (tag == "camera") {
        // A camera of MuJoCo looks along -z with y up, a sensor of SimVis along x with z up.
        add_camera(child, mjcf_pose(child) * glm::dmat4(0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1), inside);
      } else if (tag == "light") {
        const std::string own = child.written("name").value_or("light");
        lights_.add({child, elements_.add(inside.name(own)), inside.prefix, inside.body, inside.body_from_frame});
      } else if (tag == "inertial") {
        tree_->bodies[inside.body].inertials.push_back(child);
      } else if (tag != "joint" && tag != "freejoint") {
        report_.leave_out("element <" + std::string(tag) + ">", child.at());
      }
    }
  }

  void add_attached(const MjcfElement& attach, const Inside& inside) {
    if (++attached_ > kMaxAttachments) {
      attach.fail("is one of more than " + std::to_string(kMaxAttachments) + " attachments");
    }
    const MjcfAttached found = attachments_.find(attach);
    if (std::ranges::count(open_, found.model) > 0) attach.fail("makes a model attach itself");
    Inside within = inside.deeper(glm::dmat4(1));
    within.prefix += attach.text("prefix");
    if (members_.emplace(found.model, within.prefix).second) tree_->members.push_back({found.model, within.prefix});
    open_.push_back(found.model);
    if (found.body) add_body(*found.body, within);
    if (!found.body) {
      for (const MjcfElement& world : found.model->sections("worldbody")) add_content(world, within);
    }
    open_.pop_back();
  }

  // Copies of the content, each moved on from the one before by an offset and a turn, with numbers behind their names.
  void add_replicates(const MjcfElement& replicate, const Inside& inside) {
    const double count = replicate.number("count", 0);
    if (!(count >= 1 && count <= kMaxReplicates && count == std::floor(count))) {
      replicate.fail("has the count " + replicate.text("count") + ", expected a whole number from 1 to " +
                     std::to_string(kMaxReplicates));
    }
    replicates_ += static_cast<int>(count);
    const double copies = inside.copies * count;
    if (replicates_ > kMaxReplicates || copies > kMaxReplicates) {  // before nested ones are made in vain
      replicate.fail("makes more than " + std::to_string(kMaxReplicates) + " copies");
    }
    glm::dmat4 step = mjcf_pose(replicate), place(1);
    step[3] = glm::dvec4(replicate.vector("offset", glm::dvec3(0)), 1);
    const std::size_t digits = std::to_string(static_cast<int>(count)).size();
    for (int i = 0; i < static_cast<int>(count); ++i) {
      std::string number = std::to_string(i);
      number.insert(0, digits - std::min(digits, number.size()), '0');
      Inside within = inside_frame(inside, place);
      within.suffix = replicate.text("sep") + number + inside.suffix;
      within.copies = copies;
      add_content(replicate, within);
      place = place * step;
    }
  }

  Inside inside_frame(const Inside& around, const glm::dmat4& place) {
    Inside within = around.deeper(place);
    within.frame = frames_.add({.parent = around.frame, .steps = {{.place = place}}});
    return within;
  }

  void add_point(const MjcfElement& element, const char* kind, const glm::dmat4& place, const Inside& inside) {
    const auto name = element.written("name");
    if (!name || name->empty()) return;  // no reference can name it
    const std::string point = points_.add(inside.name(*name));
    frames_.add({.name = kind, .parent = inside.frame, .steps = {{.place = place, .point = point}}});
  }

  void add_camera(const MjcfElement& camera, const glm::dmat4& place, const Inside& inside) {
    const std::string own = camera.written("name").value_or("");
    const std::string point = points_.add(inside.name(own.empty() ? "camera" : own));
    frames_.add({.name = "camera", .parent = inside.frame, .steps = {{.place = place, .point = point}}});
    try {
      cameras_.push_back(mjcf_camera_command(camera, sensors_.add(sensor_name(point)), point, report_));
    } catch (const InputError& error) {
      report_.warn(without_word_error(error.what()) + "; the camera is left out");
    }
  }

  // { place, for each joint its anchor and its point, the body's point, content }
  void add_body(const MjcfElement& body, const Inside& inside) {
    const auto written = body.written("name");
    const std::string name = points_.add(inside.name(written.value_or("body")));
    const glm::dmat4 place = mjcf_pose(body);
    Inside within = inside.deeper(glm::dmat4(1));
    within.frame = frames_.add({.name = name, .parent = inside.frame, .steps = {{.place = place}}});
    within.body = tree_->bodies.size();
    within.body_from_frame = glm::dmat4(1);
    tree_->bodies.push_back({.element = body,
                             .own = written ? inside.name(*written) : "",
                             .name = name,
                             .parent = inside.body,
                             .parent_from_body = inside.body_from_frame * place});
    add_joints(body, glm::dmat4(1), name, within);
    frames_[within.frame].steps.push_back({.point = name, .object = ObjectKind::link});
    add_content(body, within);
  }

  // Those in frames too, which belong to the body around.
  void add_joints(const MjcfElement& within, const glm::dmat4& body_from_frame, const std::string& body,
                  const Inside& inside) {
    if (inside.depth > kMaxMjcfDepth) within.fail("is nested too deeply");
    for (const MjcfElement& child : within.children()) {
      if (child.tag() == "frame") {
        add_joints(child, body_from_frame * mjcf_pose(child), body, inside.deeper(glm::dmat4(1)));
      }
      if (child.tag() != "joint" && child.tag() != "freejoint") continue;
      const auto written = child.written("name");
      MjcfJoint joint = read_mjcf_joint(child, body_from_frame, report_);
      if (model_.is_off("limit")) joint.motion.lower = joint.motion.upper = {};
      joint.own = written ? inside.name(*written) : body + "_joint";
      joint.motion.name = elements_.add(joint.own);
      const std::string point = points_.add(joint.motion.name == body ? body + "_joint" : joint.motion.name);
      glm::dmat4 there(1), back(1);
      there[3] = glm::dvec4(joint.anchor, 1);
      back[3] = glm::dvec4(-joint.anchor, 1);
      std::vector<ModelStep>& steps = frames_[inside.frame].steps;
      placed_.try_emplace(joint.own, inside.frame, steps.size());
      steps.push_back({.place = there, .point = point, .joint = joint.motion});
      steps.push_back({.place = back});
      tree_->bodies.back().joints.push_back(std::move(joint));
    }
  }

  std::shared_ptr<MjcfTree> tree_;
  const MjcfModel& model_ = tree_->model();
  ImportReport report_;
  MjcfGeoms geoms_;
  UniqueNames points_, elements_, sensors_;
  MjcfAttachments attachments_;
  MjcfLights lights_{report_};
  std::vector<const MjcfModel*> open_{&model_};  // models that stand around what is read
  int replicates_ = 0;
  std::size_t attached_ = 0, content_ = 0;
  std::vector<std::string> cameras_;  // commands
  std::set<std::pair<const MjcfModel*, std::string>> members_;
  ModelFrames frames_{model_.name()};
  std::map<std::string, std::pair<std::size_t, std::size_t>> placed_;  // joints by their names: frame and step
};

PartContent import_mjcf(const ImportRequest& request, ContentPool& pool) { return MjcfImport(request, pool).run(); }

const PartImporterRegistration mjcf_registration({".xml"}, import_mjcf);

}  // namespace
}  // namespace simvis

// Imports URDF robots as parts: links become insertion points and visuals, joints become element commands.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/node.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "scenegraph/import/urdf/urdf_file.h"
#include "scenegraph/import/urdf/urdf_joints.h"
#include "scenegraph/import/urdf/urdf_pose.h"
#include "scenegraph/import/urdf/urdf_visuals.h"

namespace simvis {
namespace {

// The names are used for elements and insertion points. These must not contain '.', which separates element and
// parameter, or '/', which ends a robot's prefix.
void check_names(const UrdfFile& file) {
  const auto check = [&](const char* tag, const std::string& name) {
    if (name.find_first_not_of(" \t\r\n") == std::string::npos) file.fail(tag, name, "has an empty name");
    if (name.find_first_of("./") != std::string::npos) {
      file.fail(tag, name, "has a name that is not allowed, expected one without '.' and '/'");
    }
  };
  for (const auto& [name, link] : file.robot->links_) check("link", name);
  for (const auto& [name, joint] : file.robot->joints_) check("joint", name);
}

void check_origin(const UrdfFile& file, const char* tag, const std::string& name, const urdf::Pose& pose) {
  for (const double value : {pose.position.x, pose.position.y, pose.position.z}) {
    if (!(std::abs(value) <= kMaxCoordinate_m)) {
      file.fail(tag, name,
                "has an origin that is not allowed, expected coordinates of at most " +
                    format_number(kMaxCoordinate_m) + " m either way");
    }
  }
}

// Makes a separator for each link, within the separator of its parent link: { joint origin, insertion point, visuals,
// child links }. An element at the insertion point therefore moves the link's visuals and all links below.
NodePtr build_links(const UrdfFile& file, UrdfVisuals& visuals) {
  struct Pending {
    const urdf::Link* link;
    Group* parent;
  };
  const auto root = std::make_shared<Separator>();
  root->name = file.robot->getName();
  std::vector<Pending> open{{file.robot->getRoot().get(), root.get()}};
  while (!open.empty()) {
    const auto [link, parent] = open.back();
    open.pop_back();
    const auto separator = std::make_shared<Separator>();
    separator->name = link->name;
    if (link->parent_joint) {
      check_origin(file, "joint", link->parent_joint->name, link->parent_joint->parent_to_joint_origin_transform);
      const glm::dmat4 origin = matrix_of(link->parent_joint->parent_to_joint_origin_transform);
      if (origin != glm::dmat4(1)) separator->add(std::make_shared<Transform>(origin));
    }
    const auto point = std::make_shared<InsertionPoint>();
    point->name = link->name;
    separator->add(point);
    for (const auto& visual : link->visual_array) {
      check_origin(file, "link", link->name, visual->origin);
      separator->add(visuals.make(*link, *visual));
    }
    parent->add(separator);
    for (auto child = link->child_links.rbegin(); child != link->child_links.rend(); ++child) {
      open.push_back({child->get(), separator.get()});
    }
  }
  return root;
}

PartContent import_urdf(const ImportRequest& request, ContentPool& pool) {
  if (request.up_given) {
    fail_at({.file = request.file.string()}, "attribute \"up\" is not allowed: URDF says itself that z is up");
  }
  const UrdfFile file = read_urdf(request.file);
  check_names(file);
  UrdfVisuals visuals(file, pool);
  PartContent content;
  content.commands = urdf_joint_commands(file);
  content.root = build_links(file, visuals);
  content.warnings = visuals.release_warnings();
  return content;
}

const PartImporterRegistration registration({".urdf"}, import_urdf);

}  // namespace
}  // namespace simvis

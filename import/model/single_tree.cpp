#include "import/model/single_tree.h"

#include <utility>

namespace simvis {
namespace {

// Adds a body behind the first link of the tree. The first link of a body that is held is that link itself.
void add_body(const ModelBody& body, ModelTree& tree) {
  const std::size_t before = body.is_held ? tree.links.size() - 1 : tree.links.size();
  const auto moved = [&](std::size_t link) { return body.is_held && link == 0 ? 0 : before + link; };
  for (std::size_t i = body.is_held ? 1 : 0; i < body.model.links.size(); ++i) {
    tree.links.push_back(body.model.links[i]);
  }
  if (body.is_held) {
    std::vector<ModelCollision>& own = tree.links.front().collisions;
    own.insert(own.end(), body.model.links.front().collisions.begin(), body.model.links.front().collisions.end());
  } else {
    ModelJoint fixed;
    fixed.child = before;
    fixed.parent_from_joint = body.file_from_root;
    fixed.where = body.model.links.front().where;
    tree.joints.push_back(std::move(fixed));
  }
  for (ModelJoint joint : body.model.joints) {
    joint.parent = moved(joint.parent);
    joint.child = moved(joint.child);
    tree.joints.push_back(std::move(joint));
  }
}

}  // namespace

ModelTree single_tree(const ModelDescription& description) {
  if (description.is_world) {
    fail_at(description.where,
            "this is a world or one of several models, expected a file with one model for a robot of physics; an "
            "element of type \"models\" moves those of a world");
  }
  const ModelBody* free = nullptr;
  for (const ModelBody& body : description.bodies) {
    if (body.is_held) continue;
    if (free != nullptr) {
      fail_at(body.model.links.front().where, in_quotes(body.point) + " is not joined with " + in_quotes(free->point) +
                                                  ", expected links that joints make one tree");
    }
    free = &body;
  }
  if (description.bodies.size() == 1 &&
      (description.bodies.front().is_held || description.bodies.front().file_from_root == glm::dmat4(1))) {
    return description.bodies.front().model;
  }
  ModelTree tree;
  tree.links.push_back({.name = "", .inertial = {}, .collisions = {}, .where = description.where});
  for (const ModelBody& body : description.bodies) add_body(body, tree);
  return tree;
}

}  // namespace simvis

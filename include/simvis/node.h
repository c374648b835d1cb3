// The nodes of the scene graph. Traversal is ordered and carries state: a Transform or MaterialNode holds for the
// siblings after it and, leaving a Group, goes on; a Separator saves the state and restores it.
//
// A node may stand under several parents: it is then drawn once per path. The graph has no cycles (flattening throws).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/mesh.h>

namespace simvis {

class Node;
class Group;
using NodePtr = std::shared_ptr<Node>;
using GroupPtr = std::shared_ptr<Group>;

/// Hears that a node it has visited changed. Implemented by Flattener.
class NodeObserver {
 public:
  virtual ~NodeObserver() = default;
  /// A transform, a light, the environment, the medium, or a material or mesh that has a slot of its own.
  virtual void content_changed(Node& node) = 0;
  virtual void structure_changed() = 0;  ///< children, a switch, what is visible, which material or mesh
};

enum class NodeKind : std::uint8_t {
  group,
  separator,
  visual,
  switch_,
  transform,
  material,
  visibility,
  shape,
  light,
  environment,
  insertion_point,
  mount,
  medium
};

class Node {
 public:
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  NodeKind kind() const { return kind_; }

  std::string name;  ///< for people; need not be unique

  void attach(NodeObserver& observer);
  void detach(NodeObserver& observer);

 protected:
  explicit Node(NodeKind kind) : kind_(kind) {}
  void tell_content_changed();
  void tell_structure_changed();

 private:
  NodeKind kind_;
  std::vector<NodeObserver*> observers_;
};

/// Children in order; the state that they leave behind goes on to what follows.
class Group : public Node {
 public:
  Group() : Group(NodeKind::group) {}
  ~Group() override;  ///< takes a graph of any depth apart without recursion

  const std::vector<NodePtr>& children() const { return children_; }
  void add(NodePtr child);
  /// Before `where`, which must be a child.
  void insert_before(const Node& where, NodePtr child);
  /// `child` must be a child.
  void remove(const Node& child);

 protected:
  explicit Group(NodeKind kind) : Node(kind) {}

 private:
  std::vector<NodePtr> children_;
};

/// A group that restores the traversal state when it ends.
class Separator : public Group {
 public:
  Separator() : Group(NodeKind::separator) {}
};

/// A separator whose content is drawn only for people: flatteners for sensors pass it by, as if it were not there.
class VisualSeparator : public Group {
 public:
  VisualSeparator() : Group(NodeKind::visual) {}
};

/// A group of which one child, all or none are traversed.
class Switch : public Group {
 public:
  static constexpr int kAll = -1, kNone = -2;
  Switch() : Group(NodeKind::switch_) {}
  int which() const { return which_; }
  void set_which(int which);  ///< an index of a child, kAll or kNone

 private:
  int which_ = kAll;
};

/// Moves what follows: parent_from_child.
class Transform : public Node {
 public:
  Transform() : Node(NodeKind::transform) {}
  explicit Transform(const glm::dmat4& matrix) : Node(NodeKind::transform), matrix_(matrix) {}
  const glm::dmat4& matrix() const { return matrix_; }
  void set_matrix(const glm::dmat4& matrix);  ///< every value finite; an equal matrix is no change

 private:
  glm::dmat4 matrix_{1.0};
};

/// What somebody makes of a material that is not theirs. Changes by several add up in any order to the same; of what
/// stands for the material's own, the last counts.
struct MaterialChange {
  glm::vec3 color{1};                ///< factor of the base colour
  float opacity = 1, roughness = 1;  ///< factors
  glm::vec3 emission{0};             ///< linear radiance, added

  float mirror = 0, transmission = 0;                       ///< this share of what is not yet it becomes it
  float refractive_index = 1;                               ///< factor
  std::optional<float> reflectance{}, retro_reflectance{};  ///< of a laser's light: stand for the material's

  bool operator==(const MaterialChange&) const = default;
};

/// The material of the shapes that follow. Several nodes may share one material, and one node may stand in many places.
/// A node whose material was ever set anew, or that somebody may change, has a slot of its own in the DrawList, so that
/// a change writes just that.
class MaterialNode : public Node {
 public:
  explicit MaterialNode(std::shared_ptr<const Material> material)
      : Node(NodeKind::material), material_(std::move(material)), shown_(material_) {}
  const std::shared_ptr<const Material>& material() const { return material_; }
  void set_material(std::shared_ptr<const Material> material);
  bool has_own_slot() const { return has_own_slot_ || !changes_.empty(); }

  /// Room for one more change, which changes nothing yet; gives its number.
  std::size_t add_change();
  void remove_last_change();
  void set_change(std::size_t number, const MaterialChange& change);

  /// The material with its changes.
  const std::shared_ptr<const Material>& shown() const { return shown_; }

 private:
  void show();
  std::shared_ptr<const Material> material_, shown_;
  std::vector<MaterialChange> changes_;
  bool has_own_slot_ = false;
};

/// Whether the shapes and lights that follow are there. What is hidden once stays so for all below: a visible node
/// within something hidden shows nothing. Mounts are reached all the same.
class Visibility : public Node {
 public:
  Visibility() : Node(NodeKind::visibility) {}
  bool visible() const { return visible_; }
  void set_visible(bool visible);

 private:
  bool visible_ = true;
};

/// A mesh to draw, in the material in force (where there is none: a white, opaque one).
/// A node whose mesh was ever set anew has a slot of its own in the DrawList, so that a change writes just that.
class Shape : public Node {
 public:
  explicit Shape(std::shared_ptr<const Mesh> mesh) : Node(NodeKind::shape), mesh_(std::move(mesh)) {}
  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
  void set_mesh(std::shared_ptr<const Mesh> mesh);
  bool has_own_slot() const { return has_own_slot_; }

 private:
  std::shared_ptr<const Mesh> mesh_;
  bool has_own_slot_ = false;
};

/// A light at the place where it stands. It lights the whole scene, wherever it hangs.
class LightNode : public Node {
 public:
  explicit LightNode(const Light& light) : Node(NodeKind::light), light_(light) {}
  const Light& light() const { return light_; }
  void set_light(const Light& light);

  /// Linear RGB by which the light's colour is multiplied: for who changes its colour but does not own the light.
  const glm::vec3& tint() const { return tint_; }
  void set_tint(const glm::vec3& tint);

  /// The light in its tint.
  Light shown() const;

 private:
  Light light_;
  glm::vec3 tint_{1};
};

/// What surrounds the scene. Of several, the last in order of traversal counts.
class EnvironmentNode : public Node {
 public:
  explicit EnvironmentNode(const Environment& environment) : Node(NodeKind::environment), environment_(environment) {}
  const Environment& environment() const { return environment_; }
  void set_environment(const Environment& environment);

 private:
  Environment environment_;
};

/// What fills the air everywhere. Of several, the last in order of traversal counts.
class MediumNode : public Node {
 public:
  explicit MediumNode(const Medium& medium) : Node(NodeKind::medium), medium_(medium) {}
  const Medium& medium() const { return medium_; }
  void set_medium(const Medium& medium);

 private:
  Medium medium_;
};

/// A named leaf that draws nothing: new content goes right before it.
class InsertionPoint : public Node {
 public:
  InsertionPoint() : Node(NodeKind::insertion_point) {}
};

/// A place in the graph whose pose in the world somebody asks for: a camera, a sensor.
class Mount : public Node {
 public:
  Mount() : Node(NodeKind::mount) {}
};

/// From the nodes of a graph to those of its copy.
using NodeMap = std::unordered_map<const Node*, NodePtr>;

}  // namespace simvis

// The nodes of the scene graph. Traversal is ordered and carries state: a Transform or a MaterialNode applies to the
// siblings after it and, beyond the end of a Group, to what follows; a Separator saves the state and restores it.
//
// A node may have several parents; it is then drawn once per path. The graph has no cycles (flattening throws).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/mesh.h>
#include <simvis/object_tree.h>

namespace simvis {

class Node;
class Group;
/// Shared ownership of a node.
using NodePtr = std::shared_ptr<Node>;
/// Shared ownership of a group.
using GroupPtr = std::shared_ptr<Group>;

/// Observes changes of the nodes that it is attached to. Implemented by Flattener.
class SIMVIS_API NodeObserver {
 public:
  virtual ~NodeObserver() = default;
  /// A transform, a light, a visibility, the environment, the medium, or a material or mesh with a slot of its own has
  /// changed.
  virtual void content_changed(Node& node) = 0;
  /// Children, a switch, or the identity of a material or mesh has changed.
  virtual void structure_changed() = 0;
};

/// The class of a node.
enum class NodeKind : std::uint8_t {
  group,            ///< Group
  separator,        ///< Separator
  visual,           ///< VisualSeparator
  switch_,          ///< Switch
  transform,        ///< Transform
  material,         ///< MaterialNode
  visibility,       ///< Visibility
  shape,            ///< Shape
  light,            ///< LightNode
  environment,      ///< EnvironmentNode
  sky,              ///< SkyNode
  insertion_point,  ///< InsertionPoint
  mount,            ///< Mount
  medium            ///< MediumNode
};

/// Base of all nodes.
///
/// Errors    functions of nodes throw nothing of their own; a violated precondition asserts.
/// Lifetime  references that getters return are valid until the node changes or is destroyed.
/// Threads   one thread at a time uses a graph.
class SIMVIS_API Node {
 public:
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  NodeKind kind() const { return kind_; }  ///< the node's class

  std::string name;  ///< for people; need not be unique

  /// Reports changes to `observer` until it is detached. The observer must outlive that time.
  void attach(NodeObserver& observer);
  void detach(NodeObserver& observer);  ///< ends reports to `observer`

 protected:
  explicit Node(NodeKind kind) : kind_(kind) {}  ///< for derived classes
  void tell_content_changed();                   ///< calls content_changed() of all observers
  void tell_structure_changed();                 ///< calls structure_changed() of all observers

 private:
  NodeKind kind_;
  std::vector<NodeObserver*> observers_;
};

/// A list of children in order. The state after the last child carries over to what follows the group.
class SIMVIS_API Group : public Node {
 public:
  Group() : Group(NodeKind::group) {}  ///< without children
  ~Group() override;                   ///< destroys a graph of any depth without recursion

  const std::vector<NodePtr>& children() const { return children_; }  ///< in traversal order
  void add(NodePtr child);                                            ///< appends a child, which is not null
  /// Inserts a child before `where`, which must be a child.
  void insert_before(const Node& where, NodePtr child);
  /// Removes `child`, which must be a child.
  void remove(const Node& child);

 protected:
  explicit Group(NodeKind kind) : Node(kind) {}  ///< for derived classes

 private:
  std::vector<NodePtr> children_;
};

/// A group that restores the traversal state at its end.
class SIMVIS_API Separator : public Group {
 public:
  Separator() : Group(NodeKind::separator) {}  ///< without children
};

/// A separator whose content is drawn for people only: flatteners for sensors skip it.
class SIMVIS_API VisualSeparator : public Group {
 public:
  VisualSeparator() : Group(NodeKind::visual) {}  ///< without children
};

/// A group of which one child, all children or none are traversed.
class SIMVIS_API Switch : public Group {
 public:
  static constexpr int kAll = -1,         ///< all children are traversed
      kNone = -2;                         ///< no child is traversed
  Switch() : Group(NodeKind::switch_) {}  ///< without children; which() is kAll
  int which() const { return which_; }    ///< index of the traversed child, kAll or kNone
  void set_which(int which);              ///< an index of a child, kAll or kNone

 private:
  int which_ = kAll;
};

/// A transform of what follows: parent_from_child.
class SIMVIS_API Transform : public Node {
 public:
  Transform() : Node(NodeKind::transform) {}  ///< the identity
  /// `matrix` is parent_from_child; every value is finite.
  explicit Transform(const glm::dmat4& matrix) : Node(NodeKind::transform), matrix_(matrix) {}
  const glm::dmat4& matrix() const { return matrix_; }  ///< parent_from_child
  void set_matrix(const glm::dmat4& matrix);            ///< every value is finite; an equal matrix is no change

 private:
  glm::dmat4 matrix_{1.0};
};

/// A change that an element applies to a material which it does not own. Factors and shares of several changes combine
/// in any order to the same result; of values that replace the material's own, the last one applies.
struct MaterialChange {
  glm::vec3 color{1};     ///< factor of the base colour
  float opacity = 1,      ///< factor of the opacity
      roughness = 1;      ///< factor of the roughness
  glm::vec3 emission{0};  ///< linear radiance, added

  float mirror = 0,                      ///< turns this share of what is not yet mirror into mirror
      transmission = 0;                  ///< turns this share of what does not yet transmit into transmission
  float refractive_index = 1;            ///< factor of the refractive index
  std::optional<float> fixed_opacity{},  ///< replaces the material's opacity and alphas; cut-outs of masks stay
      reflectance{},                     ///< replaces the material's reflectance of laser light
      retro_reflectance{};               ///< replaces the material's retro-reflectance of laser light

  bool operator==(const MaterialChange&) const = default;  ///< member by member
};

/// The material of the shapes that follow. Several nodes may share one material, and one node may have many parents.
/// A node whose material was ever replaced, or that has room for changes, has a slot of its own in the DrawList, so
/// that a change rewrites this slot only.
class SIMVIS_API MaterialNode : public Node {
 public:
  /// `material` is not null.
  explicit MaterialNode(std::shared_ptr<const Material> material)
      : Node(NodeKind::material), material_(std::move(material)), shown_(material_) {}
  const std::shared_ptr<const Material>& material() const { return material_; }  ///< without changes
  void set_material(std::shared_ptr<const Material> material);                   ///< replaces it; not null
  bool has_own_slot() const { return has_own_slot_ || !changes_.empty(); }       ///< in the DrawList
  /// Replaces the material by what it was meant to be, because its pictures have been read; not null. Unlike
  /// set_material(), this gives the node no slot of its own.
  void complete_material(std::shared_ptr<const Material> material);

  /// Makes room for one more change, which has no effect yet, and returns its number, which no other change of this
  /// node ever has.
  std::size_t add_change();
  void set_change(std::size_t number, const MaterialChange& change);  ///< `number` comes from add_change()
  void remove_change(std::size_t number);                             ///< `number` comes from add_change()
  void restore_change(std::size_t number);  ///< makes room again for a change that was removed

  /// The material with its changes applied.
  const std::shared_ptr<const Material>& shown() const { return shown_; }

 private:
  void show();
  std::shared_ptr<const Material> material_, shown_;
  std::map<std::size_t, MaterialChange> changes_;  // by number
  std::size_t next_change_ = 0;
  bool has_own_slot_ = false;
};

/// Whether the shapes and lights that follow are visible. Hidden content cannot become visible again further down: a
/// visible node within hidden content shows nothing. Mounts are reached in any case.
class SIMVIS_API Visibility : public Node {
 public:
  Visibility() : Node(NodeKind::visibility) {}  ///< visible
  bool visible() const { return visible_; }     ///< whether this node lets content be visible
  void set_visible(bool visible);               ///< an equal value is no change

 private:
  bool visible_ = true;
};

/// A mesh that is drawn with the current material (a white, opaque one if there is none).
/// A node whose mesh was ever replaced has a slot of its own in the DrawList, so that a change rewrites this slot only.
class SIMVIS_API Shape : public Node {
 public:
  /// `mesh` is not null.
  explicit Shape(std::shared_ptr<const Mesh> mesh) : Node(NodeKind::shape), mesh_(std::move(mesh)) {}
  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }  ///< what is drawn
  void set_mesh(std::shared_ptr<const Mesh> mesh);                   ///< replaces it; not null
  bool has_own_slot() const { return has_own_slot_; }                ///< in the DrawList
  /// Takes back every set_mesh(): `mesh` is that of the constructor, and the shape shares its slot again.
  void restore_mesh(std::shared_ptr<const Mesh> mesh);

 private:
  std::shared_ptr<const Mesh> mesh_;
  bool has_own_slot_ = false;
};

/// A light in the frame of the current transform. It lights the whole scene, whatever its place in the graph.
class SIMVIS_API LightNode : public Node {
 public:
  /// `light` in the node's frame.
  explicit LightNode(const Light& light) : Node(NodeKind::light), light_(light) {}
  const Light& light() const { return light_; }  ///< without the tint
  void set_light(const Light& light);            ///< an equal light is no change

  /// Linear RGB factor of the light's colour. An element that does not own the light changes its colour with this.
  const glm::vec3& tint() const { return tint_; }
  void set_tint(const glm::vec3& tint);  ///< an equal tint is no change

  /// The light with its tint applied.
  Light shown() const;

 private:
  Light light_;
  glm::vec3 tint_{1};
};

/// The surroundings of the scene. If there are several, the last in order of traversal applies.
class SIMVIS_API EnvironmentNode : public Node {
 public:
  /// Holds a copy of `environment`.
  explicit EnvironmentNode(const Environment& environment) : Node(NodeKind::environment), environment_(environment) {}
  const Environment& environment() const { return environment_; }  ///< the surroundings
  void set_environment(const Environment& environment);            ///< an equal value is no change

 private:
  Environment environment_;
};

/// A picture of the sky in the frame of the current transform. If there are several, the last in order of traversal
/// applies.
class SIMVIS_API SkyNode : public Node {
 public:
  /// `picture` is not null; `mean` is its radiance in the mean over the sphere.
  SkyNode(std::shared_ptr<const SkyPicture> picture, const glm::vec3& mean);
  /// What is seen; SkyView::transform is 0.
  const SkyView& view() const { return view_; }
  void set_factor(float factor);  ///< of the picture's radiance; an equal factor is no change

 private:
  SkyView view_;
};

/// The medium that fills the air everywhere. If there are several, the last in order of traversal applies.
class SIMVIS_API MediumNode : public Node {
 public:
  /// Holds a copy of `medium`.
  explicit MediumNode(const Medium& medium) : Node(NodeKind::medium), medium_(medium) {}
  const Medium& medium() const { return medium_; }  ///< the medium
  void set_medium(const Medium& medium);            ///< an equal value is no change

 private:
  Medium medium_;
};

/// A named leaf that draws nothing: new content is inserted right before it.
class SIMVIS_API InsertionPoint : public Node {
 public:
  /// Without a name. Importers say what stands at the point: ObjectKind::model, link or frame.
  explicit InsertionPoint(ObjectKind object = ObjectKind::frame)
      : Node(NodeKind::insertion_point), object_kind(object) {}

  ObjectKind object_kind;  ///< of the point's object in Scene::objects()
};

/// A place in the graph whose pose in the world can be queried: a camera, a sensor.
class SIMVIS_API Mount : public Node {
 public:
  Mount() : Node(NodeKind::mount) {}  ///< without a name
};

/// Maps the nodes of a graph to the nodes of its copy.
using NodeMap = std::unordered_map<const Node*, NodePtr>;

}  // namespace simvis

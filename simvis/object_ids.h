// The ids of items and objects: which shape an item is, which object has it, and of which class it is.
//
// Objects   The object of an item is what a label makes one object: a part, a model, a link, or shapes of these. An
//           item without a label belongs to the object whose insertion point stands in front of it.
// Ids       The id of an item is a hash of the name of its insertion point and of its number among the items of that
//           point; that of an object is a hash of its name and the number 0, so that an object of one item has the id
//           of the item. The name of shapes that a label makes an object is that of their object and theirs. So ids do
//           not depend on what else the scene has, nor on the order of its commands. Ids are never 0. Of two names
//           whose hashes are equal (among 1,000 names once in 8,600 scenes), the one that comes first, or that was
//           there first, has the hash as its id and the other one the next free number.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <simvis/object_tree.h>
#include <simvis/scene.h>
#include <simvis/sensor_needs.h>
#include "scenegraph/flattener.h"

namespace simvis {

/// Ids of numbered names. Names that are gone keep theirs, for the time when they come back.
class NameIds {
 public:
  using Key = std::pair<std::string, std::uint32_t>;
  /// The ids of the keys, of which no two are equal, in their order.
  std::vector<std::uint32_t> ids_of(std::span<const Key> keys);

 private:
  std::map<Key, std::uint32_t> id_of_;       // of all keys so far
  std::unordered_set<std::uint32_t> taken_;  // ids of all keys so far
};

/// The ids and objects of one flattener.
class ObjectIds {
 public:
  /// Follows the flattener's update(). It costs nothing if no traversal has taken place since the last call.
  void update(const Scene& scene, const Flattener& flattener);

  /// By item of the last update(). Valid until the next one.
  ItemIds ids() const { return {instances_, classes_, shapes_}; }
  /// The id of the object of this name; 0: there is none.
  std::uint32_t id_of(std::string_view name) const;
  /// The name of an item's class; empty if it has none.
  const std::string& class_name(std::uint32_t item) const;

  /// All objects, parents in front of what belongs to them, with their surfaces as they stand now. ROOT is among them
  /// only if it has surfaces itself. Valid until the next update().
  std::span<const SceneObject> objects(const Flattener& flattener, const DrawList& list);

 private:
  class Naming;
  // The frame of an object whose surfaces stand in several nodes.
  struct PointFrame {
    std::size_t object = 0;  // in objects_
    const InsertionPoint* point = nullptr;
  };
  // The box of a surface in the frame of its object.
  struct KnownBox {
    const Mesh* mesh = nullptr;
    glm::dmat4 frame_from_mesh{1.0};
    glm::dvec3 low_m{0}, high_m{0};
  };
  void name_shapes(const Flattener& flattener);
  void name_objects(const Scene& scene, const Flattener& flattener);
  void measure(SceneObject& object, const DrawList& list);

  std::uint64_t rebuilds_ = 0;  // of the flattener, at the last update()
  NameIds shape_ids_, object_ids_;
  std::map<std::uint32_t, std::string> class_names_;         // by id
  std::vector<std::uint32_t> instances_, classes_, shapes_;  // by item
  std::vector<SceneObject> objects_;
  std::map<std::string, std::uint32_t, std::less<>> id_of_name_;  // of objects_
  std::vector<PointFrame> frames_;
  std::unordered_map<std::uint32_t, KnownBox> boxes_;  // by item, of objects in frames_
};

}  // namespace simvis

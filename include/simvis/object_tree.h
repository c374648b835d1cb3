// The objects of a scene as plain data: its parts, and the models, links and named places in their files. Every name
// that a user writes for one of them, or for several by a pattern, is looked up here.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/export.h>

namespace simvis {

/// What an object is.
enum class ObjectKind : std::uint8_t {
  world,  ///< ROOT
  part,   ///< what a part command inserts: a file, a shape or an empty frame
  model,  ///< a model in the file of a part: of SDF
  link,   ///< a rigid body in the file of a part: a link of URDF or SDF, a body of MJCF or USD
  frame,  ///< another named place in the file of a part: a joint, a site, a camera, a marked node of glTF
  shape   ///< shapes of a file that a label makes an object; such an object stands in no ObjectTree
};

/// "part", "link" and so on.
SIMVIS_API std::string_view to_string(ObjectKind kind);

/// Stands for no object.
inline constexpr std::uint32_t kNoObject = std::numeric_limits<std::uint32_t>::max();

/// One object of a tree. Its surfaces are the shapes that stand behind its insertion point, up to the next one.
struct Object {
  std::string name;                    ///< of its insertion point: no other object of the scene has it
  std::string path;                    ///< from the part at ROOT down, as in ROBOT/arm/link_3; of ROOT: ROOT
  ObjectKind kind = ObjectKind::part;  ///< what it is
  std::uint32_t parent = kNoObject,    ///< the object that it belongs to; of ROOT: kNoObject. A link belongs to its
                                       ///< model or part, not to the link in front of it
      part = kNoObject;                ///< the part whose file it stands in; of a part: itself; of ROOT: kNoObject
  bool operator==(const Object&) const = default;  ///< member by member
};

/// Whether a name is the pattern itself or matches it: * stands for any text, ? for any character, [ab] for one of
/// these.
SIMVIS_API bool matches_pattern(std::string_view pattern, std::string_view name);

/// The objects of a scene, in an order in which parents stand in front of what belongs to them.
///
/// Names     An object is found by its name or by its path. Names take precedence over paths.
/// Lifetime  pointers and references are valid until an object is added.
/// Threads   several threads may read at a time.
class SIMVIS_API ObjectTree {
 public:
  ObjectTree();  ///< ROOT alone, which is object 0

  /// Adds an object whose parent is there and returns its number. No other object has the name (asserted).
  std::uint32_t add(std::string name, ObjectKind kind, std::uint32_t parent);

  std::size_t size() const { return objects_.size(); }                               ///< number of objects, with ROOT
  const Object& operator[](std::uint32_t object) const { return objects_[object]; }  ///< below size()
  std::span<const Object> all() const { return objects_; }                           ///< by their numbers

  /// The object of this name, or the only one of this path. ROOT is found too.
  std::optional<std::uint32_t> find(std::string_view name) const;
  /// The objects whose names match the pattern, sorted by name; if there are none, those whose paths match it. ROOT is
  /// not among them.
  std::vector<std::uint32_t> matching(std::string_view pattern) const;
  /// The objects that a value of an attribute of kind `objects` names: those that match it as a whole, or else those
  /// that match one of its words, sorted by name. Throws nothing; words without an object are appended to `unknown`.
  std::vector<std::uint32_t> named(std::string_view value, std::vector<std::string>& unknown) const;
  /// The object and, of a part or a model, all of its file that belongs to it. What is inserted there does not.
  std::vector<std::uint32_t> content_of(std::uint32_t object) const;
  /// The names of content_of(), in its order.
  std::vector<std::string> names_in(std::uint32_t object) const;

  /// The message about a name or pattern that no object has: `there is no part or link "CHIAR", did you mean "CHAIR"?`
  /// with the nearest name. `noun` is what has been expected.
  std::string unknown(std::string_view noun, std::string_view name) const;

 private:
  std::vector<Object> objects_;
  std::map<std::string, std::uint32_t, std::less<>> by_name_;
  std::multimap<std::string, std::uint32_t, std::less<>> by_path_;
};

/// A surface of an object: an item of the draw list.
struct ObjectSurface {
  std::uint32_t item = 0;                                 ///< in DrawList::items
  glm::dmat4 frame_from_mesh{1.0};                        ///< where its mesh stands in the object's frame
  bool operator==(const ObjectSurface&) const = default;  ///< member by member
};

/// What a simulation says of one object in a frame.
///
/// Frame    If all surfaces of the object stand in one node, its frame is that node, otherwise the object's insertion
///          point. It may be scaled.
struct SceneObject {
  std::uint32_t instance = 0,             ///< its id in all sensors, frames and runs, see ItemIds; at least 1
      parent = 0;                         ///< that of the object that it belongs to; 0: it belongs to ROOT
  std::string name,                       ///< as Object::name; of a shape: its path
      path;                               ///< as Object::path; of a shape: OBJECT/SHAPE or OBJECT/LABEL
  ObjectKind kind = ObjectKind::part;     ///< what it is
  std::uint32_t semantic = 0;             ///< the id of its class; 0: it has none
  std::string label{};                    ///< the name of its class; empty: it has none
  std::vector<ObjectSurface> surfaces{};  ///< that show its id, by their items; those of a labelled object include
                                          ///< those of all objects that the label makes one with it
  std::uint32_t transform = 0;            ///< its frame, in DrawList::world_from_node; of an object with surfaces
  /// The lower corner of the box of its surfaces in its frame; of an object with a class.
  glm::dvec3 low_m{0};
  glm::dvec3 high_m{0};  ///< the upper corner

  bool operator==(const SceneObject&) const = default;  ///< member by member
};

}  // namespace simvis

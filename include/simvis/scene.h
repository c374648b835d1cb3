// A scene under construction: the graph from ROOT down, its insertion points, and the content that parts share.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/content_pool.h>
#include <simvis/node.h>
#include <simvis/undo_log.h>

namespace simvis {

class NameSet;
struct PartAnimations;

/// What a part file became.
struct PartContent {
  NodePtr root;                       ///< may stand under several parents
  std::vector<std::string> warnings;  ///< for people, each with the file's name
  std::vector<std::string> commands;  ///< embedded commands, XML text, in the order found
  std::filesystem::path file;         ///< the canonical name; set by Scene
  std::vector<std::string> points;    ///< names of the insertion points in the graph, in order; set by Scene
  /// What moves the nodes of `root`; null: nothing does.
  std::shared_ptr<const PartAnimations> animations;
};

/// A part's content that belongs to one insertion alone.
struct OwnPart {
  NodePtr root;
  const PartContent& content;  ///< what it was copied from
  const NodeMap& clone_of;     ///< from the nodes of content.root to those of `root`
};

/// Frames   the world is ROOT's frame: x forward, y left, z up, metres.
/// Attributes of a part  file (a relative name starts at the command's folder), name, insert_at, pose_offset, up.
/// Names    insertion points, parts, elements and sensors each have a name of their own; two of a kind never share one.
class Scene {
 public:
  Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  const GroupPtr& root() const { return root_; }

  /// What the file of a part command holds; read once, however often it is inserted.
  /// Throws InputError with the place: an attribute that is unknown or wrong, a file that is missing, of an unknown
  /// kind or broken.
  const PartContent& load_part(const Command& command);

  /// Executes a part command: separator { offset, insertion point NAME, content } right before its `insert_at`.
  /// Insertion points within the content become known as `prefix` + their name. Returns the part's content; to execute
  /// the commands that it carries is up to the caller.
  /// Throws InputError as load_part(), and for an unknown insertion point or a name already taken.
  const PartContent& insert_part(const Command& command, const std::string& prefix = "");

  /// Puts `node` right before the insertion point named by the command's `insert_at`, and lets others find it by the
  /// command's name if it is an element's.
  /// Throws InputError when there is no such insertion point (the nearest name suggested).
  void insert(const Command& command, NodePtr node);

  /// Puts `node` where no transform is in force: its frame is the world's.
  void insert_in_world(NodePtr node);
  /// The same for a command whose node needs no place of its own; like insert() but for that.
  void insert_in_world(const Command& command, NodePtr node);

  /// Puts `node` right behind the insertion point of the part, which exists: it moves with the part, whatever is
  /// inserted there later.
  void insert_behind_point(std::string_view part, NodePtr node);

  /// Makes the content of the part `name` its own, so that a change of its nodes shows in no other part of the same
  /// file. Parts, elements and sensors that were inserted there are not of its content.
  /// Throws InputError at `where` when there is no such part (the nearest name suggested).
  OwnPart own_part(std::string_view name, const Location& where);

  /// What was inserted under a command's name: a part's separator, or the node of an element. Null when there is none.
  NodePtr find_node(std::string_view name) const;

  bool has_part(std::string_view name) const { return parts_.find(name) != parts_.end(); }
  std::vector<std::string_view> part_names() const;
  bool has_insertion_point(std::string_view name) const;
  std::vector<std::string_view> insertion_points() const;

  /// Messages of importers that did not stop them, in the order they came, each once.
  const std::vector<std::string>& warnings() const { return warnings_; }

  ContentPool& pool() { return pool_; }
  /// How to take back what was done since the last commit().
  UndoLog& undo() { return undo_; }

 private:
  struct Place {
    Group* parent;
    const InsertionPoint* point;
  };
  // One insertion of a part.
  struct Part {
    std::shared_ptr<Separator> separator;
    const PartContent* content = nullptr;
    NodePtr root;      // the last child of `separator`
    NodeMap clone_of;  // empty as long as `root` is the content's own
  };
  const Place& place(const Command& command) const;
  void share_graph(PartContent& content) const;
  void insert_at(const Place& place, const NodePtr& node);
  void remember(const Command& command, const NodePtr& node);
  void add_place(const CommandAttribute& name, const Place& place);
  void add_points(const CommandAttribute& part_name, const Part& part, const std::string& prefix);

  GroupPtr root_;
  std::map<std::string, Place, std::less<>> places_;
  std::unique_ptr<NameSet> part_names_;
  std::map<std::string, Part, std::less<>> parts_;
  std::map<std::string, NodePtr, std::less<>> nodes_;  // of elements, by name
  std::map<std::string, PartContent> contents_;        // by canonical path and up axis: one file is read once
  ContentPool pool_;
  std::vector<std::string> warnings_;
  UndoLog undo_;
};

/// Throws what went wrong inside a part as an error of the command that inserts it:
/// "scene.xml:3:2: error: part WORLD: world.glb: ...".
[[noreturn]] void rethrow_from_part(const Command& part, const InputError& error);

}  // namespace simvis

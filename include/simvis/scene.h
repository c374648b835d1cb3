// A scene under construction: the graph below ROOT, its insertion points, and the content that parts share.
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

/// The content of a part file.
struct PartContent {
  NodePtr root;                       ///< may have several parents
  std::vector<std::string> warnings;  ///< for people, each with the file's name
  std::vector<std::string> commands;  ///< embedded commands, XML text, in the order found
  std::filesystem::path file;         ///< the canonical name; set by Scene
  std::vector<std::string> points;    ///< names of the insertion points in the graph, in order; set by Scene
  /// Animations of the nodes of `root`; null: there are none.
  std::shared_ptr<const PartAnimations> animations;
};

/// The content of a part that belongs to one insertion alone.
///
/// Lifetime  the references are valid as long as the scene.
struct OwnPart {
  NodePtr root;                ///< the insertion's own graph
  const PartContent& content;  ///< the shared content that it was copied from
  const NodeMap& clone_of;     ///< from the nodes of content.root to those of `root`
};

/// A scene under construction.
///
/// Frames    the world is ROOT's frame: x forward, y left, z up, metres.
/// Part      attributes of a part command: file (a relative name starts at the command's folder), name, insert_at,
///           pose_offset, up.
/// Names     insertion points, parts, elements and sensors have names; two of the same kind never share one.
/// Errors    InputError with the place; a command that throws may leave traces, which undo() reverts.
/// Lifetime  returned references are valid as long as the scene.
/// Threads   one thread at a time.
class Scene {
 public:
  Scene();                             ///< ROOT alone
  Scene(Scene&&) noexcept;             ///< the other may only be assigned to or destroyed
  Scene& operator=(Scene&&) noexcept;  ///< the other may only be assigned to or destroyed
  ~Scene();

  const GroupPtr& root() const { return root_; }  ///< the node of ROOT

  /// The content of a part command's file. Each file is read once, however often it is inserted.
  /// Throws InputError with the place: an attribute is unknown or wrong, or the file is missing, of an unknown format
  /// or broken.
  const PartContent& load_part(const Command& command);

  /// Executes a part command: inserts separator { offset, insertion point NAME, content } right before its `insert_at`.
  /// Insertion points within the content get the name `prefix` + their name. Returns the part's content; the caller
  /// executes the commands that it carries.
  /// Throws InputError as load_part(), and for an unknown insertion point or a name that is taken.
  const PartContent& insert_part(const Command& command, const std::string& prefix = "");

  /// Inserts `node` right before the insertion point that the command's `insert_at` names. If the command is an
  /// element's, find_node() finds the node by the command's name.
  /// Throws InputError if there is no such insertion point (the nearest name is suggested).
  void insert(const Command& command, NodePtr node);

  /// Inserts `node` where no transform applies: its frame is the world's.
  void insert_in_world(NodePtr node);
  /// Inserts `node` as insert_in_world(NodePtr), for a command whose node needs no place of its own; errors and
  /// find_node() as for insert().
  void insert_in_world(const Command& command, NodePtr node);

  /// Inserts `node` right behind the insertion point of the part, which must exist (asserted). The node moves with the
  /// part, whatever is inserted there later.
  void insert_behind_point(std::string_view part, NodePtr node);

  /// Gives the part `name` a copy of its content, so that a change of its nodes shows in no other part of the same
  /// file. Parts, elements and sensors that were inserted there do not belong to its content.
  /// Throws InputError at `where` if there is no such part (the nearest name is suggested).
  OwnPart own_part(std::string_view name, const Location& where);

  /// The node that a command of this name inserted: a part's separator, or the node of an element. Null if there is
  /// none.
  NodePtr find_node(std::string_view name) const;

  /// Whether there is a part of this name.
  bool has_part(std::string_view name) const { return parts_.find(name) != parts_.end(); }
  std::vector<std::string_view> part_names() const;        ///< sorted; valid until parts are inserted or reverted
  bool has_insertion_point(std::string_view name) const;   ///< ROOT, or the insertion point of a part
  std::vector<std::string_view> insertion_points() const;  ///< sorted; valid until parts are inserted or reverted

  /// Adds a warning unless it is there already: one line "FILE[:LINE[:COLUMN]]: WHAT", without the word "warning". If
  /// the command that adds it is reverted, the warning is reverted too. Throws InputError if the scene is strict.
  void warn(const std::string& warning);
  /// As warn(const std::string&), with the place in front.
  void warn(const Location& where, std::string_view what);
  /// All warnings, in the order in which they came, each once.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// From now on, a warning is an error: warn() throws InputError "FILE:LINE:COLUMN: error: WHAT".
  void make_strict() { strict_ = true; }

  ContentPool& pool() { return pool_; }  ///< shared content of all parts
  /// The steps that revert everything since the last commit().
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
  bool strict_ = false;
  UndoLog undo_;
};

/// Throws an error from inside a part as an InputError of the command that inserts the part:
/// "scene.xml:3:2: error: part WORLD: world.glb: ...".
[[noreturn]] void rethrow_from_part(const Command& part, const InputError& error);

}  // namespace simvis

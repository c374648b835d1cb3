// A scene under construction: the graph below ROOT, its insertion points, and the content that parts share.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/content_pool.h>
#include <simvis/export.h>
#include <simvis/node.h>
#include <simvis/object_tree.h>
#include <simvis/part_importer.h>

namespace simvis {

class NameSet;

/// The content of a part that belongs to one insertion alone.
///
/// Lifetime  the references are valid as long as the part.
struct OwnPart {
  NodePtr root;                ///< the insertion's own graph
  const PartContent& content;  ///< the shared content that it was copied from
  const NodeMap& clone_of;     ///< from the nodes of content.root to those of `root`
};

/// The steps that revert the changes of commands to the scene: of a command that fails, and of one whose result is
/// removed later. None of them may throw.
class UndoLog {
 public:
  /// How a change is reverted, and how it is made again.
  struct Step {
    std::function<void()> undo;  ///< reverts the change
    /// Makes it again if the command that reverted it fails. Empty: an element makes it again in Element::update().
    std::function<void()> redo;
    bool of_command = true;  ///< removing what the command made reverts it too
  };

  /// Adds the step that reverts a change just made. What it captures must live as long as what the command made.
  void add(std::function<void()> undo, std::function<void()> redo = {}) {
    steps_.push_back({std::move(undo), std::move(redo)});
  }
  /// Adds a step that only roll_back() takes, and not the removal of what the command made.
  void add_for_roll_back(std::function<void()> undo) { steps_.push_back({std::move(undo), {}, false}); }

  std::size_t size() const { return steps_.size(); }  ///< number of steps since the last commit()
  /// The steps since `size()` was `first` that removing what the command made reverts.
  std::vector<Step> steps_since(std::size_t first) const {
    std::vector<Step> steps;
    for (; first < steps_.size(); ++first) {
      if (steps_[first].of_command) steps.push_back(steps_[first]);
    }
    return steps;
  }
  /// Reverts the steps of an earlier command, the last one first. roll_back() makes them again.
  void take_back(std::vector<Step> steps) {
    for (; !steps.empty(); steps.pop_back()) {
      Step& step = steps.back();
      step.undo();
      steps_.push_back({std::move(step.redo), std::move(step.undo)});
    }
  }

  /// Runs all undo steps, the last one first, and clears the log.
  void roll_back() {
    while (!steps_.empty()) {
      const std::function<void()> undo = std::move(steps_.back().undo);
      steps_.pop_back();
      if (undo) undo();
    }
  }

  /// Clears the log: the commands succeeded, and their changes stay.
  void commit() { steps_.clear(); }

 private:
  std::vector<Step> steps_;
};

/// The file of a part, and what it was read for.
struct PartFile {
  std::filesystem::path file;  ///< the canonical name
  std::string needed_by;       ///< what needs its shapes, for people: "sensor \"FRONT\""; empty: they are not read
};

/// A scene under construction.
///
/// Frames    the world is ROOT's frame: x forward, y left, z up, metres.
/// Part      attributes of a part command: name, insert_at, pose_offset, quaternion; file (a relative name starts at
///           the command's folder), up, scale, unit, xacro_arguments, point_radius, point_shape, wall_height; or shape,
///           with its measures, color and texture; neither a file nor a shape makes an empty frame.
/// Names     insertion points, parts, elements and sensors have names; two of the same kind never share one.
/// Errors    InputError with the place; a command that throws may leave traces, which undo() reverts.
/// Lifetime  returned references are valid as long as the scene; those to a part and its content as long as the part.
/// Threads   one thread at a time.
class SIMVIS_API Scene {
 public:
  Scene();                             ///< ROOT alone
  Scene(Scene&&) noexcept;             ///< the other may only be assigned to or destroyed
  Scene& operator=(Scene&&) noexcept;  ///< the other may only be assigned to or destroyed
  ~Scene();

  /// Importers search these packages first, in parts that are loaded from now on.
  void set_packages(std::vector<PackageFolder> packages) { packages_ = std::move(packages); }
  const std::vector<PackageFolder>& packages() const { return packages_; }  ///< as set_packages() got them

  const GroupPtr& root() const { return root_; }  ///< the node of ROOT

  /// What a part command may carry beside file, name, insert_at, pose_offset and quaternion.
  static AttributeTable part_attributes();

  /// The content of a part command: of its file, which is read once, however often it is inserted, or its shape.
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

  /// Inserts `node` right behind an insertion point, which must exist (asserted). The node moves with what stands at
  /// the point, whatever is inserted there later.
  void insert_behind_point(std::string_view point, NodePtr node);

  /// Reads the shapes of the part `name` first. Gives it a copy of its content, so that a change of its nodes shows in
  /// no other part of the same file. Parts, elements and sensors that were inserted there do not belong to its content.
  /// Throws InputError at `where` if there is no such part (the nearest name is suggested).
  OwnPart own_part(std::string_view name, const Location& where);
  /// The content of a part, which must exist (asserted). Its shapes may be postponed.
  const PartContent& content_of(std::string_view name) const;

  /// The node that a command of this name inserted: a part's separator, or the node of an element. Null if there is
  /// none.
  NodePtr find_node(std::string_view name) const;

  /// The objects of the scene: its parts and what their files name. Valid until the scene changes.
  const ObjectTree& objects() const;
  /// The object of this name or path. Throws InputError at `where` if there is none (the nearest name is suggested);
  /// `noun` says in the message what has been expected.
  std::uint32_t find_object(std::string_view noun, std::string_view name, const Location& where) const;
  /// The objects that a value of an attribute of kind `objects` names, see ObjectTree::named(). Throws InputError at
  /// `where` for a word that names none (the nearest name is suggested).
  std::vector<std::uint32_t> find_objects(std::string_view value, const Location& where) const;

  /// Whether there is a part of this name.
  bool has_part(std::string_view name) const { return parts_.find(name) != parts_.end(); }
  /// The command that inserted a part, which must exist (asserted). Names in it are those of the whole scene.
  const Command& part_command(std::string_view name) const;
  bool has_insertion_point(std::string_view name) const;  ///< whether an object has this name, ROOT included
  /// The node of an insertion point, which must exist (asserted). The group that has it has what stands at the point,
  /// and all that is inserted there.
  const InsertionPoint& point_node(std::string_view name) const;
  /// world_from_point of an insertion point, which must exist (asserted), as the scene stands now. Empty if it stands
  /// below a switch that is off.
  std::optional<glm::dmat4> world_from_point(std::string_view name) const;

  /// Adds a warning unless it is there already: one line "FILE[:LINE[:COLUMN]]: WHAT", without the word "warning". If
  /// the command that adds it is reverted, the warning is reverted too. Throws InputError if the scene is strict.
  void warn(const std::string& warning);
  /// As warn(const std::string&), with the place in front.
  void warn(const Location& where, std::string_view what);
  /// All warnings, in the order in which they came, each once.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// From now on, a warning is an error: warn() throws InputError "FILE:LINE:COLUMN: error: WHAT".
  void make_strict() { strict_ = true; }

  /// Forgets the content of files and shapes that no part shows any more. A file is then read again.
  void forget_unused_content();

  /// From now on, parts are read without the pictures that only cameras show, until read_pictures().
  void postpone_pictures() { pool_.postpone_pictures(); }
  /// Whether parts have pictures that have not been read.
  bool has_postponed_pictures() const { return pool_.has_postponed_pictures(); }
  /// Reads the postponed pictures of all parts and puts them into their materials. What cannot be read is a warning;
  /// throws InputError if the scene is strict, and the pictures then stay postponed.
  /// `needed_by` says for whom, for pictures_needed_by().
  void read_pictures(const std::string& needed_by = "all");

  /// From now on, parts are read without their shapes where their importers can do so, until read_shapes().
  void postpone_shapes() { postpones_shapes_ = true; }
  /// Whether parts have shapes that have not been read.
  bool has_postponed_shapes() const;
  /// Reads the postponed shapes of all parts. `needed_by` says for whom, see PartFile. Throws InputError as
  /// load_part(); the shapes of this part, and of those behind it, then stay postponed.
  void read_shapes(const std::string& needed_by);
  /// The same for the part `name`; nothing happens if there is none.
  void read_shapes_of(std::string_view name, const std::string& needed_by);
  /// Says what needs the shapes of parts that are read whole, see PartFile::needed_by.
  void note_need_of_shapes(std::string needed_by) { shapes_needed_by_ = std::move(needed_by); }
  /// The files of parts that stand in the scene, in the order in which they were inserted, each once.
  std::vector<PartFile> part_files() const;
  /// What postponed pictures were last read for; empty: none were.
  const std::string& pictures_needed_by() const { return pictures_needed_by_; }

  ContentPool& pool() { return pool_; }  ///< shared content of all parts
  /// The steps that revert everything since the last commit().
  UndoLog& undo() { return undo_; }

 private:
  struct Place {
    Group* parent;
    const InsertionPoint* point;
  };
  // An object of a part's file.
  struct OwnObject {
    const InsertionPoint* point;  // says its name and kind
    std::size_t parent;           // 0: the part; otherwise 1 more than the object's place in Part::objects
  };
  struct Content;
  // One insertion of a part.
  struct Part {
    Command command;
    std::shared_ptr<Separator> separator;
    Content* content = nullptr;
    NodePtr root;      // the last child of `separator`
    NodeMap clone_of;  // empty as long as `root` is the content's own
    std::string insert_at{};
    std::uint64_t number = 0;          // of insertions before it
    std::vector<OwnObject> objects{};  // of its file
  };
  // What parts of one file, or one shape, share.
  struct Content {
    PartContent part;
    std::string shapes_needed_by{};            // empty: they are postponed
    std::vector<ShapesOfGroup> late_shapes{};  // read after the rest
  };
  std::vector<const Part*> parts_in_order() const;
  void read_shapes_of(Part& part, const std::string& needed_by);
  void complete_clone(Part& part, const std::vector<ShapesOfGroup>& shapes);
  void catch_up(Part& part);
  static void set_opacity(const Command& part, const NodePtr& root);
  Content& load_content(const Command& command);
  std::map<std::string, Content>::iterator add_content(const std::string& key, PartContent content);
  static const NodePtr& own_clone(Part& part);
  const Place& place(const Command& command) const;
  Content& load_shape(const Command& command, const AttributeValues& attributes);
  void share_graph(PartContent& content) const;
  void insert_at(const Place& place, const NodePtr& node);
  void note_child(Group* parent, const NodePtr& node);
  void remember(const Command& command, const NodePtr& node);
  void add_place(const CommandAttribute& name, const Place& place);
  void add_points(const CommandAttribute& part_name, Part& part, const std::string& prefix);
  static void add_objects(const Part& part, ObjectTree& tree);

  GroupPtr root_;
  std::map<std::string, Place, std::less<>> places_;
  std::unique_ptr<NameSet> part_names_;
  std::map<std::string, Part, std::less<>> parts_;
  std::uint64_t next_part_ = 0;
  mutable ObjectTree objects_;
  mutable bool objects_are_stale_ = false;             // parts have been taken out since they were made
  std::map<std::string, NodePtr, std::less<>> nodes_;  // of elements, by name
  // By canonical path, up axis, scale and arguments, or by shape: one file is read once.
  std::map<std::string, Content> contents_;
  std::vector<PackageFolder> packages_;
  ContentPool pool_;
  std::vector<std::string> warnings_;
  bool strict_ = false, postpones_shapes_ = false;
  std::string shapes_needed_by_, pictures_needed_by_;
  UndoLog undo_;
};

/// Throws an error from inside a part as an InputError of the command that inserts the part:
/// "scene.xml:3:2: error: part WORLD: world.glb: ...".
[[noreturn]] SIMVIS_API void rethrow_from_part(const Command& part, const InputError& error);

}  // namespace simvis

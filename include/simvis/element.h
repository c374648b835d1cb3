// Elements: freely programmable objects that change the running scene through named scalar parameters.
//
// To add an element type, add a pair of files with a class, its attribute table, and one static ElementRegistration; no
// other file changes. A class in a user's own program or in a plug-in library registers in the same way.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/export.h>
#include <simvis/scan.h>
#include <simvis/scene.h>
#include <simvis/version.h>

namespace simvis {

/// Current values of an element's live parameters, in the units and the order of its table.
using ParameterView = std::span<const double>;

/// The last scan of a scanner and the scanner's pose.
struct ObservedScan {
  const Scan* scan = nullptr;         ///< null before the first scan
  glm::dmat4 world_from_sensor{1.0};  ///< rigid, at the time of the scan
  std::uint64_t count = 0;            ///< number of scans so far; it changes with every new scan
};

/// What elements that draw for people may observe: the frame that the sensors have just measured.
///
/// Lifetime  valid during the call of Element::observe() that gets it.
class SIMVIS_API Observations {
 public:
  virtual ~Observations() = default;
  /// The last scan of a sensor. The sensor must exist and give scans; the check of the scene ensures both.
  virtual ObservedScan scan(std::string_view sensor) const = 0;
  /// Finds the pose of a mount in the world. Returns false if the mount is not reached by the traversal.
  virtual bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const = 0;
};

/// An object of the scene with parameters.
///
/// Lifetime  made from its command; update() is called once right after with every value, then in each frame in which
///           one of its parameters changed. Destroyed when its command is removed, or with the simulation.
/// Removal   what the constructor inserts with Scene's functions is taken out of the scene. A change to nodes that it
///           did not insert is reverted by the step that the constructor adds with ElementContext::scene.undo(). If the
///           request that removes the element fails, these steps are made again and then update() is called.
/// Errors    the constructor throws InputError at the command or attribute. update() gets only values that the table
///           allows; it must not throw.
/// State     an element that remembers anything between frames, beside its parameters, derives from Stateful too
///           (<simvis/state_archive.h>), so that saved states have it.
/// Threads   all calls come from the thread that calls the simulation.
class SIMVIS_API Element {
 public:
  virtual ~Element() = default;
  /// Applies the values to the scene. `values` is valid during the call only.
  virtual void update(ParameterView values) = 0;
  /// Called once before the first update() with the live rows of the type's table, in their order. It may narrow limits
  /// or set units (values outside are then refused, in the command too), remove rows that mean nothing to this element,
  /// and append rows of its own. Appended parameters start at their default; their texts must live as long as the
  /// element.
  virtual void adapt_parameters(std::vector<AttributeSpec>& /*live_rows*/) const {}
  /// Called in each frame of a scene with a visualization, after the sensors have measured and before the visualization
  /// is drawn. It may change only nodes below a VisualSeparator.
  virtual void observe(const Observations& /*seen*/) {}
  /// Whether the element moves by itself: advance() is then called in each frame, skipped ones too, unless
  /// SimulationDesc::elements_move says otherwise.
  virtual bool moves_itself() const { return false; }
  /// Brings the element to the time of the frame, after update() with what was set for the frame, in the order in which
  /// the elements were made. It may write `values`, its own live values, within their limits; update() follows. A frame
  /// that is tried again calls it again with the same time. Throws Error if the motion cannot go on: the frame then
  /// counts as not made.
  virtual void advance(std::int64_t /*time_ns*/, std::span<double> /*values*/) {}
};

/// What an element's constructor gets. It is valid during the call of ElementType::create only; `scene` stays valid as
/// long as the element.
struct ElementContext {
  const Command& command;             ///< the whole command
  const AttributeValues& attributes;  ///< checked against the type's table
  Scene& scene;                       ///< for inserting nodes at the insertion point: scene.insert(command, node)
  std::function<Element*(std::string_view)> find_element;  ///< an earlier element, by name; null if there is none
  std::uint64_t seed = 0;                                  ///< of all random numbers of the run
};

/// The description of an element type for the registry.
struct ElementType {
  std::string_view name;        ///< the command's `type`
  std::string_view summary;     ///< one sentence
  std::string_view notes{};     ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  AttributeTable attributes{};  ///< its attribute table
  std::unique_ptr<Element> (*create)(const ElementContext& context);  ///< makes an element; may throw InputError
};

/// For ElementType::create: makes an element of this class.
template <typename Made>
std::unique_ptr<Element> create_element(const ElementContext& context) {
  return std::make_unique<Made>(context);
}

/// Attributes that every element command may carry in addition to its type's own.
inline constexpr std::string_view kElementCommonAttributes[] = {"type", "name", "insert_at"};

/// A static object of this type registers an element type.
///
/// Errors    the constructor does not throw. A type whose name is taken, whose table has a mistake, or that was
///           compiled with headers of another version is refused: load_plugin() then refuses the plug-in that has it,
///           and Simulation::load() throws InputError for a type of the program itself.
/// Lifetime  strings and the table of the type must live as long as the registry.
/// Threads   any thread; other threads may look types up meanwhile.
struct SIMVIS_API ElementRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  explicit ElementRegistration(const ElementType& type, std::string_view built_for = kHeaderVersion);
};

/// The element type of this name, or null. The pointer is valid for the rest of the program, except for a type of a
/// plug-in that load_plugin() refuses.
SIMVIS_API const ElementType* find_element_type(std::string_view name);
/// All element types, sorted by name. Lifetime as find_element_type().
SIMVIS_API std::vector<const ElementType*> element_types();

}  // namespace simvis

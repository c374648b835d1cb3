// The catalogue of effects: what sensors show besides ideal measurements of ideal surfaces.
//
// An effect is called for when the scene contains its source and a due sensor's output can show it. Nothing of an
// effect that is not called for is planned, drawn, allocated, uploaded, compiled or computed.
//
// To add one: a pair of files here (and its shader part, if it has one) with one static registration: of a
// ScanEffectType (scan_effect.h), of a CameraEffectType (camera_effect.h), or, where the source is in the scene and the
// renderer does the work, of a plain EffectType. Everything that has to know of all effects loops over the catalogue:
// the check of the XML, --describe, the frame plan, the tests and bench/effects. The latter two need an example of
// each, which stands in scenes/showcase/effect_examples.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/target_limits.h>
#include <simvis/version.h>

namespace simvis {

/// What a sensor puts out. An effect says which of them can show it, as a sum of these.
enum EffectOutput : std::uint8_t { kShownInColor = 1, kShownInDepth = 2, kShownInRanges = 4 };

struct EffectType {
  std::string_view name;       ///< "range_noise"
  std::string_view summary;    ///< one sentence
  std::string_view notes{};    ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  std::string_view source;     ///< what in a scene calls for it: "attribute range_noise above 0"
  std::uint8_t outputs = 0;    ///< of EffectOutput
  std::string_view knob{};     ///< the attribute that buys accuracy with time; empty: it is exact
  std::string_view reference;  ///< what its tests compare it with: formula, publication, data sheet
  std::string_view sensors{};  ///< types, separated by spaces, whose commands may carry `attributes`
  AttributeTable attributes{};
  /// Of an effect of colour whose source is in the scene alone: whether it is there. Null where a sensor says so, or
  /// where who plans it says so.
  bool (*in_scene)(const DrawList& list) = nullptr;
  /// Adds to the plan of a frame what the effect needs once all sensors have planned, such as shadow maps. Null:
  /// nothing.
  void (*plan_frame)(const DrawList& list, const TargetLimits& limits, FramePlan& plan) = nullptr;
};

/// A static object of this type adds an effect to the catalogue; strings and tables must live as long.
/// A type whose name is taken, whose table has a mistake, or that was compiled with headers of another version is not
/// made known: load_plugin() refuses the plug-in that has it, and Simulation::load() throws InputError for one of the
/// program itself.
struct EffectRegistration {
  explicit EffectRegistration(const EffectType& type, std::string_view built_for = kHeaderVersion);

  bool accepted;
};

/// All of them, sorted by name.
std::vector<const EffectType*> effect_types();
/// One fact of an effect besides its attributes, with the label under which `--describe` prints it.
struct EffectFact {
  std::string_view label;  ///< "shown in"
  std::string value;       ///< never empty
};

/// What calls for the effect, which outputs show it, its knob and what its tests compare it with.
std::vector<EffectFact> effect_facts(const EffectType& type);

/// As `--describe` prints it: summary, notes, attributes and facts.
std::string describe_effect(const EffectType& type);

/// Null when there is none of that name.
const EffectType* find_effect_type(std::string_view name);

/// Whether sensors of this type may carry its attributes.
bool may_have(std::string_view sensor_type, const EffectType& effect);

/// Calls EffectType::plan_frame of all effects, in the order of their names.
void plan_frame_effects(const DrawList& list, const TargetLimits& limits, FramePlan& plan);

/// Adds to the plan what of the scene's effects the sensor shows, whose passes are those from `first_pass` on.
void plan_scene_effects(const std::string& sensor, std::size_t first_pass, const DrawList& list, FramePlan& plan);

/// The attributes of a sensor type: its own rows, then those of the effects that it may have, by the effects' names.
std::vector<AttributeSpec> with_effect_attributes(std::string_view sensor_type, AttributeTable own);

}  // namespace simvis

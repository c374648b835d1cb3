// The catalogue of effects: deviations of sensors from ideal measurements of ideal surfaces.
//
// An effect is active when the scene contains its source and an output of a due sensor can show it. An effect that is
// not active costs nothing: for it nothing is planned, drawn, allocated, uploaded, compiled or computed.
//
// To add an effect, add a pair of files (and its shader part, if it has one) with one static registration: of a
// ScanEffectType (scan_effect.h), of a CameraEffectType (camera_effect.h), or of a plain EffectType if the source is in
// the scene and the renderer does the work. All code that handles every effect loops over the catalogue: the check of
// the XML, --describe, the frame plan, the tests and bench/effects. The tests and bench/effects need an example of each
// effect in scenes/showcase/effect_examples.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/version.h>

namespace simvis {

/// The outputs of sensors. An effect states which of them can show it, as a sum of these values.
enum EffectOutput : std::uint8_t {
  kShownInColor = 1,  ///< colour images
  kShownInDepth = 2,  ///< depth images
  kShownInRanges = 4  ///< ranges of laser scanners
};

/// What the sensors of a type have. Effects, the command line and reports ask for it instead of for the name of a type,
/// so that a type of a plug-in counts like one of SimVis. The values are summed.
enum SensorCapability : std::uint8_t {
  /// Measures ranges along beams: Sensor::scan() is never null, and the sensor calls the stages of its scan effects
  /// (scan_effect.h). If its table has the attributes `method`, `resolution`, `max_error_m` and `max_error_rel`, they
  /// mean what they mean for a laser_scanner: --method, --max-error and --price set them.
  kCastsBeams = 1,
  kHasImageSensor = 2,  ///< Collects light in pixels: calls CameraEffect::post_process() (camera_effect.h).
  kHasPixelRays = 4,    ///< Each pixel may look along a ray of its own: calls CameraEffect::configure_rays().
  kSeesSplats = 8,      ///< What it measures shows Gaussian splats. Others are warned of, see docs/gaussian-splats.md.
  /// Sees through a lens: calls CameraEffect::configure_rays() for what it sets but times of rows and the exposure.
  kHasLens = 16,
  kShowsSurfaces = 32,  ///< Its attribute `outputs` has the words of all outputs that show surfaces of pixels.
  /// With kSeesSplats: the caster that Sensor::cast() gets also hits splats, where half of the light of a ray is left.
  kRaysHitSplats = 64
};

/// The description of an effect for the catalogue.
struct EffectType {
  std::string_view name;       ///< "range_noise"
  std::string_view summary;    ///< one sentence
  std::string_view notes{};    ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  std::string_view source;     ///< what in a scene makes it active: "attribute range_noise above 0"
  std::uint8_t outputs = 0;    ///< the outputs that can show it, as a sum of EffectOutput
  std::string_view knob{};     ///< the attribute that trades time for accuracy; empty: the effect is exact
  std::string_view reference;  ///< what its tests compare it with: formula, publication, data sheet
  std::uint8_t needs = 0;      ///< sum of SensorCapability; sensors that have all of it may carry `attributes`; 0: none
  AttributeTable attributes{};  ///< its rows in these sensors' tables
  /// For an effect on colour whose source is in the scene alone: whether the source is there. Null if a sensor's
  /// attributes decide, or if the code that plans the effect decides.
  bool (*in_scene)(const DrawList& list) = nullptr;
  /// Adds to the plan of a frame what the effect needs once all sensors have planned, such as shadow maps. Null:
  /// nothing.
  void (*plan_frame)(const DrawList& list, const TargetLimits& limits, FramePlan& plan) = nullptr;
};

/// A static object of this type adds an effect to the catalogue.
///
/// Errors    the constructor does not throw. A type whose name is taken, whose table has a mistake, or that was
///           compiled with headers of another version is refused: load_plugin() then refuses the plug-in that has it,
///           and Simulation::load() throws InputError for a type of the program itself.
/// Lifetime  strings and tables of the type must live as long as the catalogue.
/// Threads   any thread; other threads may look types up meanwhile.
struct SIMVIS_API EffectRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  explicit EffectRegistration(const EffectType& type, std::string_view built_for = kHeaderVersion);

  bool accepted;  ///< false: the type was refused
};

/// All effects, sorted by name. The pointers are valid for the rest of the program, except for types of a plug-in that
/// load_plugin() refuses.
SIMVIS_API std::vector<const EffectType*> effect_types();

/// The effect of this name, or null. Lifetime as effect_types().
SIMVIS_API const EffectType* find_effect_type(std::string_view name);

/// Whether sensors with these capabilities, a sum of SensorCapability, may carry the effect's attributes.
SIMVIS_API bool may_have(std::uint8_t capabilities, const EffectType& effect);

/// Calls EffectType::plan_frame of all effects, in the order of their names.
SIMVIS_API void plan_frame_effects(const DrawList& list, const TargetLimits& limits, FramePlan& plan);

/// Adds to the plan those effects of the scene that the sensor shows. The sensor's passes are those from `first_pass`
/// on.
SIMVIS_API void plan_scene_effects(const std::string& sensor, std::size_t first_pass, const DrawList& list,
                                   FramePlan& plan);

/// The attributes of a sensor type with these capabilities: its own rows, then the rows of the effects that it may
/// have, sorted by the effects' names.
SIMVIS_API std::vector<AttributeSpec> with_effect_attributes(std::uint8_t capabilities, AttributeTable own);

}  // namespace simvis

// How a scene has each effect, for the tests and the benchmark, which put these into every scene: data, and what reads
// it.
//
// File names start at the folder of a scene beside this one.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

namespace simvis {

/// An effect as XML: attributes of a sensor of each type that may have it, and whole commands. Names in the commands
/// begin with EFFECT, which example_commands() makes unique. Of an example with a pose EFFECT_DRIVE the user changes y
/// from frame to frame.
struct EffectExample {
  std::string_view effect;
  std::string_view attributes{};      ///< with which a sensor has the effect
  std::string_view off_attributes{};  ///< the same attributes at values at which there is no effect
  std::string_view parts{};           ///< commands that stand before each of the following three
  std::string_view commands{};        ///< with which the scene has the effect
  std::string_view off_commands{};    ///< the same commands at values at which there is no effect
  std::string_view plain_commands{};  ///< the same commands with nothing that names the effect
  std::string_view knob_values{};     ///< of EffectType::knob, separated by spaces; the last one is the most exact
};

inline constexpr EffectExample kEffectExamples[] = {
    // Of scanners.
    {.effect = "angular_noise", .attributes = R"(angular_noise="0.1")", .off_attributes = R"(angular_noise="0")"},
    {.effect = "atmosphere",
     .commands = R"(<element type="fog" name="EFFECT" insert_at="ROOT" visibility="20"/>)",
     .off_commands = R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="rain" rain_rate="0"/>)"},
    {.effect = "beam_divergence",
     .attributes = R"(divergence="0.5" divergence_samples="16")",
     .off_attributes = R"(divergence="0" divergence_samples="16")",
     .knob_values = "4 16 64 256"},
    {.effect = "blooming",
     .attributes = R"(bloom="0.3" bloom_angle="5" bloom_samples="16" bloom_power="0")",
     .off_attributes = R"(bloom="0" bloom_angle="5" bloom_samples="16" bloom_power="0")",
     .knob_values = "4 16 64"},
    {.effect = "crosstalk",
     .attributes = R"(crosstalk="*_OTHER" sweep="2e-5" beam_diameter="1")",
     .off_attributes = R"(beam_diameter="1")",
     .parts = R"(<part name="EFFECT_OTHER" insert_at="ROOT" pose_offset="-3.6 2.2 0.9 0 0 0"/>)"},
    {.effect = "dropout",
     .attributes = R"(dropout="0.1" dropout_power="0.01")",
     .off_attributes = R"(dropout="0" dropout_power="0")"},
    {.effect = "dual_return",
     .attributes = R"(return="dual" divergence="0.2" divergence_samples="8")",
     .off_attributes = R"(return="strongest" divergence="0" divergence_samples="8")"},
    {.effect = "intensity", .attributes = R"(intensity="on")", .off_attributes = R"(intensity="off")"},
    {.effect = "range_noise",
     .attributes = R"(range_noise="0.02" range_noise_rel="0.001")",
     .off_attributes = R"(range_noise="0" range_noise_rel="0")"},
    {.effect = "range_resolution",
     .attributes = R"(range_resolution="0.01")",
     .off_attributes = R"(range_resolution="0")"},
    {.effect = "reflectivity", .attributes = R"(reflectivity="on")", .off_attributes = R"(reflectivity="off")"},
    {.effect = "retro_reflection",
     .attributes = R"(intensity="on")",
     .off_attributes = R"(intensity="off")",
     .parts =
         R"(<part file="../showcase/sign.glb" name="EFFECT_SIGN" insert_at="ROOT" pose_offset="2.3 -0.4 0.8 0 0 0"/>)",
     .commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_SIGN" )"
                 R"(retro_reflectance="500"/>)",
     .off_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_SIGN" )"
                     R"(retro_reflectance="0"/>)",
     .plain_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_SIGN"/>)"},
    {.effect = "returns",
     .attributes = R"(return="last" pulse_length="0.5")",
     .off_attributes = R"(return="strongest")"},
    {.effect = "specular_path",
     .attributes = R"(path_depth="4")",
     .off_attributes = R"(path_depth="0")",
     .parts =
         R"(<part file="../showcase/mirror.glb" name="EFFECT_MIRROR" insert_at="ROOT" pose_offset="0.2 0.3 0 0 0 -30"/>)",
     .commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_MIRROR" mirror="1"/>)",
     .off_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_MIRROR"/>)",
     .plain_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_MIRROR"/>)",
     .knob_values = "1 2 4"},
    {.effect = "sunlight",
     .attributes = R"(sunlight="30" dropout_power="0.01")",
     .off_attributes = R"(sunlight="0" dropout_power="0")"},
    {.effect = "sweep_motion", .attributes = R"(sweep="0.02" sweep_direction="cw")", .off_attributes = R"(sweep="0")"},
    // Of cameras.
    {.effect = "auto_exposure",
     .attributes = R"(auto_exposure="0.18" auto_exposure_time="0.1")",
     .off_attributes = R"(auto_exposure="0" auto_exposure_time="0.1")"},
    {.effect = "bayer_mosaic",
     .attributes = R"(bayer="rggb" demosaic="bilinear")",
     .off_attributes = R"(bayer="none" demosaic="none")"},
    {.effect = "chromatic_aberration",
     .attributes = R"(color_magnification="1.02 1 0.97")",
     .off_attributes = R"(color_magnification="1 1 1")"},
    {.effect = "depth_of_field",
     .attributes = R"(aperture="0.1" focus_distance="2.5" lens_samples="16")",
     .off_attributes = R"(aperture="0" focus_distance="2.5" lens_samples="16")",
     .knob_values = "16 64 256"},
    {.effect = "exposure", .attributes = R"(exposure="2")", .off_attributes = R"(exposure="1")"},
    {.effect = "lens_distortion",
     .attributes = R"(distortion="brown_conrady" k1="-0.2" k2="0.05" lens_oversampling="2")",
     .off_attributes = R"(distortion="none" k1="-0.2" k2="0.05")",
     .knob_values = "1 2 4 8"},
    {.effect = "motion_blur",
     .attributes = R"(exposure_time="0.03" motion_samples="4")",
     .off_attributes = R"(exposure_time="0" motion_samples="4")",
     .parts = R"(<part name="EFFECT_BOX" shape="box" size="0.3 0.3 0.3" insert_at="ROOT" )"
              R"(pose_offset="-2 -0.4 0.9 0 0 0"/><element type="pose" name="EFFECT_DRIVE" insert_at="EFFECT_BOX"/>)",
     .knob_values = "4 16 64 256"},
    {.effect = "rolling_shutter",
     .attributes = R"(row_time="2e-5" rows_per_pose="16")",
     .off_attributes = R"(row_time="0" rows_per_pose="16")",
     .knob_values = "32 8 2 1"},
    {.effect = "sensor_noise",
     .attributes = R"(full_well_e="10000" read_noise_e="4" adc_bits="10")",
     .off_attributes = R"(full_well_e="0" read_noise_e="4" adc_bits="10")"},
    {.effect = "vignetting",
     .attributes = R"(vignetting="natural")",
     .off_attributes = R"(vignetting="none" v1="-0.3")"},
    // Of the scene.
    {.effect = "area_lights",
     .commands = R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38" shadows="yes" )"
                 R"(shadow_resolution="512" angular_radius="2" lamp_points="8"/>)",
     .off_commands = R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38" )"
                     R"(shadows="yes" shadow_resolution="512" angular_radius="0"/>)",
     .plain_commands = R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38" )"
                       R"(shadows="yes" shadow_resolution="512"/>)",
     .knob_values = "4 8 16 32"},
    {.effect = "fog",
     .commands = R"(<element type="fog" name="EFFECT" insert_at="ROOT" visibility="20"/>)",
     .off_commands = R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="rain" rain_rate="0"/>)"},
    {.effect = "gaussian_splats",
     .parts = R"(<part name="EFFECT_AT" insert_at="ROOT" pose_offset="-2 0 0.4 0 0 0"/>)",
     .commands = R"(<element type="visibility" name="EFFECT" insert_at="EFFECT_AT" visible="1"/>)"
                 R"(<part file="../showcase/bush.ply" name="EFFECT_BUSH" insert_at="EFFECT_AT"/>)",
     .off_commands = R"(<element type="visibility" name="EFFECT" insert_at="EFFECT_AT" visible="0"/>)"
                     R"(<part file="../showcase/bush.ply" name="EFFECT_BUSH" insert_at="EFFECT_AT"/>)"},
    {.effect = "metallic_roughness",
     .commands =
         R"(<part file="../showcase/metal.glb" name="EFFECT" insert_at="ROOT" pose_offset="-1.6 0 0.7 0 0 0"/>)",
     .off_commands =
         R"(<part file="../showcase/metal_matte.glb" name="EFFECT" insert_at="ROOT" pose_offset="-1.6 0 0.7 0 0 0"/>)",
     .plain_commands =
         R"(<part file="../showcase/metal_matte.glb" name="EFFECT" insert_at="ROOT" pose_offset="-1.6 0 0.7 0 0 0"/>)"},
    {.effect = "normal_maps",
     .commands = R"(<part file="../showcase/relief.glb" name="EFFECT" insert_at="ROOT" pose_offset="-2 0.4 1 0 0 0"/>)",
     .off_commands =
         R"(<part file="../showcase/relief_flat.glb" name="EFFECT" insert_at="ROOT" pose_offset="-2 0.4 1 0 0 0"/>)",
     .plain_commands =
         R"(<part file="../showcase/relief_flat.glb" name="EFFECT" insert_at="ROOT" pose_offset="-2 0.4 1 0 0 0"/>)"},
    {.effect = "shadows",
     .commands = R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38" shadows="yes" )"
                 R"(shadow_resolution="1024"/>)",
     .off_commands =
         R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38" shadows="no"/>)",
     .plain_commands = R"(<element type="light" name="EFFECT" insert_at="ROOT" azimuth="-142" elevation="38"/>)",
     .knob_values = "256 512 1024 2048 4096"},
    {.effect = "transparency",
     .parts =
         R"(<part file="../showcase/ball.glb" name="EFFECT_BALL" insert_at="ROOT" pose_offset="-1.5 -0.4 1 0 0 0"/>)",
     .commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL" opacity="0.6"/>)",
     .off_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL" opacity="1"/>)",
     .plain_commands = R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL"/>)"},
};

/// A kind of weather in which scanners have the effect `atmosphere`, whose example has fog.
struct WeatherExample {
  std::string_view kind, commands;
};

inline constexpr WeatherExample kWeatherExamples[] = {
    {"rain", R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="rain" rain_rate="20"/>)"},
    {"snow", R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="snow" snow_rate="2"/>)"},
    {"dust", R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="dust" visibility="20"/>)"},
    {"sand", R"(<element type="fog" name="EFFECT" insert_at="ROOT" kind="dust" visibility="20" )"
             R"(grain_diameter="2e-4"/>)"},
};

/// The example of the effect of this name, as EffectType::name has it; null where there is none.
inline const EffectExample* find_effect_example(std::string_view effect) {
  const auto found = std::ranges::find(kEffectExamples, effect, &EffectExample::effect);
  return found == std::end(kEffectExamples) ? nullptr : &*found;
}

/// `commands`, which are of the example, behind its parts, under names that no other effect's commands have.
inline std::string example_commands(const EffectExample& example, std::string_view commands) {
  constexpr std::string_view kMark = "EFFECT";
  const std::string name = std::string(kMark) + '_' + std::string(example.effect);
  std::string text = std::string(example.parts) + std::string(commands);
  for (std::size_t at = text.find(kMark); at != text.npos; at = text.find(kMark, at + name.size())) {
    text.replace(at, kMark.size(), name);
  }
  return text;
}

/// Moves what examples have to be moved, before frame `frame` of the simulation.
template <typename Simulation>
void drive_examples(Simulation& simulation, int frame) {
  for (const auto& element : simulation.parameters().elements()) {
    if (!element.removed && element.name.ends_with("_DRIVE")) simulation.set(element.name, "y", 0.1 * frame);
  }
}

/// Attributes of both, as XML; where both have one, that of `a`.
inline std::string join_attributes(std::string_view a, std::string_view b) {
  std::string joined(a);
  while (true) {
    const std::size_t name = b.find_first_not_of(' '), equals = b.find('='), open = b.find('"');
    const std::size_t close = open == b.npos ? b.npos : b.find('"', open + 1);
    if (close == b.npos) return joined;
    const std::string written = ' ' + std::string(b.substr(name, equals - name)) + '=';
    if ((' ' + joined).find(written) == std::string::npos) {
      joined += ' ' + std::string(b.substr(name, close + 1 - name));
    }
    b.remove_prefix(close + 1);
  }
}

}  // namespace simvis

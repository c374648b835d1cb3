// COLLADA's transparency as old exporters write it. Expected opacities follow from the format's text, COLLADA 1.4.1,
// "Determining transparency": A_ONE (the default) is a * transparency, RGB_ZERO is 1 - luminance(rgb) * transparency;
// and from what other programs show:
// - RViz: RobotLink::updateAlpha() replaces the opacity of a robot's meshes by the robot's own, which is 1.
// - Gazebo: ColladaLoader::LoadTransparent() takes a <transparent> without `opaque` as opaque.
// - Torque 3D: conditioner_fixupTransparency() reads <transparent> without `opaque` as RGB_ZERO for these exporters.
// - Assimp's viewer and three.js follow the text, so that the models below are invisible in them.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string asset_of(const std::string& tool) {
  return "<contributor><authoring_tool>" + tool + "</authoring_tool></contributor>" + kMetresZUp;
}

std::string shader(const std::string& transparency) {
  return "<diffuse><color>1 0.5 0 1</color></diffuse>\n" + transparency;
}

Loaded load_box(const TemporaryFolder& folder, const std::string& tool, const std::string& transparency) {
  write_text(folder / "box.dae", dae_box(asset_of(tool), 1, "", shader(transparency)));
  return load(folder / "box.dae");
}

constexpr const char* kIllusoft = "Blender v:249 - Illusoft Collada Exporter v:0.3.162";

}  // namespace

TEST_CASE("COLLADA: opacity as exporters mean it") {
  struct Idiom {
    const char *tool, *transparency;
    double opacity;
    const char *first_warning, *second_warning;  // empty: none
  };
  const char *clear = "is wholly transparent; it is read as opaque", *inverted = "means RGB_ZERO there",
             *outside = "has an opacity outside 0 to 1; it is read as opaque";
  const Idiom idioms[] = {
      // Blender 2.49 writes [1, 1, 1, 1] and 1 - alpha.
      {kIllusoft, "<transparent><color>1 1 1 1</color></transparent><transparency><float>0.0</float></transparency>", 1,
       inverted, ""},
      {kIllusoft, "<transparent><color>1 1 1 1</color></transparent><transparency><float>0.25</float></transparency>",
       0.75, inverted, ""},
      {kIllusoft, "<transparent><color>0 0 0 1</color></transparent><transparency><float>0.0</float></transparency>", 1,
       inverted, ""},
      {"Google SketchUp 7.1.6860",
       "<transparent><color>1 1 1 1</color></transparent><transparency><float>0.0</float></transparency>", 1, inverted,
       ""},
      // The same exporter on a machine whose decimals follow a comma.
      {"FBX COLLADA exporter",
       "<transparent><color>1,0 1,0 1,0 1,0</color></transparent><transparency><float>0,25</float></transparency>",
       0.75, inverted, ""},
      // MeshLab writes this constant for every material.
      {"VCGLib | MeshLab",
       "<transparent><color>0 0 0 1</color></transparent><transparency><float>0</float></transparency>", 1, clear, ""},
      {"", "<transparent><color>1 1 1 1</color></transparent><transparency><float>0</float></transparency>", 1, clear,
       ""},
      {"", "<transparent opaque=\"RGB_ZERO\"><color>1 1 1 1</color></transparent>", 1, clear, ""},
      {kIllusoft, "<transparent><color>1 1 1 1</color></transparent><transparency><float>1</float></transparency>", 1,
       inverted, clear},
      {"", "<transparency><float>0</float></transparency>", 1, clear, ""},
      {"", "<transparent><color>1 1 1 1</color></transparent><transparency><float>100</float></transparency>", 1,
       outside, ""},
      // By the text, without a warning.
      {"FBX COLLADA exporter",
       "<transparent opaque=\"RGB_ZERO\"><color>1 1 1 1</color></transparent><transparency><float>0</float>"
       "</transparency>",
       1, "", ""},
      {"FBX COLLADA exporter",
       "<transparent opaque=\"RGB_ZERO\"><color>1 1 1 1</color></transparent><transparency><float>0.25</float>"
       "</transparency>",
       0.75, "", ""},
      {"OpenCOLLADA for 3ds Max",
       "<transparent opaque=\"RGB_ZERO\"><color>0 0 0 1</color></transparent><transparency><float>1</float>"
       "</transparency>",
       1, "", ""},
      {"Blender 2.79", "<transparent opaque=\"A_ONE\"><color>0 0 0 0.5</color></transparent>", 0.5, "", ""},
      {"", "<transparent><color>1 1 1 0.5</color></transparent><transparency><float>0.5</float></transparency>", 0.25,
       "", ""},
      {"", "<transparency><float>0.5</float></transparency>", 0.5, "", ""},
      {kIllusoft, "<transparency><float>0.5</float></transparency>", 0.5, "", ""},
      {"", "", 1, "", ""},
  };
  TemporaryFolder folder;
  for (const Idiom& idiom : idioms) {
    CAPTURE(std::string(idiom.tool));
    CAPTURE(std::string(idiom.transparency));
    const Loaded loaded = load_box(folder, idiom.tool, idiom.transparency);
    check_box(loaded.list);
    const Material& material = *loaded.list.materials.at(0);
    // Assimp multiplies luminances and transparency as float32: three roundings.
    const double roundings = 3 * 0x1p-24;
    CHECK(std::abs(static_cast<double>(material.base_color.a) - idiom.opacity) <= roundings);
    CHECK(material.alpha_mode == (idiom.opacity < 1 ? AlphaMode::blend : AlphaMode::opaque));
    const std::size_t warnings = (*idiom.first_warning != '\0' ? 1 : 0) + (*idiom.second_warning != '\0' ? 1 : 0);
    REQUIRE(loaded.warnings.size() == warnings);
    if (warnings > 0) {
      CHECK(loaded.warnings[0].starts_with((folder / "box.dae").string() + ":2:"));
      CHECK(contains(loaded.warnings[0], idiom.first_warning));
    }
    if (warnings > 1) CHECK(contains(loaded.warnings[1], idiom.second_warning));
  }
}

TEST_CASE("COLLADA: one warning stands for all effects with one idiom") {
  TemporaryFolder folder;
  std::string text = dae_box(asset_of("MeshLab"), 1, "", shader("<transparency><float>0</float></transparency>"));
  const std::size_t end = text.find("</library_effects>");
  REQUIRE(end != std::string::npos);
  text.insert(end,
              "<effect id=\"f\"><profile_COMMON><technique sid=\"t\"><phong><transparency><float>0</float>"
              "</transparency></phong></technique></profile_COMMON></effect>");
  write_text(folder / "two.dae", text);
  const Loaded loaded = load(folder / "two.dae");
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "effect \"e\" (and 1 more): is wholly transparent"));
}

TEST_SUITE_END();

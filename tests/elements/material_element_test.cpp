// The element material: what a camera and a laser see of a part and of another part from the same file.
#include "scenegraph/flattener.h"
#include "shaders/interop.h"
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

const glm::dvec3 kNewPaint(0.8, 0.4, 0.2), kBackground(0.55, 0.68, 0.85);
constexpr double kIrradiance_lux = 2;

// Two plates in one file, 4 m ahead: the left one of paint, the right one of metal.
GltfBuilder two_plates() {
  GltfBuilder file;
  const int paint = file.append("materials", painted("Paint", glm::vec4(kNewPaint, 1)));
  const int metal = file.append("materials", painted("Metal", {0.5f, 0.5f, 0.5f, 1}));
  add_plate(file, {.right = -0.5}, paint);
  add_plate(file, {.left = -0.5}, metal);
  return file;
}

// The camera's middle pixel sees the paint, its rightmost column the metal. Light comes from behind the camera.
const std::string kTwoPlates = R"(<part file="plates.gltf" name="PLATES" insert_at="ROOT" up="z"/>)";
const std::string kSun =
    R"(<element type="light" name="SUN" insert_at="ROOT" azimuth="180" elevation="0" intensity="2"/>)";
const std::string kMaterialScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="1" min_angle="0" method="planar"/>)";

std::string changed(const std::string& attributes, const std::string& name = "M") {
  return "<element type='material' name='" + name + "' insert_at='ROOT' part='PLATES' " + attributes + "/>";
}
World plates(const std::string& commands) {
  return World({{"plates.gltf", two_plates()}}, kTwoPlates + kDark + kSun + kCamera + commands);
}

TEST_CASE("a material without attributes stays as in the file to the bit") {
  World plain = plates(""), same = plates(changed(""));
  CHECK(plain.color() == same.color());
  CHECK(same->diagnostics().draw_list().materials.at(0)->roughness == 1);
}

TEST_CASE("colours are factors and emission is added, for each channel separately") {
  World world = plates(changed(""));
  const glm::dvec3 matte = kNewPaint / kPi * kIrradiance_lux;
  check_color(world.color(), matte);
  check_color(world.color_with("M", "red", 0.5), matte * glm::dvec3(0.5, 1, 1));
  check_color(world.color_with("M", "green", 0.25), matte * glm::dvec3(0.5, 0.25, 1));
  check_color(world.color_with("M", "blue", 3), matte * glm::dvec3(0.5, 0.25, 3));
  const glm::dvec3 dyed = matte * glm::dvec3(0.5, 0.25, 3);
  check_color(world.color_with("M", "emission_red", 0.1), dyed + glm::dvec3(0.1, 0, 0));
  check_color(world.color_with("M", "emission_green", 2), dyed + glm::dvec3(0.1, 2, 0));
  check_color(world.color_with("M", "emission_blue", 0.3), dyed + glm::dvec3(0.1, 2, 0.3));
}

TEST_CASE("a change of colour uploads the block of that material only") {
  World world = plates(changed("material='Paint'"));
  world.color();
  world.color();
  const std::uint64_t still = world->diagnostics().counters().bytes_uploaded;
  world.color_with("M", "red", 0.5);
  CHECK(world->diagnostics().counters().bytes_uploaded == still + sizeof(shader::MaterialBlock));
}

TEST_CASE("only the named material changes; the colour multiplies the texture") {
  World world = plates(changed("material='Metal' red='0'"));
  check_color(world.color(), kNewPaint / kPi * kIrradiance_lux);
  check_color(world.color(kSide_px - 1), glm::dvec3(0, 0.5, 0.5) / kPi * kIrradiance_lux);

  GltfBuilder file;
  const int image =
      file.append("images", {{"uri", "data:image/png;base64," + base64(png(1, 1, 8, 2, {{188, 188, 188}}))}});
  json material = unlit("Print", {0.5f, 1, 1, 1});
  material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = file.append("textures", {{"source", image}});
  add_plate(file, {}, file.append("materials", material));
  World printed({{"plates.gltf", file}}, kTwoPlates + kCamera + changed("red='0.5' green='0.5'"));
  // The driver may decode sRGB by a table or a polynomial: an error of at most half a step of 8 bits in linear light.
  constexpr double kTexel = 0.5 / 255;
  const double texel = std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
  const glm::dvec3 seen = printed.color();
  CHECK(std::abs(seen.r - 0.25 * texel) <= kTexel);
  CHECK(std::abs(seen.g - 0.5 * texel) <= kTexel);
  CHECK(std::abs(seen.b - texel) <= kTexel);
}

TEST_CASE(
    "below an opacity of 1 the background is visible, below one half depth sensors ignore the part, at 0 it is not "
    "drawn") {
  World world = plates(changed("material='Paint'") + kMaterialScanner);
  const glm::dvec3 matte = kNewPaint / kPi * kIrradiance_lux;
  const auto depth = [&] { return world->depth("CAM").pixels[kSide_px * kSide_px / 2]; };
  // Depth and range of a wall perpendicular to the beam: float32 throughout, and the scanner's own bound.
  constexpr double kDepth_m = 4 * 16 * 0x1p-24;
  for (const double opacity : {1.0, 0.75, 0.5, 0.4, 0.1}) {
    CAPTURE(opacity);
    check_color(world.color_with("M", "opacity", opacity), matte * opacity + kBackground * (1 - opacity));
    const Scan& scan = world->scan("SCAN");
    if (opacity >= 0.5) {
      CHECK(std::abs(depth() - 4) <= kDepth_m);
      CHECK(std::abs(scan.range_m[0] - 4) <= scan.error_bound_m[0]);
    } else {
      CHECK(std::isinf(depth()));
      CHECK(std::isinf(scan.range_m[0]));
    }
  }
  world->enable("SCAN", false);
  check_color(world.color_with("M", "opacity", 0), kBackground);
  CHECK(world->diagnostics().counters().draws == 1);  // the metal
  CHECK(world->diagnostics().counters().triangles == 2);
}

// Radiance from one light of irradiance `lux` on a surface perpendicular to it, in double: glTF 2.0, appendix B, with
// the visibility function of Heitz (2014). Vectors have unit length.
glm::dvec3 glossy(const glm::dvec3& albedo, double roughness, const glm::dvec3& n, const glm::dvec3& l,
                  const glm::dvec3& v, double lux) {
  const glm::dvec3 h = glm::normalize(l + v);
  const double alpha = roughness * roughness, a2 = alpha * alpha;
  const double nl = glm::dot(n, l), nv = glm::dot(n, v), nh = glm::dot(n, h);
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double visible = 0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
  const double f = 0.04 + 0.96 * std::pow(1 - glm::dot(v, h), 5);
  return lux * nl * ((1 - f) * albedo / kPi + glm::dvec3(f * d * visible));
}

TEST_CASE("below a roughness of 1 lights have the highlight of a glTF dielectric") {
  World world = plates(changed("material='Paint'") +
                       R"(<element type="light" name="LAMP" insert_at="ROOT" kind="point" intensity="0"/>)");
  const glm::dvec3 n(-1, 0, 0);
  const double step = 2 * std::tan(30 * kPi / 180) / kSide_px;
  for (const double roughness : {0.9, 0.5, 0.2, 0.05}) {
    // float32 turns the directions by about 16 u. The slope of the distribution's logarithm is at most 2 / alpha.
    const double tolerance = kShading + 2 / (roughness * roughness) * 16 * 0x1p-24;
    world->set("M", "roughness", roughness);
    for (const double azimuth_deg : {180.0, 150.0, 110.0}) {
      for (const int x : {4, 3, 1}) {
        CAPTURE(roughness);
        CAPTURE(azimuth_deg);
        CAPTURE(x);
        world->set("SUN", "azimuth", azimuth_deg);
        const double a = azimuth_deg * kPi / 180;
        const glm::dvec3 l(std::cos(a), std::sin(a), 0);
        const glm::dvec3 v = -glm::normalize(glm::dvec3(1, (4 - x) * step, 0));
        check_color(world.color(x, 4), glossy(kNewPaint, roughness, n, l, v, kIrradiance_lux), tolerance);
      }
    }
  }
  // A lamp at (2, 1, 0): the wall's point (4, 0, 0) is sqrt(5) m away.
  world->set("SUN", "intensity", 0);
  world->set("LAMP", "intensity", 10);
  world->set("LAMP", "x", 2);
  world->set("LAMP", "y", 1);
  const glm::dvec3 seen = world.color_with("M", "roughness", 0.4);
  const glm::dvec3 l = glm::normalize(glm::dvec3(-2, 1, 0));
  check_color(seen, glossy(kNewPaint, 0.4, n, l, n, 10 / 5.0), kShading + 2 / 0.16 * 16 * 0x1p-24);
}

TEST_CASE("roughness below the minimum equals the minimum, and only glossy parts cost more") {
  World world = plates(changed("material='Paint'"));
  world.color();
  const std::uint64_t pipelines = world->diagnostics().counters().pipelines_bound;
  CHECK(pipelines == 1);  // both plates use the same pipeline
  const glm::dvec3 least = world.color_with("M", "roughness", kMinRoughness);
  CHECK(world->diagnostics().counters().pipelines_bound == 2);
  CHECK(world.color_with("M", "roughness", 0) == least);
  check_color(world.color(kSide_px - 1), glm::dvec3(0.5) / kPi * kIrradiance_lux);
}

TEST_CASE("another part from the same file keeps its look") {
  World world({{"plates.gltf", two_plates()}},
              kTwoPlates +
                  R"(<part file="plates.gltf" name="BEHIND" insert_at="ROOT" up="z" pose_offset="1 0 0 0 0 0"/>)" +
                  kDark + kSun + kCamera + changed("opacity='0'"));
  check_color(world.color(), kNewPaint / kPi * kIrradiance_lux);
  CHECK(world->depth("CAM").pixels[kSide_px * kSide_px / 2] == doctest::Approx(5));
}

// The draw list of a scene after its two elements were set in this order.
DrawList after(BuiltScene& built, std::vector<std::pair<std::string, double>> red) {
  for (const auto& [element, value] : red) {
    built.parameters.set(built.parameters.index(element, "red"), value);
    for (const std::size_t i : built.parameters.drain_changed_elements()) {
      const ElementDescriptor& each = built.parameters.elements()[i];
      built.elements[i]->update(built.parameters.values().subspan(each.first_value, each.parameters.size()));
    }
  }
  return Flattener(built.scene.root()).update();
}

struct PlatesOnDisk {
  PlatesOnDisk() { write_text(folder / "plates.gltf", two_plates().text()); }
  BuiltScene build(const std::string& commands) const {
    return build_scene(parse_commands(kTwoPlates + commands, "s.xml", folder.path()));
  }
  TemporaryFolder folder;
};

TEST_CASE("several elements on one part are combined, independent of the order of changes") {
  const PlatesOnDisk plates;
  const std::string both =
      changed("opacity='0.5' emission_red='1'", "A") + changed("material='Paint' opacity='0.5' emission_red='2'", "B");
  BuiltScene one = plates.build(both), other = plates.build(both);
  const DrawList list = after(one, {{"A", 0.25}, {"B", 0.5}});
  CHECK(same_content(list, after(other, {{"B", 0.5}, {"A", 0.25}})));
  const Material& paint = *list.materials.at(0);
  const Material& metal = *list.materials.at(1);
  CHECK(paint.base_color.r == static_cast<float>(static_cast<double>(0.8f) * 0.125));
  CHECK(paint.opacity == 0.25f);
  CHECK(paint.emissive == glm::vec3(3, 0, 0));
  CHECK(metal.base_color.r == 0.125f);
  CHECK(metal.opacity == 0.5f);
}

TEST_CASE("an opacity that replaces the file's: of one part, of one material, before the factors") {
  const PlatesOnDisk plates;
  write_text(plates.folder / "glass.mtl", "newmtl glass\nd 0.25\n");
  write_text(plates.folder / "glass.obj", "mtllib glass.mtl\nusemtl glass\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto glass = [](const std::string& name, const std::string& attributes) {
    return "<part file='glass.obj' name='" + name + "' insert_at='ROOT' " + attributes + "/>";
  };
  const auto element = [](const std::string& attributes) {
    return "<element type='material' name='M' insert_at='ROOT' part='B' " + attributes + "/>";
  };
  BuiltScene parts = plates.build(glass("A", "") + glass("B", "opacity='1'") + glass("C", "opacity='0.5'"));
  const auto material = [](const BuiltScene& built, const std::string& name, float opacity, float alpha,
                           AlphaMode mode) {
    CAPTURE(name);
    const DrawList list = Flattener(built.scene.root()).update();
    const std::size_t item = list.items.size() - 3 + static_cast<std::size_t>(name[0] - 'A');
    const Material& shown = *list.materials.at(list.items.at(item).material);
    CHECK(shown.opacity == opacity);
    CHECK(shown.base_color.a == alpha);
    CHECK(shown.alpha_mode == mode);
  };
  material(parts, "A", 1, 0.25f, AlphaMode::blend);
  material(parts, "B", 1, 1, AlphaMode::opaque);
  material(parts, "C", 0.5f, 1, AlphaMode::opaque);

  BuiltScene changed_later =
      plates.build(glass("A", "") + glass("B", "") + glass("C", "") + element("fixed_opacity='0.5' opacity='0.5'"));
  after(changed_later, {{"M", 1}});
  material(changed_later, "A", 1, 0.25f, AlphaMode::blend);
  material(changed_later, "B", 0.25f, 1, AlphaMode::opaque);
  CHECK(contains(error_of([&] { plates.build(glass("A", "opacity='2'")); }), "expected a number from 0 to 1"));
}

TEST_CASE("mistakes are refused and leave the part as it was") {
  const PlatesOnDisk plates;
  const auto error = [&](const std::string& commands) { return error_of([&] { plates.build(commands); }); };
  CHECK(
      contains(error(changed("material='Paimt'")),
               "there is no material \"Paimt\" in part \"PLATES\", did you mean \"Paint\"? (expected one of: Paint, "));
  CHECK(
      contains(error("<element type='material' name='M' insert_at='ROOT' part='PLATE'/>"), "did you mean \"PLATES\""));
  CHECK(contains(error("<element type='material' name='M' insert_at='ROOT'/>"), "part"));
  CHECK(contains(error(changed("opacity='1.5'")), "\"opacity\": 1.5 is not allowed, expected a number from 0 to 1"));
  BuiltScene built;
  SceneBuilder builder(built, {});
  builder.execute(parse_commands(kTwoPlates, "s.xml", plates.folder.path()));
  const DrawList before = Flattener(built.scene.root()).update();
  const std::vector<Command> wrong = parse_commands(changed("red='0'") + changed("red='0'"), "s.xml", "");
  CHECK_THROWS_AS(builder.execute(wrong), InputError);
  CHECK(same_content(before, Flattener(built.scene.root()).update()));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();

// The element foliage: what a camera, a depth camera and a laser see through leaves at all degrees of transparency.
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

const glm::dvec3 kLeaf(0.2, 0.6, 0.1), kFoliageWall(0.9, 0.7, 0.8);
constexpr double kLeaf_m = 2, kFoliageWall_m = 4;
// The leaf's texels from left to right: alpha in steps. With a cutoff of one half the two right texels are visible.
constexpr std::uint8_t kAlpha[4] = {0, 100, 200, 255};
constexpr int kWidth_px = 4;

json leaf_material(GltfBuilder& file, const std::string& alpha_mode, double alpha) {
  ByteString texels;
  for (const std::uint8_t a : kAlpha) texels.insert(texels.end(), {255, 255, 255, a});
  const int image = file.append("images", {{"uri", "data:image/png;base64," + base64(png(4, 1, 8, 6, {texels}))}});
  const int sampler =
      file.append("samplers", {{"magFilter", 9728}, {"minFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33071}});
  json material = unlit("Leaves", glm::vec4(kLeaf, alpha));
  material["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
      file.append("textures", {{"source", image}, {"sampler", sampler}});
  material["alphaMode"] = alpha_mode;
  material["doubleSided"] = true;
  return material;
}

// A leaf of 2 m x 2 m, 2 m ahead, and a trunk that is visible below it.
GltfBuilder tree(const std::string& alpha_mode, double alpha = 1) {
  GltfBuilder file;
  const int leaves = file.append("materials", leaf_material(file, alpha_mode, alpha));
  const int trunk = file.append("materials", unlit("Trunk", {0.3f, 0.2f, 0.1f, 1}));
  add_plate(file, {.x = kLeaf_m, .left = 1, .right = -1, .bottom = -1, .top = 1}, leaves);
  add_plate(file, {.x = kLeaf_m, .left = 1, .right = -1, .bottom = -2, .top = -1}, trunk);
  return file;
}
GltfBuilder foliage_wall() {
  GltfBuilder file;
  add_plate(file, {.x = kFoliageWall_m}, file.append("materials", unlit("Wall", glm::vec4(kFoliageWall, 1))));
  return file;
}

// Each of the camera's four columns sees one texel: half its width is 1 m at 2 m, and so is that of the leaf. One row
// is used.
const std::string kParts = R"(<part file="tree.gltf" name="TREE" insert_at="ROOT" up="z"/>
  <part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)";
// The scanner's beams hit the centres of the two right texels: 0.25 m and 0.75 m to the right at 2 m.
const std::string kSensors = R"(
  <sensor type="camera" name="CAM" insert_at="ROOT" width="4" height="4" hfov="53.13010235415598" outputs="color depth"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="2" method="planar"
          min_angle="-20.556045219583467" max_angle="-7.125016348901798"/>)";

World forest(const GltfBuilder& tree, const std::string& attributes = "") {
  return World(
      {{"tree.gltf", tree}, {"wall.gltf", foliage_wall()}},
      kParts + "<element type='foliage' name='LEAVES' insert_at='ROOT' part='TREE' " + attributes + "/>" + kSensors);
}

constexpr int kRow = 1;
// Depth is float32 throughout, in about 16 operations.
constexpr double kLeafDepth = 16 * 0x1p-24;

void check_depth(World& world, int column, double expected_m) {
  CAPTURE(column);
  const double seen = world->depth("CAM").pixels[static_cast<std::size_t>(kRow * kWidth_px + column)];
  CHECK(seen == doctest::Approx(expected_m).epsilon(kLeafDepth).scale(0));
}

// Whether the beam through texel 3 or 2 hits a surface at this x.
void check_beam(World& world, int texel, double x_m) {
  CAPTURE(texel);
  const Scan& scan = world->scan("SCAN");
  const std::size_t beam = texel == 3 ? 0 : 1;
  const double tangent = texel == 3 ? 0.375 : 0.125;
  // The atlas may contain a silhouette beside the beam. Its bound is then infinite and cannot be checked here.
  REQUIRE(std::isfinite(scan.error_bound_m[beam]));
  CHECK(std::abs(scan.range_m[beam] - x_m * std::sqrt(1 + tangent * tangent)) <= scan.error_bound_m[beam]);
}

TEST_CASE("masked leaves fade together, holes of the cutoff stay holes, and depth sees the leaves up to 50 %") {
  World world = forest(tree("MASK"));
  for (const double transparency : {0.0, 10.0, 40.0, 50.0, 60.0, 90.0}) {
    CAPTURE(transparency);
    const double t = transparency / 100;
    world->set("LEAVES", "transparency", transparency);
    for (const int column : {0, 1, 2, 3}) {
      const bool kept = column >= 2, met = kept && transparency <= 50;
      CAPTURE(column);
      check_color(world.color(column, kRow), kept ? kLeaf * (1 - t) + kFoliageWall * t : kFoliageWall);
      check_depth(world, column, met ? kLeaf_m : kFoliageWall_m);
    }
    check_beam(world, 2, transparency <= 50 ? kLeaf_m : kFoliageWall_m);
    check_beam(world, 3, transparency <= 50 ? kLeaf_m : kFoliageWall_m);
  }
}

TEST_CASE("at 100 % leaves cost nothing: no draw and no triangle for any sensor") {
  World world = forest(tree("MASK"), "transparency='100'");
  for (const int column : {0, 1, 2, 3}) {
    check_color(world.color(column, kRow), kFoliageWall);
    check_depth(world, column, kFoliageWall_m);
  }
  check_beam(world, 3, kFoliageWall_m);
  // The camera draws trunk and wall. The scanner draws the wall; its strip does not reach the trunk.
  const FrameCounters gone = world->diagnostics().counters();
  world->set("LEAVES", "transparency", 0);
  world->step();
  CHECK(world->diagnostics().counters().draws == gone.draws + 2);
  CHECK(world->diagnostics().counters().triangles == gone.triangles + 4);
  world->enable("SCAN", false);
  world->set("LEAVES", "transparency", 100);
  world->step();
  CHECK(world->diagnostics().counters().draws == 2);
  CHECK(world->diagnostics().counters().triangles == 4);
  // In between, the camera draws the leaves once for colour, composites them in a second draw, and draws them once more
  // for depth if they are visible in depth.
  world->set("LEAVES", "transparency", 60);
  world->step();
  CHECK(world->diagnostics().counters().draws == 4);
  world->set("LEAVES", "transparency", 40);
  world->step();
  CHECK(world->diagnostics().counters().draws == 5);
}

TEST_CASE("blended leaves fade by their alpha, and depth sees those that still cover one half") {
  World world = forest(tree("BLEND", 0.9));
  for (const double transparency : {0.0, 25.0, 40.0, 50.0, 100.0}) {
    CAPTURE(transparency);
    world->set("LEAVES", "transparency", transparency);
    for (const int column : {0, 1, 2, 3}) {
      // Texel alphas of 8 bits are exact; 0.9 * 200 / 255 = 0.71, and 0.9: at 25 % 0.53 and 0.675, at 40 % 0.42, 0.54.
      const double alpha = kAlpha[column] / 255.0 * 0.9 * (1 - transparency / 100);
      CAPTURE(column);
      check_color(world.color(column, kRow), kLeaf * alpha + kFoliageWall * (1 - alpha));
      check_depth(world, column, alpha >= 0.5 ? kLeaf_m : kFoliageWall_m);
    }
    check_beam(world, 3, transparency <= 40 ? kLeaf_m : kFoliageWall_m);
    check_beam(world, 2, transparency <= 25 ? kLeaf_m : kFoliageWall_m);
  }
}

TEST_CASE("the trunk and the leaves of another tree from the same file do not change") {
  World world({{"tree.gltf", tree("MASK")}, {"wall.gltf", foliage_wall()}},
              kParts + R"(<part file="tree.gltf" name="OTHER" insert_at="ROOT" up="z" pose_offset="1 0 0 0 0 0"/>)" +
                  R"(<element type="foliage" name="LEAVES" insert_at="ROOT" part="TREE" transparency="100"/>)" +
                  kSensors);
  // At x = 3 m the columns lie at 1.125, 0.375, -0.375 and -1.125 m: the third sees texel 2, the last none.
  check_color(world.color(2, kRow), kLeaf);
  check_depth(world, 2, 3);
  check_depth(world, 3, kFoliageWall_m);
  // Row 3 looks down to -1.5 m at 2 m.
  check_color(world.color(2, 3), glm::dvec3(0.3, 0.2, 0.1));
}

TEST_CASE("foliage and material are combined") {
  World world = forest(tree("MASK"), "transparency='50'");
  world->execute(R"(<element type="material" name="M" insert_at="ROOT" part="TREE" opacity="0.5" red="0.5"/>)");
  check_color(world.color(3, kRow), kLeaf * glm::dvec3(0.5, 1, 1) * 0.25 + kFoliageWall * 0.75);
}

TEST_CASE("a part without leaves is refused") {
  TemporaryFolder folder;
  write_text(folder / "wall.gltf", foliage_wall().text());
  const auto build = [&](const std::string& part) {
    return error_of([&] {
      build_scene(
          parse_commands("<part file='wall.gltf' name='WALL' insert_at='ROOT'/>"
                         "<element type='foliage' name='F' insert_at='ROOT' part='" +
                             part + "'/>",
                         "s.xml", folder.path()));
    });
  };
  CHECK(
      contains(build("WALL"), "error: part \"WALL\" has no leaves, expected a part with materials of the alpha mode"));
  CHECK(contains(build("WAL"), "did you mean \"WALL\""));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();

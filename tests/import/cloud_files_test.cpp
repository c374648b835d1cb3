// Files of points: PCD, LAS and PLY without faces as parts, what they say and what is refused; points as spheres.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis {
namespace {

const std::filesystem::path kClouds = std::filesystem::path(SIMVIS_SOURCE_DIR) / "tests/fuzz/corpora";

// A part of a file in a folder of its own.
class CloudScene {
 public:
  explicit CloudScene(const std::string& name, const std::string& bytes, const std::string& attributes = "") {
    write_text(folder_ / name, bytes);
    built_ = build_scene(parse_commands("<part file='" + name + "' name='C' insert_at='ROOT' " + attributes + "/>",
                                        "s.xml", folder_.path()));
    flattener_ = std::make_unique<Flattener>(built_.scene.root());
  }
  const DrawList& list() { return flattener_->update(); }
  const Mesh& mesh() {
    REQUIRE(list().meshes.size() == 1);
    return *list().meshes[0];
  }
  glm::dvec3 world_point(std::size_t i) {
    return glm::dvec3(list().world_from_node[list().items.at(0).transform] * glm::dvec4(mesh().positions.at(i), 1));
  }
  std::vector<std::string> warnings() const {
    const auto& of_scene = built_.scene.warnings();
    return {of_scene.begin(), of_scene.end()};
  }

 private:
  TemporaryFolder folder_;
  BuiltScene built_;
  std::unique_ptr<Flattener> flattener_;
};

std::string refusal(const std::string& name, const std::string& bytes) {
  return error_of([&] { CloudScene(name, bytes); });
}

std::string pcd_header(const std::string& data, const std::string& points = "3") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n"
         "VIEWPOINT 9 9 9 1 0 0 0\nPOINTS " +
         points + "\nDATA " + data + "\n";
}

template <class T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

glm::vec4 linear(double red, double green, double blue) {
  return {linear_from_srgb(red / 255), linear_from_srgb(green / 255), linear_from_srgb(blue / 255), 1};
}

}  // namespace

TEST_CASE("PCD in its three kinds: places, colours, and points that are none") {
  CloudScene text("a.pcd", pcd_header("ascii") + "1 2 3 16711680\nnan nan nan 0\n-1 0.5 2e1 255\n");
  REQUIRE(text.mesh().positions.size() == 2);
  CHECK(text.mesh().topology == Topology::points);
  CHECK(text.world_point(0) == glm::dvec3(1, 2, 3));
  CHECK(text.world_point(1) == glm::dvec3(-1, 0.5, 20));
  CHECK(text.mesh().attributes[0].color == linear(255, 0, 0));
  CHECK(text.mesh().attributes[1].color == linear(0, 0, 255));
  REQUIRE(text.warnings().size() == 1);
  CHECK(contains(text.warnings()[0], "a.pcd: 1 points are left out, whose places are not finite"));
  for (const char* const name : {"pcd/binary.pcd", "pcd/compressed.pcd"}) {
    CAPTURE(name);
    CloudScene binary("b.pcd", read_text(kClouds / name));
    REQUIRE(binary.mesh().positions.size() == 3);
    CHECK(binary.mesh().positions[1] == glm::vec3(4, 5, 6));
    CHECK(binary.mesh().attributes[1].color == linear(0, 255, 0));
    CHECK(binary.warnings().empty());
  }
}

TEST_CASE("PCD: colours as real numbers, intensities, fields in between, organized clouds without POINTS") {
  // The bits 0x00804020 as a real number.
  const std::string head =
      "VERSION 0.7\nFIELDS _ x y z rgb\nSIZE 1 8 8 8 4\nTYPE U F F F F\nCOUNT 3 1 1 1 1\nWIDTH "
      "1\nHEIGHT 2\nDATA binary\n";
  std::string points;
  for (const double x : {500000.125, 500001.0}) {
    points += "abc" + bytes_of(x) + bytes_of(4e6) + bytes_of(-2.5) + bytes_of(std::uint32_t{0x804020});
  }
  CloudScene far("far.pcd", head + points);
  REQUIRE(far.mesh().positions.size() == 2);
  CHECK(far.world_point(0) == glm::dvec3(500000.125, 4e6, -2.5));
  CHECK(far.world_point(1) == glm::dvec3(500001, 4e6, -2.5));
  CHECK(far.mesh().positions[1] == glm::vec3(0.875, 0, 0));
  CHECK(far.mesh().attributes[0].color == linear(128, 64, 32));

  CloudScene grey("grey.pcd",
                  "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
                  "DATA ascii\n0 0 0 5\n1 0 0 20\n");
  CHECK(grey.mesh().attributes[0].color == glm::vec4(0.25, 0.25, 0.25, 1));
  CHECK(grey.mesh().attributes[1].color == glm::vec4(1));
}

TEST_CASE("LAS: scaled places far from the origin, colours of 16 bits, and intensities") {
  CloudScene colored("a.las", read_text(kClouds / "las/format2.las"));
  REQUIRE(colored.mesh().positions.size() == 2);
  // Places below 5e6 in double, and differences below 16 m in float32.
  constexpr double kPlace_m = 2e-6;
  CHECK(glm::distance(colored.world_point(0), glm::dvec3(500001, 4000002, 103)) < kPlace_m);
  CHECK(glm::distance(colored.world_point(1), glm::dvec3(499999, 4000000.005, 100.1)) < kPlace_m);
  CHECK(colored.mesh().attributes[0].color == glm::vec4(1, 0, 0, 1));
  CHECK(colored.mesh().attributes[1].color == glm::vec4(0, linear_from_srgb(32768.0 / 65535), 0, 1));
  CloudScene grey("b.las", read_text(kClouds / "las/format6.las"));
  CHECK(grey.mesh().attributes[0].color == glm::vec4(1));
  CHECK(grey.mesh().attributes[1].color == glm::vec4(0.5, 0.5, 0.5, 1));
}

TEST_CASE("PCD: names of fields in capitals, and colours in fields of their own, of 8 and 16 bits and real ones") {
  struct Row {
    const char *size, *type;
    double full;
  };
  for (const Row& row : {Row{"2 2 2", "U U U", 65535}, Row{"1 1 1", "U U U", 255}, Row{"2 2 2", "U U U", 255},
                         Row{"4 4 4", "F F F", 1}, Row{"4 4 4", "F F F", 255}}) {
    CAPTURE(std::string(row.size));
    CAPTURE(row.full);
    const std::string full = std::to_string(static_cast<int>(row.full));
    CloudScene scene("c.pcd", "FIELDS X Y Z Red Green Blue\nSIZE 4 4 4 " + std::string(row.size) + "\nTYPE F F F " +
                                  row.type + "\nCOUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 0 " +
                                  full + " 0 0\n1 2 3 0 " + full + " 0\n");
    CHECK(scene.mesh().positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 2, 3}});
    CHECK(scene.mesh().attributes[0].color == glm::vec4(1, 0, 0, 1));
    CHECK(scene.mesh().attributes[1].color == glm::vec4(0, 1, 0, 1));
    CHECK(scene.warnings().empty());
  }
}

TEST_CASE("LAS 1.5 is read as 1.4") {
  std::string las = read_text(kClouds / "las/format2.las");
  const std::string points =
      las.substr(static_cast<unsigned char>(las[96]) + 256 * static_cast<unsigned char>(las[97]));
  las = las.substr(0, 227) + std::string(375 - 227, '\0') + points;
  las[25] = 5;
  las[96] = static_cast<char>(375 & 255);
  las[97] = static_cast<char>(375 >> 8);
  CloudScene newer("a.las", las), older("b.las", read_text(kClouds / "las/format2.las"));
  CHECK(newer.mesh().positions == older.mesh().positions);
}

TEST_CASE("PLY without faces is a cloud, in text and in both orders of bytes") {
  const std::string properties =
      "element vertex 2\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  CloudScene text("t.ply", "ply\nformat ascii 1.0\n" + properties + "1e6 0 0 255 0 0\n1000001 0.5 0 0 0 255\n");
  CHECK(text.world_point(1) == glm::dvec3(1000001, 0.5, 0));
  CHECK(text.mesh().attributes[1].color == linear(0, 0, 255));
  CHECK(text.list().materials.at(0)->unlit);
  std::string big;
  for (const double x : {1e6, 1000001.0}) {
    for (const double value : {x, 0.5, -2.0}) {
      std::string bytes = bytes_of(value);
      big.append(bytes.rbegin(), bytes.rend());
    }
    big += "\xff\x80\x01";
  }
  CloudScene binary("b.ply", "ply\nformat binary_big_endian 1.0\n" + properties + big);
  CHECK(binary.world_point(1) == glm::dvec3(1000001, 0.5, -2));
  CHECK(binary.mesh().attributes[0].color == linear(255, 128, 1));
}

TEST_CASE("what a file of points gets wrong is refused with its place") {
  const std::string points = "1 2 3 0\n1 2 3 0\n1 2 3 0\n";
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  const std::string pcd = pcd_header("ascii") + points;
  CHECK(contains(refusal("a.pcd", with(pcd, "1 2 3 0\n1", "1 2 3\n1")), "a.pcd:12: a point with 3 numbers"));
  CHECK(contains(refusal("b.pcd", with(pcd, "POINTS 3", "POINTS 4")), "ends after 3 points, expected 4"));
  CHECK(contains(refusal("c.pcd", with(pcd, "SIZE 4 4 4 4", "SIZE 4 4 4")), "c.pcd:4: SIZE has 3 words"));
  CHECK(contains(refusal("d.pcd", with(pcd, "SIZE 4", "SIZE 3")), "has the size \"3\", expected 1, 2, 4 or 8"));
  CHECK(contains(refusal("e.pcd", with(pcd, "FIELDS x y z", "FIELDS x y w")), "has no field z"));
  CHECK(
      contains(refusal("f.pcd", with(pcd, "DATA ascii", "DATA text")), "expected ascii, binary or binary_compressed"));
  CHECK(contains(refusal("g.pcd", with(pcd, "WIDTH", "BREADTH")), "g.pcd:7: the header has a line"));
  CHECK(contains(refusal("h.pcd", with(pcd, "POINTS 3", "POINTS 99999999999")), "expected at most 20000000"));
  CHECK(contains(refusal("i.pcd", pcd_header("binary") + "0123"), "ends too early: its header claims 3 points"));
  const std::string wide =
      with(with(pcd, "SIZE 4 4 4 4", "SIZE 8 8 8 8"), "COUNT 1 1 1 1", "COUNT 1048576 1048576 1048576 1048576");
  CHECK(contains(refusal("m.pcd", wide), "has points of more than 16777216 bytes"));
  CHECK(contains(refusal("j.pcd", pcd_header("ascii", "0")), "holds nothing to draw"));
  std::string broken = read_text(kClouds / "pcd/compressed.pcd");
  broken.pop_back();
  CHECK(contains(refusal("k.pcd", broken), "ends too early"));
  CHECK(contains(refusal("l.pcd", with(read_text(kClouds / "pcd/compressed.pcd"), "POINTS 3", "POINTS 2")),
                 "has 48 bytes of points, expected 32"));

  std::string las = read_text(kClouds / "las/format2.las");
  CHECK(contains(refusal("a.las", las.substr(0, 100)), "is no LAS file"));
  CHECK(contains(refusal("b.las", las.substr(0, las.size() - 1)), "ends too early: its header claims 2 points"));
  std::string packed = las;
  packed[104] = static_cast<char>(0x82);
  CHECK(contains(refusal("c.las", packed), "is compressed (LAZ)"));
  packed[104] = 11;
  CHECK(contains(refusal("d.las", packed), "has points of format 11, expected 0 to 10"));
  packed = las;
  packed[25] = 6;
  CHECK(contains(refusal("e.las", packed), "has the version 1.6, expected LAS 1.0 to 1.5"));
  packed = las;
  packed[105] = 10;
  CHECK(contains(refusal("f.las", packed), "has points of 10 bytes, expected at least 26 for format 2"));

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n1 2 3\n";
  CHECK(contains(refusal("a.ply", ply), "ends after 1 points, expected 2"));
  CHECK(contains(refusal("b.ply", ply + "1 2\n"), "b.ply:9: a point with 2 numbers, expected 3"));
}

TEST_CASE("PCD: compressed points that are broken are refused") {
  // Three points of 16 bytes: a run of one byte stands for itself, and others repeat it.
  const auto with = [](const std::string& runs) {
    return pcd_header("binary_compressed") + bytes_of(static_cast<std::uint32_t>(runs.size())) +
           bytes_of(std::uint32_t{48}) + runs;
  };
  CloudScene zeros("a.pcd", with(std::string("\0\0\xe0\x26\0", 5)));
  CHECK(zeros.mesh().positions == std::vector<glm::vec3>(3, glm::vec3(0)));
  const std::string broken[] = {std::string("\1\0", 2),             // ends within a run
                                std::string("\0\0\xe0\x26\1", 5),   // repeats what lies before the beginning
                                std::string("\0\0\xe0", 3),         // ends within a length
                                std::string("\0\0\xe0\x26", 4),     // ends within a distance
                                std::string("\0\0\xe0\x27\0", 5),   // more than is expected
                                std::string("\0\0\xe0\x25\0", 5)};  // less
  for (const std::string& runs : broken) {
    CHECK(contains(refusal("b.pcd", with(runs)), "b.pcd: has compressed points that are broken"));
  }
}

namespace {

const std::string kThreePoints =
    "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA "
    "ascii\n3 0 0\n5 0 0\n0 4 0\n";

}  // namespace

TEST_CASE("lasers meet points with a radius as spheres, and pass others") {
  const TemporaryFolder folder;
  write_text(folder / "c.pcd", kThreePoints);
  const auto ranges = [&](const std::string& attributes, const std::string& scanner) {
    Simulation simulation = Simulation::from_string(
        "<part name='C' insert_at='ROOT' file='c.pcd' " + attributes +
            "/><sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='5' min_angle='-90' max_angle='90' " +
            scanner + "/>",
        {}, folder.path());
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    return std::vector<float>(scan.range_m.begin(), scan.range_m.end());
  };
  CHECK(std::isinf(ranges("", "")[2]));
  for (const char* const method : {"method='raycast'", "method='hybrid' max_error_m='0.001'"}) {
    CAPTURE(method);
    const std::vector<float> hit = ranges("point_radius='0.5'", method);
    CHECK(hit[2] == 2.5f);
    CHECK(hit[4] == 3.5f);
    CHECK(std::isinf(hit[0]));
  }
  // The radius is in metres of the scene, also of files in millimetres.
  CHECK(ranges("point_radius='0.5' scale='2'", "")[2] == 5.5f);
}

TEST_CASE("points with normals are discs where the part says so, and cameras see them where rays do") {
  const TemporaryFolder folder;
  write_text(folder / "n.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
             "float nx\nproperty float ny\nproperty float nz\nend_header\n3 0 0 -2 0 0\n0 4 0 0 1 0\n0 -4 0 1 0 0\n");
  write_text(folder / "plain.pcd", kThreePoints);
  const auto scene = [&](const std::string& attributes, const std::string& sensor) {
    return Simulation::from_string("<part name='C' insert_at='ROOT' " + attributes + "/>" + sensor, {}, folder.path());
  };
  constexpr const char* kScan =
      "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='5' min_angle='-90' max_angle='90' "
      "truth='hit instance normal'/>";
  Simulation discs = scene("file='n.ply' point_radius='0.5' point_shape='disc'", kScan);
  discs.step();
  const Scan& scan = discs.scan("SCAN");
  CHECK(scan.range_m[2] == 3.0f);      // facing the sensor, on the disc and not half a metre before it
  CHECK(scan.range_m[4] == 4.0f);      // from behind
  CHECK(std::isinf(scan.range_m[0]));  // along itself
  const Measurement measured = discs.measurement("SCAN");
  const auto truth = [&](const std::string& name, std::size_t beam) {
    const MeasuredArray* const column = measured.find(name);
    REQUIRE(column != nullptr);
    return column->number(beam);
  };
  CHECK(truth("true_primitive", 2) == 0);
  CHECK(truth("true_primitive", 4) == 1);
  CHECK(truth("true_instance", 2) > 0);
  CHECK(truth("true_normal_x", 2) == -1);
  CHECK(truth("true_normal_y", 4) == -1);  // the side that is seen
  Simulation seen = scene("file='n.ply' point_radius='0.5' point_shape='disc'",
                          "<sensor type='camera' name='CAM' insert_at='ROOT' width='61' height='61' hfov='60' "
                          "outputs='depth normal instance'/>");
  seen.step();
  // Pixels within half a metre of the axis at a depth of 3 m, by focal lengths of 30.5 / tan(30 degrees).
  const Image depth = seen.depth("CAM");
  const double focal_px = 30.5 / std::tan(std::numbers::pi / 6), radius_px = 0.5 / 3 * focal_px;
  std::size_t shown = 0;
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 61; ++x) {
      const bool on_disc = std::hypot(x - 30, y - 30) < radius_px;
      const float z = depth.pixels[static_cast<std::size_t>(61 * y + x)];
      CHECK((on_disc ? z == 3.0f : std::isinf(z)));
      shown += on_disc;
    }
  }
  CHECK(shown > 200);

  const std::string bare = error_of([&] { scene("file='plain.pcd' point_radius='0.5' point_shape='disc'", ""); });
  CHECK(contains(bare, ":1:2: error: part C: "));
  CHECK(contains(bare, "plain.pcd: its points have no normals, expected point_shape=\"sphere\""));
  CHECK(contains(error_of([&] { scene("file='n.ply' point_shape='disc'", ""); }),
                 ":1:46: error: attribute \"point_shape\": it shapes points that have a radius"));
  CHECK(contains(error_of([&] { scene("file='n.ply' point_radius='1' point_shape='cube'", ""); }), "sphere"));
}

TEST_CASE("points whose normal has no direction keep none, and are no discs") {
  const std::string pcd =
      "FIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 4\n"
      "HEIGHT 1\nPOINTS 4\nDATA ascii\n1 0 0 0 3 0\n2 0 0 nan nan nan\n3 0 0 0 0 0\n4 0 0 inf 0 0\n";
  CloudScene spheres("a.pcd", pcd, "point_radius='0.1'");
  REQUIRE(spheres.mesh().indices.size() == 4);
  CHECK(spheres.mesh().attributes[0].normal == glm::vec3(0, 1, 0));
  for (std::size_t i = 1; i < 4; ++i) CHECK(spheres.mesh().attributes[i].normal == glm::vec3(0));
  CHECK(spheres.warnings().empty());
  CloudScene discs("a.pcd", pcd, "point_radius='0.1' point_shape='disc'");
  CHECK(discs.mesh().indices.size() == 1);
  REQUIRE(discs.warnings().size() == 1);
  CHECK(contains(discs.warnings()[0], "a.pcd: 3 points are left out, which have no normal for a disc"));
}

TEST_CASE("points of Inventor, VRML and OBJ without normals are no discs either") {
  const std::string discs = "point_radius='0.1' point_shape='disc'";
  const auto refused = [&](const std::string& name, const std::string& bytes) {
    return contains(error_of([&] { CloudScene(name, bytes, discs); }), "its points have no normals");
  };
  CHECK(
      refused("p.wrl", "#VRML V2.0 utf8\nShape { geometry PointSet { coord Coordinate { point [1 0 0, 2 0 0] } } }\n"));
  CHECK(refused("p.obj", "v 1 0 0\nv 2 0 0\np 1 2\n"));
  const std::string points = "#Inventor V2.1 ascii\nSeparator { Coordinate3 { point [1 0 0, 2 0 0] } ";
  CHECK(refused("p.iv", points + "PointSet { } }\n"));
  CloudScene lit("n.iv", points + "Normal { vector [0 1 0, 1 0 0] } PointSet { } }\n", discs);
  REQUIRE(lit.mesh().indices.size() == 2);
  CHECK(lit.mesh().attributes[lit.mesh().indices[0]].normal == glm::vec3(0, 1, 0));
}

TEST_CASE("a radius of points that are not there is a warning, and shapes have none") {
  CloudScene mesh("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "point_radius='0.1'");
  REQUIRE(mesh.warnings().size() == 1);
  CHECK(contains(mesh.warnings()[0], "m.obj: holds no points"));
  CHECK(contains(error_of([] {
                   Simulation::from_string(
                       "<part name='A' insert_at='ROOT' shape='box' size='1 1 1' point_radius='1'/>", {}, ".");
                 }),
                 "it says how a file is read"));
}

}  // namespace simvis

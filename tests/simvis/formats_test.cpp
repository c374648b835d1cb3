// --format: the files of each format, read by others (NumPy) or by their own definitions.
#include "program/output/formats.h"

#include <doctest/doctest.h>

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include <simvis/error.h>
#include "program/output/depth_png_file.h"
#include "program/output/evt3_file.h"
#include "program/output/npy_file.h"
#include "program/output/point_file.h"
#include "tests/support/error_of.h"
#include "tests/support/picture_files.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

// The wall is 4 m ahead of both; the middle beam of ring 1 meets it there, the last beams miss it.
constexpr std::string_view kFormatSensors = R"(
<sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" hfov="90" outputs="color depth"
        pose_offset="0 1 0.5 0 0 0"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-80" max_angle="80"
        vertical_samples="3" vertical_min_angle="-10" vertical_max_angle="10" intensity="on" truth="range hit"/>
<sensor type="psd" name="PSD" insert_at="ROOT"/>)";
constexpr std::string_view kEventSensor =
    R"(<sensor type="event_camera" name="EV" insert_at="ROOT" width="16" height="12" shot_noise="100"/>)";

struct Written {
  TemporaryFolder folder;
  fs::path out = folder / "out";
  explicit Written(const Strings& more, std::string_view sensors = kFormatSensors) {
    Strings arguments = {tested_build() + "/bin/simvis-run", write_wall_scene(folder.path(), sensors).string(), "--out",
                         out.string(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = Process(arguments).wait();
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
  }
};

template <typename Number>
std::vector<Number> numbers_of(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

TEST_CASE("values of --format") {
  CHECK(parse_formats({}) == OutputFormats{});
  const Strings bare = {"npy,jpeg"};
  const OutputFormats some = parse_formats(bare);
  CHECK(some.scan == std::set<std::string>{"npy"});
  CHECK(some.depth == std::set<std::string>{"npy"});
  CHECK(some.color == std::set<std::string>{"jpeg"});
  const Strings named = {"depth=png", "scan=csv,ply"};
  const OutputFormats kinds = parse_formats(named);
  CHECK(kinds.depth == std::set<std::string>{"png"});
  CHECK(kinds.scan == std::set<std::string>{"csv", "ply"});
  CHECK(kinds.color == OutputFormats{}.color);
  CHECK(kinds.color_beside_depth);
  for (const char* wrong : {"gif", "", "scan=jpeg", "sound=png", "csv,", "depth"}) {
    const Strings values = {wrong};
    CHECK_THROWS_AS(parse_formats(values), InputError);
  }
}

TEST_CASE("each format of the table makes the file that the table names, and no other format of its kind") {
  for (const FormatSpec& format : format_table()) {
    const std::string choice = std::string(format.kind) + "=" + std::string(format.name);
    CAPTURE(choice);
    const auto suffix = [](std::string_view of_file) {
      return std::string(of_file.substr(of_file.find_first_of("/._")));
    };
    const bool is_events = format.file.starts_with("EVENTS");
    const std::string sensor = is_events ? "EV" : format.kind == "scan" ? "SCAN" : "CAM";
    REQUIRE((is_events || format.file.starts_with(format.kind == "scan" ? "SCANNER" : "CAMERA")));
    const std::string file = sensor + suffix(format.file);
    // Depth may have the same file as colour, so that it gets another one.
    const std::string aside = format.kind == "color" ? "depth=npy" : "color=png";
    const Written run({"--format", choice, "--format", aside, "--sensor", sensor},
                      is_events ? kEventSensor : kFormatSensors);
    const Strings files = files_below(run.out);
    CHECK(std::ranges::count(files, file) == 1);
    for (const FormatSpec& other : format_table()) {
      if (other.kind != format.kind || other.file == format.file) continue;
      CHECK(std::ranges::count(files, sensor + suffix(other.file)) == 0);
    }
  }
  CHECK(format_table().size() == 15);
  CHECK(default_formats("color") == std::set<std::string>{"png"});
  CHECK(default_formats("depth") == std::set<std::string>{"exr"});
  CHECK(default_formats("scan") == std::set<std::string>{"csv"});
}

TEST_CASE("each format only if it is asked for") {
  const Written plain({});
  CHECK(files_below(plain.out) == Strings{"CAM.yaml", "CAM/000000.exr", "CAM/000000.png", "CAM_poses.csv",
                                          "CAM_poses.tum", "PSD.csv", "PSD_poses.csv", "PSD_poses.tum", "SCAN.csv",
                                          "SCAN_poses.csv", "SCAN_poses.tum", "items.csv", "run.json"});
  CHECK(read_exr(plain.out / "CAM/000000.exr").channels.size() == 4);
  // A PSD has no points: its table stays CSV.
  const Written other({"--format", "color=jpeg", "--format", "depth=png", "--format", "scan=ply"});
  CHECK(files_below(other.out) == Strings{"CAM.yaml", "CAM/000000.jpg", "CAM_depth/000000.png", "CAM_poses.csv",
                                          "CAM_poses.tum", "PSD.csv", "PSD_poses.csv", "PSD_poses.tum",
                                          "SCAN/000000.ply", "SCAN_poses.csv", "SCAN_poses.tum", "items.csv",
                                          "run.json"});
  const Written exr({"--format", "color=png", "--format", "depth=exr", "--sensor", "CAM"});
  CHECK(read_exr(exr.out / "CAM/000000.exr").channels.size() == 1);  // colour as asked: only PNG
}

TEST_CASE("depth as PNG is 4 m in every pixel, in the unit that is asked for") {
  for (const auto& [unit, code] : {std::pair{"0.001", 4000}, std::pair{"0.01", 400}}) {
    const Written run({"--format", "depth=png", "--depth-unit", unit, "--sensor", "CAM"});
    const std::string png = read_text(run.out / "CAM_depth/000000.png");
    CHECK(static_cast<int>(png[24]) == 16);  // bits, in the IHDR chunk
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
        stbi_load_16((run.out / "CAM_depth/000000.png").c_str(), &width, &height, &channels, 0), stbi_image_free);
    REQUIRE(pixels != nullptr);
    REQUIRE(width == 32);
    REQUIRE(height == 24);
    CHECK(channels == 1);
    int different = 0;
    for (int i = 0; i < 32 * 24; ++i) different += pixels.get()[i] != code;
    CHECK(different == 0);
  }
  CHECK(depth_code(INFINITY, 0.001) == 0);
  CHECK(depth_code(65.535f, 0.001) == 65535);
  CHECK(depth_code(65.536f, 0.001) == 0);
  CHECK(depth_code(0.0004f, 0.001) == 0);
}

TEST_CASE("formats of several kinds may stand in one value") {
  const auto names = [](const std::string& value) {
    const OutputFormats chosen = parse_formats(std::vector{value});
    std::string text;
    for (const auto& formats : {chosen.color, chosen.depth, chosen.scan}) {
      for (const std::string& name : formats) text += name + " ";
      text += "| ";
    }
    return text;
  };
  CHECK(names("color=png,depth=npy") == "png | npy | csv | ");
  CHECK(names("color=rgb8,png, depth=npy,exr,scan=ply") == "png rgb8 | exr npy | ply | ");
  CHECK(names("npy,color=exr") == "exr | npy | npy | ");  // before a kind: of each that has it
  for (const char* wrong : {"color=png,depth=jpeg", "depth=npy,rgb8", "colour=png", "color=", "png,=png,"}) {
    CAPTURE(wrong);
    CHECK(error_of([&] { names(wrong); }).find(" is no format, expected color=") != std::string::npos);
  }
}

TEST_CASE("colour without compression has the pixels of the PNG") {
  const Written run({"--format", "color=png,rgb8", "--sensor", "CAM"});
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load((run.out / "CAM/000000.png").c_str(), &width, &height, &channels, 0), stbi_image_free);
  REQUIRE(pixels != nullptr);
  REQUIRE(channels == 3);
  const std::string npy = read_text(run.out / "CAM/000000.npy");
  CHECK(npy.find("{'descr': '|u1', 'fortran_order': False, 'shape': (24, 32, 3), }") != std::string::npos);
  const auto size = static_cast<std::size_t>(width * height * channels);
  REQUIRE(npy.size() > size);
  CHECK(std::memcmp(npy.data() + npy.size() - size, pixels.get(), size) == 0);
}

TEST_CASE("two formats of one sensor that name one file are refused, with both names") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             R"(<part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
                <element type="label" name="L" insert_at="ROOT" part="WALL" class="wall" class_id="2"/>
                <sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" outputs="color boxes"/>)");
  const auto run = [&](const std::string& formats) {
    return run_simvis({"--format", formats, "--out", (folder / formats).string(), (folder / "scene.xml").string()});
  };
  CHECK(run("scan=npy").exit_code == 0);
  CHECK(run("color=rgb8").exit_code == 0);
  const auto both = run_simvis({"--format", "scan=npy", "--format", "color=rgb8", "--out", (folder / "both").string(),
                                (folder / "scene.xml").string()});
  CHECK(both.exit_code == 2);
  CHECK_MESSAGE(
      both.err.find("of sensor \"CAM\", as color=rgb8 and scan=npy do; expected one of them") != std::string::npos,
      both.err);
}

TEST_CASE("an EXR tells when, where and with what camera it was taken") {
  const Written run({"--sensor", "CAM"});
  Imf::InputFile file((run.out / "CAM/000000.exr").c_str());
  const Imf::Header& header = file.header();
  CHECK(header.typedAttribute<Imf::DoubleAttribute>("time_s").value() == 0);
  const Imath::M44d pose = header.typedAttribute<Imf::M44dAttribute>("world_from_sensor").value();
  CHECK(pose == Imath::M44d(1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 0.5, 0, 0, 0, 1));
  const Imath::M33d camera = header.typedAttribute<Imf::M33dAttribute>("camera_matrix").value();
  // 90 degrees over 32 pixels: fx = 16; centres at whole numbers.
  constexpr double kRounding = 16 * 8 * 0x1p-53;
  CHECK(std::abs(camera[0][0] - 16) <= kRounding);
  CHECK(camera[0][2] == 15.5);
  CHECK(camera[1][2] == 11.5);
}

TEST_CASE("poses and intrinsics") {
  const Written run({});
  CHECK(read_text(run.out / "CAM_poses.csv") ==
        "frame,time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0.000000000,0,1,0.5,0,0,0,1\n");
  CHECK(read_text(run.out / "CAM_poses.tum") == "# time_s tx ty tz qx qy qz qw\n0.000000000 0 1 0.5 0 0 0 1\n");
  CHECK(read_text(run.out / "CAM.yaml").find("image_width: 32\nimage_height: 24\n") == 0);
}

TEST_CASE("point clouds by their own definitions") {
  const Written run({"--format", "csv,ply,pcd,bin", "--sensor", "SCAN"});
  const std::string ply = read_text(run.out / "SCAN/000000.ply"), pcd = read_text(run.out / "SCAN/000000.pcd");
  const std::vector<float> bin = numbers_of<float>(read_text(run.out / "SCAN/000000.bin"));
  // 4 tan(80 degrees) = 22.7 m is beyond the wall's edge at 10 m: three of five columns meet it.
  constexpr std::size_t kPoints = 9;
  REQUIRE(bin.size() == 4 * kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    CHECK(std::abs(bin[4 * i] - 4) <= 8 * 0x1p-24);
    CHECK(bin[4 * i + 3] > 0);  // intensity
  }
  CHECK(ply.find("element vertex 9\nproperty float x\nproperty float y\nproperty float z\nproperty int ring\n") !=
        std::string::npos);
  // Angles as doubles, which nine digits do not carry.
  CHECK(ply.find("property double azimuth_deg\nproperty double elevation_deg\nproperty float range_m\n") !=
        std::string::npos);
  const std::string body = ply.substr(ply.find("end_header\n") + 11);
  CHECK(body.size() % kPoints == 0);
  CHECK(numbers_of<float>(body.substr(0, 12)) == std::vector<float>(bin.begin(), bin.begin() + 3));
  CHECK(pcd.find("VERSION 0.7\nFIELDS x y z ring beam azimuth_deg elevation_deg range_m error_bound_m intensity "
                 "true_range_m true_item true_primitive\n") != std::string::npos);
  CHECK(pcd.find("WIDTH 9\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 9\nDATA binary\n") != std::string::npos);
  CHECK(pcd.substr(pcd.find("DATA binary\n") + 12) == body);
}

TEST_CASE("truth: the range and the triangle that each beam meets") {
  const Written run({"--sensor", "SCAN"});
  std::istringstream table(read_text(run.out / "SCAN.csv"));
  std::string line;
  std::getline(table, line);
  CHECK(line.ends_with(",intensity,true_range_m,true_item,true_primitive"));
  int hits = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    Strings cells;
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    cells.resize(15);
    if (cells[6] == "inf") {
      CHECK(cells[12] == "inf");
      CHECK(cells[13].empty());
      continue;
    }
    ++hits;
    CHECK(std::abs(std::stod(cells[6]) - std::stod(cells[12])) <= std::stod(cells[7]));
    CHECK(cells[13] == "0");
    CHECK((cells[14] == "0" || cells[14] == "1"));  // the wall's two triangles
  }
  CHECK(hits == 9);
}

// Ids of things have 32 bits.
TEST_CASE("whole numbers beyond 31 bits are exact in each format") {
  constexpr double kId = 4'000'000'001;
  TableFrame table;
  for (const char* const name : {"x_m", "y_m", "z_m"}) table.columns.push_back({.name = name, .format = "%.9g"});
  for (const char* const name : {"beam", "object"}) {
    table.columns.push_back({.name = name, .format = "%lld", .integer = true});
  }
  table.values = {1, 2, 3, 7, kId};
  const auto last_number = [](const std::string& bytes, auto number) {
    std::memcpy(&number, bytes.data() + bytes.size() - sizeof number, sizeof number);
    return static_cast<double>(number);
  };
  CHECK(last_number(encode_npy(table), std::int64_t{}) == kId);
  const std::string ply = encode_ply(table), pcd = encode_pcd(table);
  CHECK(contains(ply, "property int beam\nproperty double object\n"));
  CHECK(contains(pcd, "SIZE 4 4 4 4 8\nTYPE F F F I F\n"));
  for (const std::string& bytes : {ply, pcd}) CHECK(last_number(bytes, double{}) == kId);
}

TEST_CASE("events as EVT 3.0 are a header and words, and other tables have none") {
  TableFrame table;
  for (const char* const name : {"t_us", "x", "y", "polarity"}) {
    table.columns.push_back({.name = name, .format = "%lld", .integer = true});
  }
  table.values = {7, 2, 3, 1};
  CHECK_FALSE(has_events(table));  // its image has no size
  table.image_size_px = {2049, 16};
  CHECK_FALSE(has_events(table));
  table.image_size_px = {16, 12};
  REQUIRE(has_events(table));
  const std::string bytes = encode_evt3_file(table);
  CHECK(bytes.starts_with("% evt 3.0\n"));
  // The beginning of time, the lower part of the time, the row, the column with the polarity.
  CHECK(bytes.ends_with(std::string("% end\n\x00\x80\x07\x60\x03\x00\x02\x28", 14)));
  table.columns[3].name = "p";
  CHECK_FALSE(has_events(table));
}

TEST_CASE("EVT 3.0 without an event camera that it can hold is one message, and nothing is written") {
  const auto refused = [](std::string_view sensors, const Strings& more, const std::string& expected) {
    CAPTURE(expected);
    const TemporaryFolder folder;
    Strings arguments = {tested_build() + "/bin/simvis-run",
                         write_wall_scene(folder.path(), sensors).string(),
                         "--out",
                         (folder / "out").string(),
                         "--quiet",
                         "--format",
                         "scan=evt3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = Process(arguments).wait();
    CHECK(result.exit_code == 2);
    CHECK_MESSAGE(contains(result.err, expected), result.err);
    CHECK(std::ranges::count(result.err, '\n') == 1);
    CHECK_FALSE(fs::exists(folder / "out"));
  };
  refused(kFormatSensors, {}, "--format: the scene has no event_camera that is on, expected one for evt3");
  const std::string off = std::string(kFormatSensors) + std::string(kEventSensor);
  refused(off, {"--sensor", "SCAN"}, "the scene has no event_camera that is on");
  refused(R"(<sensor type="event_camera" name="EV" insert_at="ROOT" width="2049" height="12"/>)", {},
          "the event camera \"EV\" has 2049 x 12 pixels, expected at most 2048 x 2048 for evt3");
}

TEST_CASE("NumPy reads arrays of scans and depth") {
  if (Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code != 0) {
    return test::skip("there is no NumPy of /usr/bin/python3");
  }
  const Written run({"--format", "csv,npy,npz,exr"});
  const ProcessResult result = Process({"/usr/bin/python3", "-c", R"(
import csv, numpy, sys
out = sys.argv[1] + "/"
rows = list(csv.DictReader(open(out + "SCAN.csv")))
array, arrays = numpy.load(out + "SCAN/000000.npy"), numpy.load(out + "SCAN/000000.npz")
names = [name for name in rows[0] if name not in ("frame", "time_s")]
assert list(array.dtype.names) == names, array.dtype
assert array.shape == (15,)
for name in names:
    for row, number, other in zip(rows, array[name], arrays[name]):
        if row[name] == "":
            assert number != number and other != other
        elif name == "error_bound_m":
            assert number <= float(row[name]) and number == numpy.float32(other)
        else:
            assert number == array.dtype[name].type(row[name]), (name, row[name], number)
            assert number == array.dtype[name].type(other)
assert arrays["frame"] == 0 and arrays["time_s"] == 0
assert (arrays["world_from_sensor"] == numpy.eye(4)).all()
depth = numpy.load(out + "CAM_depth/000000.npy")
assert depth.shape == (24, 32) and depth.dtype == numpy.float32
assert abs(depth - 4).max() < 1e-5
)",
                                        run.out.string()})
                                   .wait();
  CHECK_MESSAGE(result.exit_code == 0, result.err);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();

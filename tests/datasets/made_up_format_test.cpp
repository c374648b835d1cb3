// Formats of datasets and of files that only this program has: one registration in one file brings each everywhere.
#include "program/datasets/dataset_format.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>
#include "program/datasets/dataset_folder.h"
#include "program/output/formats.h"
#include "program/output/output_writer.h"
#include "program/output/table_frame.h"
#include "scenegraph/image_span.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("datasets");

namespace simvis::test {
namespace {

// One file for each frame, and one for all.
class MadeUpFormat : public DatasetFormat {
 public:
  explicit MadeUpFormat(double depth_unit_m) : depth_unit_m_(depth_unit_m) {}
  void begin(std::span<const DatasetSensor>) override {}
  FramePiece frame(const DatasetFrame& frame) const override {
    const std::string number = std::to_string(frame.time.index);
    return {.files = {text_file("frames/" + number + ".txt", "frame " + number + "\n")},
            .record = {{"frame", number}},
            .warnings = {"frame " + number}};
  }
  std::vector<DatasetFile> whole(std::span<const Record> records) const override {
    std::string all = "unit " + std::to_string(depth_unit_m_) + "\n";
    for (const Record& record : records) all += record.at("frame").get<std::string>() + "\n";
    return {text_file("all.txt", all)};
  }

 private:
  double depth_unit_m_;
};

const DatasetFormatRegistration kMadeUpFormat("made_up", [](double depth_unit_m) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<MadeUpFormat>(depth_unit_m);
});

TEST_CASE("a format that registers itself is known by its name, among all in alphabetical order") {
  CHECK(dataset_names(" ") == "bop coco colmap dsec euroc kitti made_up nuscenes semantickitti tum");
  CHECK(contains(error_of([] { make_dataset_format("made_upp", 1); }), "made_up"));
  CHECK(make_dataset_format("made_up", 1) != nullptr);
}

TEST_CASE("a folder of a format that registers itself has its files") {
  const TemporaryFolder folder;
  DatasetFolder dataset({.folder = folder / "set", .format = "made_up", .depth_unit_m = 0.25, .frames = 2}, {});
  const DrawList list;
  for (std::uint64_t i = 0; i < 2; ++i) {
    dataset.add({.time = {.index = i}, .sensors = {}, .items = {}, .objects = {}, .list = list}, "",
                [](const std::string&) {});
  }
  REQUIRE(dataset.finish());
  CHECK(read_text(folder / "set/frames/1.txt") == "frame 1\n");
  CHECK(read_text(folder / "set/all.txt") == "unit 0.250000\n0\n1\n");
}

TEST_CASE("a frame whose warning is an error is missing afterwards, and warns again when it is made again") {
  const TemporaryFolder folder;
  const DatasetDesc desc{.folder = folder / "set", .format = "made_up", .frames = 1, .resume = true};
  const DrawList list;
  const DatasetFrame frame{.time = {.index = 0}, .sensors = {}, .items = {}, .objects = {}, .list = list};
  const auto refuse = [](const std::string& warning) { throw InputError(warning); };
  for (int run = 0; run < 2; ++run) {
    DatasetFolder dataset(desc, {});
    CHECK_THROWS_WITH_AS(dataset.add(frame, "", refuse), "frame 0", InputError);
    CHECK_FALSE(dataset.has(0));
    CHECK_FALSE(dataset.finish());
    CHECK_FALSE(std::filesystem::exists(folder / "set/frames/0.txt"));
  }
  DatasetFolder dataset(desc, {});
  std::vector<std::string> warnings;
  const auto keep = [&warnings](const std::string& warning) { warnings.push_back(warning); };
  dataset.add(frame, "", keep);
  dataset.add(frame, "", keep);  // it is there already
  CHECK(warnings == std::vector<std::string>{"frame 0"});
  CHECK(dataset.finish());
}

const FormatRegistration kMadeUpColor({.kind = "color",
                                       .name = "made_up",
                                       .file = "CAMERA/000000.ppx",
                                       .text = "a format of a test",
                                       .encode_color = [](const ImageSpan& color) {
                                         return "width " + std::to_string(color.width);
                                       }});
const FormatRegistration kMadeUpDepth({.kind = "depth",
                                       .name = "made_up",
                                       .file = "CAMERA_depth/000000.dpx",
                                       .text = "a format of a test",
                                       .encode_depth = [](const Image& depth, double unit_m) {
                                         return std::to_string(depth.pixels[0] / unit_m);
                                       }});
const FormatRegistration kMadeUpTable(
    {.kind = "scan",
     .name = "made_up",
     .file = "SCANNER/000000.tpx",
     .text = "a format of a test",
     .encode_table = [](const TableFrame& table) { return std::to_string(table.rows()) + " rows"; },
     .fits = [](const TableFrame& table) { return table.rows() == 2; }});

TEST_CASE("formats of files that register themselves stand behind the others of their kind and write their files") {
  CHECK(contains(describe_formats(), "rgb8,made_up depth=exr,png,npy,made_up scan="));
  const std::vector<std::string> chosen = {"made_up"};
  const OutputFormats formats = parse_formats(chosen);
  const TemporaryFolder folder;
  OutputWriter writer({.folder = folder.path(), .sensors = {"CAM", "TABLE"}, .formats = formats});
  const Image color{3, 1, 4, std::vector<float>(12)}, depth{3, 1, 1, {0.5f, 1, 1}};
  writer.write("CAM", {.index = 4}, glm::dmat4(1),
               {.arrays = {image_array("color", color, ImageContent::color),
                           image_array("depth", depth, ImageContent::depth, "m")}});
  const TableColumn columns[] = {{.name = "a", .format = "%.9g"}};
  writer.write("TABLE", {.index = 0}, glm::dmat4(1), Reading(columns, {1, 2}));
  writer.write("TABLE", {.index = 1}, glm::dmat4(1), Reading(columns, {1, 2, 3}));
  writer.finish();
  CHECK(read_text(folder / "CAM/000004.ppx") == "width 3");
  CHECK(read_text(folder / "CAM_depth/000004.dpx") == "500.000000");
  CHECK(read_text(folder / "TABLE/000000.tpx") == "2 rows");
  CHECK_FALSE(std::filesystem::exists(folder / "TABLE/000001.tpx"));  // it does not fit: the rows are in the CSV
  CHECK(contains(read_text(folder / "TABLE.csv"), "3"));
  CHECK_FALSE(std::filesystem::exists(folder / "CAM/000004.png"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();

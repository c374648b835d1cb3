// Datasets read by the formats' own readers, whose answers are compared with the files of a run without --dataset; and
// mistakes of a writer, planted in the files, that these comparisons must find.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/datasets/dataset_scene.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("datasets");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// What tools/python_tools makes.
const std::string kReadersPython = SIMVIS_SOURCE_DIR "/build/dataset-readers/bin/python";
const std::string kScripts = SIMVIS_SOURCE_DIR "/tests/datasets/readers/";

bool has_readers(const std::string& modules) {
  if (fs::exists(kReadersPython) &&
      Process({kReadersPython, "-c", "import numpy, PIL, " + modules}).wait().exit_code == 0) {
    return true;
  }
  test::skip("there is no " + modules + " for Python: tools/python_tools installs it where pip can");
  return false;
}

struct ReadDataset {
  std::string format;   ///< of --dataset
  std::string script;   ///< in tests/datasets/readers/
  std::string modules;  ///< that it needs
  std::string more;     ///< in the scene
  std::vector<std::string> mistakes;
  std::string camera{};  ///< more attributes of the camera
};

ProcessResult read_dataset(const ReadDataset& dataset, const fs::path& folder, const fs::path& run) {
  Strings command = {kReadersPython, kScripts + dataset.script, folder.string(), run.string()};
  if (dataset.format == "semantickitti") command.emplace_back("labels");
  return Process(command, {"PYTHONDONTWRITEBYTECODE=1"}).wait();
}

// The focal length of the scene's camera, for mistakes that a dataset's own files do not have it for.
const char* const kFocal_px = "68.551";

// Two objects of two links and four meshes each, one of which is turned against its link.
const std::string kStool = R"(<robot name="stool">
  <link name="top">
    <visual><geometry><box size="0.34 0.3 0.04"/></geometry></visual>
    <visual><origin xyz="0.15 0 0.2"/><geometry><box size="0.04 0.3 0.36"/></geometry></visual></link>
  <link name="legs">
    <visual><origin xyz="0 0.1 -0.2"/><geometry><box size="0.05 0.05 0.4"/></geometry></visual>
    <visual><origin xyz="0 -0.1 -0.2" rpy="0.2 0 0.4"/><geometry><box size="0.05 0.05 0.4"/></geometry></visual></link>
  <joint name="j" type="fixed"><parent link="top"/><child link="legs"/></joint></robot>)";
const std::string kStools = R"(
  <part name="STOOL_1" insert_at="ROOT" file="stool.urdf" pose_offset="1.7 -0.35 0.45 0 0 50"/>
  <part name="STOOL_2" insert_at="ROOT" file="stool.urdf" pose_offset="3.9 -1.1 0.45 0 0 0"/>
  <element type="label" name="STOOLS" insert_at="ROOT" parts="STOOL_?" class="stool" class_id="60"/>)";

void check_dataset(const ReadDataset& dataset) {
  CAPTURE(dataset.format);
  if (!has_readers(dataset.modules)) return;
  const TemporaryFolder folder;
  write_text(folder / "stool.urdf", kStool);
  write_text(folder / "scene.xml",
             dataset_scene("color depth instance boxes silhouettes" + dataset.camera, kStools + dataset.more));
  make_dataset(folder / "scene.xml", folder / "run", {"--format", "color=png", "--format", "depth=npy"});
  make_dataset(folder / "scene.xml", folder / "set", {"--dataset", dataset.format});
  const ProcessResult good = read_dataset(dataset, folder / "set", folder / "run");
  CHECK_MESSAGE(good.exit_code == 0, good.err);
  REQUIRE_FALSE(dataset.mistakes.empty());
  for (const std::string& mistake : dataset.mistakes) {
    CAPTURE(mistake);
    fs::copy(folder / "set", folder / "damaged", fs::copy_options::recursive);
    const ProcessResult damaged =
        Process({kReadersPython, kScripts + "damage.py", mistake, (folder / "damaged").string(), kFocal_px}).wait();
    REQUIRE_MESSAGE(damaged.exit_code == 0, damaged.err);
    const ProcessResult found = read_dataset(dataset, folder / "damaged", folder / "run");
    CHECK(found.exit_code != 0);
    CHECK_MESSAGE(found.err.find("WRONG: ") != std::string::npos, found.err);
    fs::remove_all(folder / "damaged");
  }
}

// Points of chairs: one on top, one at a lower corner behind, which the chair itself hides.
const std::string kDatasetPoints = R"(
  <part name="CHAIR_1/seat" insert_at="CHAIR_1" pose_offset="0 0 0.45 0 0 0"/>
  <part name="CHAIR_1/foot" insert_at="CHAIR_1" pose_offset="0.2 0 -0.4 0 0 0"/>
  <part name="CHAIR_2/seat" insert_at="CHAIR_2" pose_offset="0 0 0.45 0 0 0"/>
  <sensor type="keypoints" name="KEYS" insert_at="CAR" points="CHAIR_?/*" width="96" height="72" hfov="70"/>)";

TEST_CASE("COCO is what pycocotools reads, and wider boxes, masks row by row or shifted keypoints are found") {
  check_dataset({"coco", "coco.py", "pycocotools", kDatasetPoints, {"coco_box", "coco_rle", "coco_keypoints"}});
}

// cam1 to cam3, behind the camera CAM by their names.
const std::string kMoreViews =
    "<sensor type='stereo_camera' name='EYES' insert_at='CAR' pose_offset='0 0.1 0 0 0 0' width='32' height='24' "
    "baseline='0.2' outputs='color'/><sensor type='camera' name='FISH' insert_at='CAR' width='32' height='24' "
    "outputs='color' distortion='kannala_brandt' fx='12' k1='0.03'/>";

TEST_CASE("EuRoC is what evo and a reader written from its files read, and mistakes are found") {
  check_dataset({"euroc",
                 "euroc.py",
                 "evo, yaml, scipy",
                 kDatasetImu + kMoreViews,
                 {"euroc_quaternion", "euroc_extrinsics"},
                 "\" distortion=\"brown_conrady\" k1=\"-0.1\" k2=\"0.02\" p1=\"0.001"});
}

TEST_CASE("DSEC is what h5py reads, and mistakes in events, flow and disparity are found") {
  check_dataset({"dsec",
                 "dsec.py",
                 "h5py, cv2, yaml",
                 kDatasetEvents,
                 {"dsec_index", "dsec_places", "dsec_flow", "dsec_disparity"},
                 " flow_forward"});
}

TEST_CASE("nuScenes is what nuscenes-devkit reads, and mistakes in boxes are found") {
  check_dataset({"nuscenes",
                 "nuscenes_reader.py",
                 "nuscenes.nuscenes",
                 kDatasetScanner,
                 {"nuscenes_quaternion", "nuscenes_size"}});
}

TEST_CASE("BOP is what a reader written from its document reads, and mistakes are found") {
  check_dataset({"bop", "bop.py", "json", "", {"bop_box", "bop_rotation", "bop_depth"}});
}

TEST_CASE("COLMAP is what pycolmap reads, and quaternions in another order or shifted pixels are found") {
  for (const char* const lens : {"", "\" distortion=\"brown_conrady\" k1=\"-0.1\" k2=\"0.02\" p1=\"0.001",
                                 "\" distortion=\"brown_conrady\" k1=\"-0.1\" k3=\"0.01",
                                 "\" distortion=\"rational_polynomial\" k1=\"0.5\" k4=\"0.7\" k6=\"0.02\" p2=\"0.002",
                                 "\" distortion=\"kannala_brandt\" k1=\"0.03"}) {
    CAPTURE(lens);
    check_dataset({"colmap", "colmap.py", "pycolmap", "", {"colmap_quaternion", "colmap_pixels"}, lens});
  }
}

TEST_CASE("TUM is what evo reads, and quaternions in another order or depth along rays are found") {
  check_dataset({"tum", "tum.py", "evo", "", {"tum_quaternion", "tum_depth"}});
}

TEST_CASE("KITTI is what pykitti and evo read, and mistakes in poses, calibration, points and objects are found") {
  check_dataset({"kitti",
                 "kitti.py",
                 "pykitti, evo",
                 kDatasetScanner,
                 {"kitti_pose", "kitti_calibration", "kitti_points", "kitti_sizes", "kitti_middles"}});
}

TEST_CASE("several datasets of one run are those of runs of their own, and YOLO is made of COCO") {
  const TemporaryFolder folder;
  write_text(folder / "stool.urdf", kStool);
  write_text(folder / "scene.xml", dataset_scene("color depth instance boxes silhouettes", kStools));
  make_dataset(folder / "scene.xml", folder / "all", {"--dataset", "coco,kitti", "--dataset", "tum"});
  for (const char* format : {"coco", "kitti", "tum"}) {
    CAPTURE(std::string(format));
    make_dataset(folder / "scene.xml", folder / format, {"--dataset", format});
    CHECK(bytes_below(folder / "all" / format) == bytes_below(folder / format));
  }
  // A run that goes on makes what is missing, and nothing else.
  fs::remove(folder / "all/kitti/.simvis/frames/000002.json");
  fs::remove(folder / "all/kitti/sequences/00/image_2/000002.png");
  make_dataset(folder / "scene.xml", folder / "all", {"--dataset", "coco,kitti,tum", "--resume"});
  CHECK(bytes_below(folder / "all/kitti") == bytes_below(folder / "kitti"));

  if (!has_readers("yaml")) return;
  make_dataset(folder / "scene.xml", folder / "run", {"--format", "color=png", "--format", "depth=npy"});
  const std::string yolo = (folder / "yolo").string();
  const ProcessResult made =
      Process({kReadersPython, SIMVIS_SOURCE_DIR "/python/examples/coco_to_yolo.py", (folder / "coco").string(), yolo})
          .wait();
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const ProcessResult read = Process({kReadersPython, kScripts + "yolo.py", yolo, (folder / "run").string()}).wait();
  CHECK_MESSAGE(read.exit_code == 0, read.err);
}

TEST_CASE("SemanticKITTI has the labels of the points, and swapped halves are found") {
  check_dataset({"semantickitti", "kitti.py", "pykitti, evo", kDatasetScanner, {"kitti_labels"}});
}

}  // namespace
}  // namespace simvis

// Where files of ROS packages and Gazebo models are found, in which order, and what is said of lost ones.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "import/model/package_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr const char* kModelVariables[] = {"GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH",
                                           "SDF_PATH"};
constexpr const char* kVariables[] = {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", kModelVariables[0],
                                      kModelVariables[1], kModelVariables[2],  kModelVariables[3]};

// Sets one of the variables and unsets the others, until the end of the block.
class SearchPath {
 public:
  SearchPath(const std::string& variable, const std::string& value) {
    for (const char* each : kVariables) ::unsetenv(each);
    ::setenv(variable.c_str(), value.c_str(), 1);
  }
  ~SearchPath() {
    for (const char* each : kVariables) ::unsetenv(each);
  }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;
};

// A URDF in ws/robot/urdf, and files elsewhere. The variables of this machine's ROS are unset.
class Workspace {
 public:
  Workspace() {
    for (const char* each : kVariables) ::unsetenv(each);
    std::filesystem::create_directories(urdf().parent_path());
  }
  std::filesystem::path urdf() const { return folder_ / "ws/robot/urdf/r.urdf"; }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void add(const std::string& file, const std::string& text = "") const {
    std::filesystem::create_directories(path(file).parent_path());
    write_text(path(file), text);
  }
  void add_package(const std::string& folder, const std::string& name) const {
    add(folder + "/package.xml", "<?xml version=\"1.0\"?><package format=\"2\"><name> " + name + " </name></package>");
  }
  // The file found, relative to the folder of the test; or "none".
  std::string find(const std::string& name, std::vector<std::string> expected_warnings = {},
                   std::vector<PackageFolder> given = {}) const {
    PackageFiles packages(urdf(), std::move(given));
    const auto found = packages.find(name, {.file = "r.urdf", .line = 3});
    CHECK(packages.release_warnings() == expected_warnings);
    return found ? found->lexically_normal().lexically_relative(folder_.path()).string() : "none";
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("packages: given, then ROS_PACKAGE_PATH, AMENT_PREFIX_PATH, then beside and above") {
  const Workspace ws;
  const std::string name = "package://pkg/meshes/m.stl";
  CHECK(ws.find(name) == "none");
  ws.add("ws/pkg/meshes/m.stl");
  CHECK(ws.find(name) == "ws/pkg/meshes/m.stl");
  ws.add_package("ws/robot/other_name", "pkg");
  ws.add("ws/robot/other_name/meshes/m.stl");
  CHECK(ws.find(name) == "ws/robot/other_name/meshes/m.stl");
  ws.add_package("ws/robot", "pkg");
  ws.add("ws/robot/meshes/m.stl");
  CHECK(ws.find(name) == "ws/robot/meshes/m.stl");
  ws.add("ament/share/pkg/meshes/m.stl");
  {
    const SearchPath path("AMENT_PREFIX_PATH", "/nowhere:" + ws.path("ament").string());
    CHECK(ws.find(name) == "ament/share/pkg/meshes/m.stl");
  }
  ws.add_package("ros/group/deep", "pkg");
  ws.add("ros/group/deep/meshes/m.stl");
  ws.add_package("ros/group/deep/inner", "inner");
  ws.add_package("ros/hidden/ignored", "ignored");
  ws.add("ros/hidden/CATKIN_IGNORE");
  {
    const SearchPath path("ROS_PACKAGE_PATH", ws.path("ros").string());
    CHECK(ws.find(name) == "ros/group/deep/meshes/m.stl");
    CHECK(ws.find("$(find pkg)/meshes/m.stl") == "ros/group/deep/meshes/m.stl");
    CHECK(ws.find("file://$(find pkg)/meshes/m.stl") == "ros/group/deep/meshes/m.stl");
    const auto known = PackageFiles(ws.urdf(), {}).packages();
    CHECK(known.contains("pkg"));
    CHECK(!known.contains("inner"));
    CHECK(!known.contains("ignored"));
    ws.add("given/meshes/m.stl");
    CHECK(ws.find(name, {}, {{"pkg", ws.path("given")}}) == "given/meshes/m.stl");
    CHECK(ws.find(name, {}, {{"other", ws.path("given")}}) == "ros/group/deep/meshes/m.stl");
    CHECK(ws.find(name, {}, {{"pkg", ws.path("ws")}}) == "ros/group/deep/meshes/m.stl");
  }
}

TEST_CASE("package:// without a package is a file beside the robot, or near by") {
  const Workspace ws;
  CHECK(ws.find("package://m.obj") == "none");
  ws.add("ws/robot/urdf/m.obj");
  CHECK(ws.find("package://m.obj") == "ws/robot/urdf/m.obj");
}

TEST_CASE("models: the paths of Gazebo, then beside and above") {
  const Workspace ws;
  ws.add("ws/chair/meshes/m.dae");
  ws.add("models/chair/meshes/m.dae");
  CHECK(ws.find("model://chair/meshes/m.dae") == "ws/chair/meshes/m.dae");
  ws.add("ws/models/table/meshes/m.dae");
  CHECK(ws.find("model://table/meshes/m.dae") == "ws/models/table/meshes/m.dae");
  CHECK(ws.find("package://table/meshes/m.dae") == "none");
  for (const char* variable : kModelVariables) {
    const SearchPath path(variable, ws.path("models").string());
    CHECK(ws.find("model://chair/meshes/m.dae") == "models/chair/meshes/m.dae");
    CHECK(ws.find("package://chair/meshes/m.dae") == "ws/chair/meshes/m.dae");
  }
}

TEST_CASE("plain names start at the URDF's folder, backslashes are slashes") {
  const Workspace ws;
  ws.add("ws/robot/meshes/m.stl");
  ws.add("ws/robot/urdf/n.stl");
  CHECK(ws.find("n.stl") == "ws/robot/urdf/n.stl");
  CHECK(ws.find("..\\meshes\\m.stl") == "ws/robot/meshes/m.stl");
  CHECK(ws.find("file://" + ws.path("ws/robot/meshes/m.stl").string()) == "ws/robot/meshes/m.stl");
  CHECK(ws.find("m.stl") == "none");
}

TEST_CASE("lost files are taken from near by, with one warning for each package") {
  const Workspace ws;
  ws.add("ws/robot/meshes/m.stl");
  ws.add("ws/robot/meshes/n.stl");
  const std::string taken = "\"" + ws.path("ws/robot/meshes/m.stl").string() + "\" is taken instead";
  CHECK(ws.find("package://old/meshes/m.stl", {"r.urdf:3: package \"old\" is not there or lacks \"meshes/m.stl\"; " +
                                               taken + ", and other files from near by too"}) ==
        "ws/robot/meshes/m.stl");
  CHECK(ws.find("C:\\Users\\me\\robot\\meshes\\m.stl",
                {"r.urdf:3: file \"C:\\Users\\me\\robot\\meshes\\m.stl\" is not there; " + taken}) ==
        "ws/robot/meshes/m.stl");
  PackageFiles packages(ws.urdf(), {});
  CHECK(packages.find("package://old/meshes/m.stl", {}));
  CHECK(packages.find("package://old/meshes/n.stl", {}));
  CHECK(packages.release_warnings().size() == 1);
  // A file alone says too little: it must lie in the folder that the name gives.
  CHECK(ws.find("package://old/visual/m.stl") == "none");
}

TEST_CASE("names that differ in upper and lower case, with a warning") {
  const Workspace ws;
  ws.add("ws/robot/meshes/Arm.STL");
  const std::string taken = "\"" + ws.path("ws/robot/meshes/Arm.STL").string() + "\" is taken instead";
  CHECK(ws.find("../Meshes/arm.stl", {"r.urdf:3: file \"../Meshes/arm.stl\" is not there; " + taken}) ==
        "ws/robot/meshes/Arm.STL");
  ws.add("ws/robot/meshes/arm.stl");
  CHECK(ws.find("../meshes/arm.stl") == "ws/robot/meshes/arm.stl");
  CHECK(ws.find("../meshes/leg.stl") == "none");
}

TEST_CASE("a file that is not there: the places that were tried") {
  const Workspace ws;
  ws.add_package("ws/pkg", "pkg");
  PackageFiles packages(ws.urdf(), {{"pkg", ws.path("ws")}});
  CHECK(!packages.find("package://pkg/meshes/m.stl", {}));
  CHECK(packages.tried() == "tried " + ws.path("ws/meshes/m.stl").string() +
                                ", ROS_PACKAGE_PATH (not set), AMENT_PREFIX_PATH (not set), " +
                                ws.path("ws/pkg/meshes/m.stl").string() + ", folders of this name beside and above " +
                                ws.urdf().parent_path().string() + ", \"meshes/m.stl\" up to 3 folders above");
}

TEST_SUITE_END();

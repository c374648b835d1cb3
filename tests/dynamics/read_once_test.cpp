// Files of robots are read once: what physics wants follows from what the importer has read.
#include <doctest/doctest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "simvis/scene_builder.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Counts how often each file of a folder is opened, by name.
class OpenedFiles {
 public:
  explicit OpenedFiles(const std::filesystem::path& folder) : descriptor_(::inotify_init1(IN_NONBLOCK)) {
    REQUIRE(descriptor_ >= 0);
    // Equal events that follow each other become one, so that the closing between two openings is asked for, too.
    REQUIRE(::inotify_add_watch(descriptor_, folder.c_str(), IN_OPEN | IN_CLOSE) >= 0);
  }
  ~OpenedFiles() { ::close(descriptor_); }
  OpenedFiles(const OpenedFiles&) = delete;
  OpenedFiles& operator=(const OpenedFiles&) = delete;

  std::map<std::string, int> counts() {
    std::map<std::string, int> counts;
    std::array<char, 16384> buffer{};
    for (ssize_t size = 0; (size = ::read(descriptor_, buffer.data(), buffer.size())) > 0;) {
      for (ssize_t at = 0; at < size;) {
        inotify_event event{};
        std::memcpy(&event, &buffer[static_cast<std::size_t>(at)], sizeof(event));
        if (event.len > 0 && (event.mask & IN_OPEN) != 0)
          ++counts[&buffer[static_cast<std::size_t>(at) + sizeof(event)]];
        at += static_cast<ssize_t>(sizeof(event) + event.len);
      }
    }
    return counts;
  }

 private:
  int descriptor_;
};

const char* const kOnceSdf =
    "<sdf version='1.9'><world name='w'><gravity>0 0 -9.8</gravity><model name='m'><link name='l'><inertial><mass>1"
    "</mass></inertial><visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual></link></model>"
    "</world></sdf>";
const char* const kOnceMjcf =
    "<mujoco><worldbody><body name='b'><freejoint/><geom type='box' size='1 1 1'/></body></worldbody></mujoco>";

TEST_CASE("a file of a robot is read once, by its part, its physics and its robot together") {
  struct Row {
    std::string file, text, world, element;
  };
  for (const Row& row : {Row{"r.urdf", kPendulum, "", "robot"}, Row{"w.sdf", kOnceSdf, "world='R'", "models"},
                         Row{"m.xml", kOnceMjcf, "world='R'", "models"}}) {
    CAPTURE(row.file);
    const TemporaryFolder folder;
    std::ofstream(folder.path() / row.file) << row.text;
    OpenedFiles opened(folder.path());
    MovingScene scene("<part name='R' insert_at='ROOT' file='" + row.file + "'/>\n" + physics(row.world) +
                          "<element type='" + row.element + "' name='E' insert_at='R'/>",
                      folder.path());
    scene.go_to(0.1);
    CHECK(opened.counts()[row.file] == 1);
  }
}

TEST_CASE("a mesh and a field of heights of MJCF are read once, for the picture and for physics") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.xml")
      << "<mujoco><asset><mesh name='m' file='m.obj'/><hfield name='h' file='h.png' size='9 9 1 1'/></asset><worldbody>"
         "<geom type='hfield' hfield='h'/><body name='b' pos='0 0 9'><freejoint/><geom type='mesh' mesh='m'/></body>"
         "</worldbody></mujoco>";
  std::ofstream(folder.path() / "m.obj") << obj_box();
  write_bytes(folder.path() / "h.png", png(2, 2, 8, 0, {{0, 255}, {255, 0}}));
  const std::string part = "<part name='R' insert_at='ROOT' file='m.xml'/>";
  OpenedFiles seen(folder.path());
  build_scene(parse_commands(part, "s.xml", folder.path()));
  const std::map<std::string, int> once = seen.counts();
  CHECK(once.size() == 3);
  OpenedFiles opened(folder.path());
  MovingScene scene(part + physics("world='R'") + "<element type='models' name='E' insert_at='R'/>", folder.path());
  scene.go_to(0.1);
  CHECK(opened.counts() == once);
}

// How often files are opened for a part alone, and for the part with physics.
std::pair<std::map<std::string, int>, std::map<std::string, int>> opened_without_and_with_physics(
    const std::filesystem::path& folder, const std::string& file, const std::string& element) {
  const std::string part = "<part name='R' insert_at='ROOT' file='" + file + "'/>";
  OpenedFiles seen(folder);
  build_scene(parse_commands(part, "s.xml", folder));
  const std::map<std::string, int> once = seen.counts();
  OpenedFiles opened(folder);
  MovingScene scene(part + physics("") + "<element type='" + element + "' name='E' insert_at='R'/>", folder);
  scene.go_to(0.1);
  return {once, opened.counts()};
}

TEST_CASE("a mesh that is seen and collides is read once, in URDF and SDF") {
  const std::string mesh = "<geometry><mesh filename='m.obj' scale='2 1 1'/></geometry>";
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  const std::string urdf_link = inertial + "<visual>" + mesh + "</visual><collision>" + mesh + "</collision></link>";
  const std::string shape = "<geometry><mesh><uri>m.obj</uri><scale>2 1 1</scale></mesh></geometry>";
  const std::string sdf_link = "<inertial><mass>1</mass></inertial><visual name='v'>" + shape +
                               "</visual><collision name='c'>" + shape + "</collision></link>";
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.obj") << obj_box();
  std::ofstream(folder.path() / "r.urdf") << "<robot name='r'><link name='a'>" + urdf_link + "<link name='b'>" +
                                                 urdf_link +
                                                 "<joint name='j' type='fixed'><parent link='a'/><child link='b'/>"
                                                 "</joint></robot>";
  std::ofstream(folder.path() / "w.sdf") << "<sdf version='1.9'><world name='w'><model name='m'><link name='l'>" +
                                                sdf_link + "</model></world></sdf>";
  for (const auto& [file, element] : {std::pair("r.urdf", "robot"), std::pair("w.sdf", "models")}) {
    CAPTURE(std::string(file));
    const auto [once, opened] = opened_without_and_with_physics(folder.path(), file, element);
    CHECK(once.size() == 2);
    CHECK(opened == once);
  }
}

// SimVis itself looks whether it is a pointer of Git LFS; the program that reads meshes opens it once.
TEST_CASE("a PLY file of faces is read once") {
  const std::string vertices =
      "property float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.ply") << "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices;
  OpenedFiles opened(folder.path());
  build_scene(parse_commands("<part name='R' insert_at='ROOT' file='m.ply'/>", "s.xml", folder.path()));
  CHECK(opened.counts()["m.ply"] == 2);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();

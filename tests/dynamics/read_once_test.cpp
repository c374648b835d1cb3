// Files of robots are read once: what physics wants follows from what the importer has read.
#include <doctest/doctest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>
#include <map>

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
    REQUIRE(::inotify_add_watch(descriptor_, folder.c_str(), IN_OPEN) >= 0);
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
        if (event.len > 0) ++counts[&buffer[static_cast<std::size_t>(at) + sizeof(event)]];
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

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();

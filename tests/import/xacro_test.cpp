// xacro files are expanded by the program xacro, which the tests replace by a script of their own.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "import/urdf/xacro.h"
#include "tests/support/error_of.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// A file r.urdf.xacro, and a program xacro in the only folder of PATH besides those of the system's programs.
class XacroFile {
 public:
  explicit XacroFile(const std::string& script) : path_(std::getenv("PATH")) {
    write_text(file(), "<robot name='r' xmlns:xacro='x'><xacro:arm/></robot>");
    if (!script.empty()) {
      write_text(folder_ / "xacro", "#!/bin/sh\n" + script + "\n");
      std::filesystem::permissions(folder_ / "xacro", std::filesystem::perms::owner_all);
    }
    ::setenv("PATH", (folder_.path().string() + ":/usr/bin:/bin").c_str(), 1);
  }
  ~XacroFile() { ::setenv("PATH", path_.c_str(), 1); }
  XacroFile(const XacroFile&) = delete;
  XacroFile& operator=(const XacroFile&) = delete;

  std::filesystem::path file(const std::string& name = "r.urdf.xacro") const { return folder_ / name; }
  BuiltScene build(const std::string& attributes = "") const {
    return build_scene(parse_commands("<part file='r.urdf.xacro' name='R' insert_at='ROOT' " + attributes + "/>",
                                      "s.xml", folder_.path()));
  }

 private:
  TemporaryFolder folder_;
  std::string path_;
};

constexpr const char* kExpanded =
    "printf '%s\\n' 'note: old syntax' >&2; printf '%s\\n' \"<?xml version='1.0'?><robot name='r'>"
    "<link name='$2'/></robot>\"";

}  // namespace

TEST_CASE("xacro gets the file and the part's arguments; what it prints before the XML is no part of it") {
  const XacroFile xacro(kExpanded);
  CHECK(xacro.build("xacro_arguments='side:=left'").scene.has_insertion_point("side:=left"));
  for (const std::string wrong : {"side", ":=left", "-o:=x"}) {
    CHECK(contains(error_of([&] { xacro.build("xacro_arguments='" + wrong + "'"); }),
                   "attribute \"xacro_arguments\": \"" + wrong + "\" is not allowed, expected NAME:=VALUE"));
  }
  write_text(xacro.file("plain.urdf"), robot(link_xml("a")));
  CHECK(contains(error_of([&] {
                   build_scene(
                       parse_commands("<part file='plain.urdf' name='R' insert_at='ROOT' xacro_arguments='a:=b'/>",
                                      "s.xml", xacro.file("plain.urdf").parent_path()));
                 }),
                 "plain.urdf: attribute \"xacro_arguments\" is not allowed: the file is no xacro"));
}

TEST_CASE("a .urdf with elements of xacro is xacro") {
  const XacroFile xacro("echo \"<?xml version='1.0'?><robot name='r'><link name='a'/></robot>\"");
  std::filesystem::copy(xacro.file(), xacro.file("r.urdf"));
  const BuiltScene built = build_scene(
      parse_commands("<part file='r.urdf' name='R' insert_at='ROOT'/>", "s.xml", xacro.file("r.urdf").parent_path()));
  CHECK(built.scene.has_insertion_point("a"));
}

TEST_CASE("a .urdf whose elements of xacro cannot be expanded is read without them") {
  const XacroFile xacro("echo 'unknown macro: arm'; exit 2");
  const auto build = [&](const std::string& content) {
    write_text(xacro.file("r.urdf"), "<robot name='r' xmlns:xacro='x'>" + content + "</robot>");
    return build_scene(
        parse_commands("<part file='r.urdf' name='R' insert_at='ROOT'/>", "s.xml", xacro.file("r.urdf").parent_path()));
  };
  const BuiltScene built = build("<link name='a'/><xacro:arm/>");
  CHECK(built.scene.has_insertion_point("a"));
  REQUIRE(built.scene.warnings().size() == 1);
  CHECK(built.scene.warnings()[0] ==
        xacro.file("r.urdf").string() +
            ": xacro cannot expand it: unknown macro: arm; its elements of xacro are ignored");
  CHECK(contains(error_of([&] { build("<link name='${side}'/><xacro:arm/>"); }), "r.urdf: xacro cannot expand it"));
}

TEST_CASE("a robot without a name") {
  const TemporaryFolder folder;
  write_text(folder / "r.urdf", "<robot><link name='a'/></robot>");
  const BuiltScene built =
      build_scene(parse_commands("<part file='r.urdf' name='R' insert_at='ROOT'/>", "s.xml", folder.path()));
  CHECK(built.scene.warnings() ==
        std::vector<std::string>{(folder / "r.urdf").string() + ":1:2: the robot has no name"});
}

TEST_CASE("xacro that is not there, fails or writes something else") {
  if (!std::filesystem::exists("/usr/bin/xacro") && !std::filesystem::exists("/bin/xacro")) {
    CHECK(contains(error_of([] { XacroFile("").build(); }),
                   "r.urdf.xacro: is xacro, and there is no program xacro in PATH to expand it; install it"));
  }
  CHECK(contains(error_of([] { XacroFile("echo 'unknown macro'; echo 'in r.xacro' >&2; exit 2").build(); }),
                 "r.urdf.xacro: xacro cannot expand it: unknown macro in r.xacro"));
  CHECK(contains(error_of([] { XacroFile("exit 2").build(); }), "xacro cannot expand it: ended with exit status 2"));
  CHECK(contains(error_of([] { XacroFile("echo hello").build(); }), "xacro cannot expand it: hello"));
  CHECK(contains(error_of([] { XacroFile("printf \"<?xml version='1.0'?>\\n<robot\"").build(); }),
                 "r.urdf.xacro(expanded):2:6: malformed XML"));
}

TEST_CASE("a machine that fails while xacro runs is no fault of the file") {
  for (const char* text :
       {"OSError: [Errno 28] No space left on device: x", "OSError: [Errno 5] Input/output error", "MemoryError"}) {
    const std::string print = std::string("echo \"") + text + "\" >&2; exit 1";
    CHECK(contains(machine_error_of([&] { XacroFile(print).build(); }), text));
  }
  CHECK(contains(machine_error_of([] { XacroFile("kill -KILL $$").build(); }), "xacro was killed"));
  CHECK(contains(error_of([] { XacroFile("echo '[Errno 2] No such file' >&2; exit 1").build(); }), "No such file"));
}

TEST_CASE("xacro gets the places of packages, and nothing of that remains") {
  const XacroFile xacro(
      "test -e \"${PYTHONPATH%%:*}/ament_index_python/packages.py\" || exit 3\n"
      "grep -q '\"my_pkg\":\"/' \"${PYTHONPATH%%:*}/ament_index_python/packages.py\" || exit 4\n"
      "echo \"<?xml version='1.0'?><robot name='${PYTHONPATH%%:*}'><link name='a'/></robot>\"");
  std::filesystem::create_directory(xacro.file("my_pkg"));
  const BuiltScene built = xacro.build();
  const std::string folder = built.scene.find_node("R") == nullptr ? "" : "found";
  CHECK(folder == "found");
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path())) {
    CHECK(!entry.path().filename().string().starts_with("simvis-xacro-"));
  }
}

TEST_SUITE_END();

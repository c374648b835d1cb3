// xacro files are expanded by the module xacro, which most tests replace by one of their own. The kernel holds what
// runs there.
#include <doctest/doctest.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/input_log.h"
#include "import/sandbox/python_program.h"
#include "import/urdf/xacro.h"
#include "simvis/sharing/allowed_folders.h"
#include "tests/support/error_of.h"
#include "tests/support/python_package.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// A value of an environment variable for the length of a test.
class XacroVariable {
 public:
  XacroVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~XacroVariable() {
    if (before_) {
      ::setenv(name_, before_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  XacroVariable(const XacroVariable&) = delete;
  XacroVariable& operator=(const XacroVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

void write_program(const std::filesystem::path& file, const std::string& text) {
  write_text(file, text);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

// A file r.urdf.xacro, a program xacro in PATH, and a module xacro whose main() is `code`. Without code there is
// neither program nor module.
class XacroFile {
 public:
  explicit XacroFile(const std::string& code)
      : path_("PATH", (folder_ / "bin").string() + ":/usr/bin:/bin"),
        modules_("PYTHONPATH", (folder_ / "modules").string()) {
    write_text(file(), "<robot name='r' xmlns:xacro='x'><xacro:arm/></robot>");
    std::filesystem::create_directory(folder_ / "bin");
    std::filesystem::create_directory(folder_ / "modules");
    if (code.empty()) return;
    write_program(folder_ / "bin/xacro", "#!/usr/bin/env python3\nimport xacro\nxacro.main()\n");
    write_text(folder_ / "modules/xacro.py", "import os, sys\n\ndef main():\n    " + code + "\n");
  }

  std::filesystem::path file(const std::string& name = "r.urdf.xacro") const { return folder_ / name; }
  BuiltScene build(const std::string& attributes = "", const std::string& name = "r.urdf.xacro") const {
    return build_scene(parse_commands("<part file='" + name + "' name='R' insert_at='ROOT' " + attributes + "/>",
                                      "s.xml", folder_.path()));
  }
  std::string error() const {
    return error_of([&] { build(); });
  }

 private:
  TemporaryFolder folder_;
  XacroVariable path_, modules_;
};

// A robot whose only link is named by the expression of Python.
std::string link_named(const std::string& expression) {
  return "print(\"<?xml version='1.0'?>\\n<robot name='r'><link name='%s'/></robot>\" % (" + expression + "))";
}

// The program xacro of tools/python_tools, and a folder with files of robots for it.
class RealXacro {
 public:
  RealXacro() : path_("PATH", std::filesystem::path(kToolsPython).parent_path().string() + ":/usr/bin:/bin") {}

  const TemporaryFolder& folder() const { return folder_; }
  // A robot with this between its links "a" and "b"; `name` may be a .urdf.
  BuiltScene build(const std::string& content, const std::string& name = "r.xacro",
                   const std::string& attributes = "") const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_text(folder_ / name, "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>" + link_xml("a") +
                                   content + link_xml("b") + joint_xml("j", "fixed", "a", "b") + "</robot>");
    return build_scene(parse_commands("<part file='" + name + "' name='R' insert_at='ROOT' " + attributes + "/>",
                                      "s.xml", folder_.path()));
  }
  std::string error(const std::string& content, const std::string& name = "r.xacro") const {
    return error_of([&] { build(content, name); });
  }

 private:
  TemporaryFolder folder_;
  XacroVariable path_;
};

bool has_landlock_for_xacro() {
  return ::syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0;
}

// An expression whose code escapes from xacro's checks, and which calls os.NAME.
std::string escape(const std::string& call) {
  return "${(lambda: [c for c in ().__class__.__base__.__subclasses__() if "
         "c.__name__=='_wrap_close'][0].__init__.__globals__" +
         call + ")()}";
}

}  // namespace

TEST_CASE("xacro gets the file and the part's arguments; what it prints before the XML is no part of it") {
  const XacroFile xacro("print('note: old syntax'); " + link_named("sys.argv[2]"));
  CHECK(xacro.build("xacro_arguments='side:=left'").scene.has_insertion_point("side:=left"));
  for (const std::string wrong : {"side", ":=left", "-o:=x"}) {
    CHECK(contains(error_of([&] { xacro.build("xacro_arguments='" + wrong + "'"); }),
                   "attribute \"xacro_arguments\": \"" + wrong + "\" is not allowed, expected NAME:=VALUE"));
  }
  write_text(xacro.file("plain.urdf"), robot(link_xml("a")));
  CHECK(contains(error_of([&] { xacro.build("xacro_arguments='a:=b'", "plain.urdf"); }),
                 "plain.urdf: attribute \"xacro_arguments\" is not allowed: the file is no xacro"));
}

TEST_CASE("a .urdf with elements of xacro is xacro") {
  const XacroFile xacro(link_named("'a'"));
  std::filesystem::copy(xacro.file(), xacro.file("r.urdf"));
  CHECK(xacro.build("", "r.urdf").scene.has_insertion_point("a"));
}

TEST_CASE("a .urdf whose elements of xacro cannot be expanded is read without them") {
  const XacroFile xacro("print('unknown macro: arm'); sys.exit(2)");
  const auto build = [&](const std::string& content) {
    write_text(xacro.file("r.urdf"), "<robot name='r' xmlns:xacro='x'>" + content + "</robot>");
    return xacro.build("", "r.urdf");
  };
  const BuiltScene built = build("<link name='a'/><xacro:arm/>");
  CHECK(built.scene.has_insertion_point("a"));
  REQUIRE(built.scene.warnings().size() == 1);
  CHECK(built.scene.warnings()[0] ==
        xacro.file("r.urdf").string() +
            ": xacro cannot expand it: unknown macro: arm; its elements of xacro are ignored");
  CHECK(contains(error_of([&] { build("<link name='${side}'/><xacro:arm/>"); }), "xacro cannot expand it"));
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
    CHECK(contains(XacroFile("").error(), "is xacro, and there is no program xacro in PATH to expand it; install it"));
  }
  const XacroFile without_module("pass");
  std::filesystem::remove(without_module.file("modules/xacro.py"));
  CHECK(contains(without_module.error(), "cannot load the module xacro"));
  CHECK(contains(XacroFile("print('unknown macro'); sys.stderr.write('in r.xacro'); sys.exit(2)").error(),
                 "xacro cannot expand it: unknown macro in r.xacro"));
  CHECK(contains(XacroFile("sys.exit(2)").error(), "xacro cannot expand it: it prints nothing"));
  CHECK(contains(XacroFile("print('hello')").error(), "xacro cannot expand it: hello"));
  CHECK(contains(XacroFile("print(\"<?xml version='1.0'?>\\n<robot\")").error(),
                 "r.urdf.xacro(expanded):2:7: malformed XML"));
}

TEST_CASE("a machine that fails while xacro runs is no fault of the file") {
  for (const char* text :
       {"OSError: [Errno 28] No space left on device: x", "OSError: [Errno 5] Input/output error", "MemoryError"}) {
    const XacroFile xacro(std::string("sys.exit(print('") + text + "', file=sys.stderr) or 1)");
    CHECK(contains(machine_error_of([&] { xacro.build(); }), text));
  }
  CHECK(contains(machine_error_of([] { XacroFile("os.kill(os.getpid(), 9)").build(); }), "xacro was killed"));
  CHECK(contains(XacroFile("print('[Errno 2] No such file'); sys.exit(1)").error(), "No such file"));
}

TEST_CASE("xacro gets the places of packages") {
  const XacroFile xacro("from ament_index_python.packages import get_package_share_directory as f; " +
                        link_named("f('my_pkg').split('/')[-1]"));
  std::filesystem::create_directory(xacro.file("my_pkg"));
  CHECK(xacro.build().scene.has_insertion_point("my_pkg"));
  // In the root, which all share, folders without package.xml are no packages.
  const XacroFile of_system("from ament_index_python.packages import get_package_share_directory as f; f('etc')");
  CHECK(contains(of_system.error(), "there is no package \"etc\""));
}

TEST_CASE("programs are not taken from entries of PATH that are empty or relative") {
  const TemporaryFolder folder;
  for (const char* name : {"xacro", "python3"}) write_program(folder / name, "#!/bin/sh\ntouch ran\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const std::vector<std::string> paths{"", ":", ".", ":.:./:../" + folder.path().filename().string()};
  for (const std::string& path : paths) {
    const XacroVariable variable("PATH", path);
    CHECK_FALSE(program_in_path("xacro"));
    CHECK_FALSE(program_in_path("python3"));
    CHECK_FALSE(python_of("/bin/true"));
  }
  std::filesystem::current_path(before);
  const XacroVariable variable("PATH", ":" + folder.path().string());
  CHECK(program_in_path("xacro") == folder / "xacro");
}

TEST_CASE("the Python of the program xacro is the one that its first line names") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "with space");
  const std::filesystem::path python = folder / "python3.11", other = folder / "with space/python3";
  write_program(python, "");
  write_program(other, "");
  write_program(folder / "python3", "");
  const XacroVariable path("PATH", folder.path().string());
  const auto python_of_text = [&](const std::string& text) {
    write_program(folder / "xacro", text);
    return python_of(folder / "xacro");
  };
  CHECK(python_of_text("#!" + python.string() + "\nimport xacro\n") == python);
  CHECK(python_of_text("#!/usr/bin/env python3\n") == folder / "python3");
  CHECK(python_of_text("#!/usr/bin/env -S python3.11 -E\n") == python);
  CHECK(python_of_text("#!/bin/sh\n'''exec' \"" + other.string() + "\" \"$0\" \"$@\"\n' '''\n") == other);
  // A program that starts another one.
  CHECK(python_of_text("#!/usr/bin/env bash\nexec pyenv exec xacro\n") == folder / "python3");
}

TEST_CASE("what runs in the process of xacro reads its folders, sees few variables and does nothing else") {
  const TemporaryFolder outside;
  write_text(outside / "secret", "secret");
  const auto outcome = [&](const std::string& act) {
    const XacroFile xacro("try:\n        " + act +
                          "\n        said = 'works'\n    except OSError:\n        said = 'refused'\n    " +
                          link_named("said"));
    write_text(xacro.file("own"), "own");
    return xacro.build().scene.has_insertion_point("works") ? "works" : "refused";
  };
  CHECK(outcome("open(os.path.dirname(sys.argv[1]) + '/own').read()") == std::string("works"));
  for (const std::string& act : std::vector<std::string>{
           "open(os.path.dirname(sys.argv[1]) + '/new', 'w')", "os.remove(os.path.dirname(sys.argv[1]) + '/own')",
           "__import__('socket').socket()", "os.kill(os.getppid(), 0)", "__import__('fcntl').fcntl(3, 8, os.getppid())",
           "os.setpriority(0, 0, 5)"}) {
    CAPTURE(act);
    CHECK(outcome(act) == std::string("refused"));
  }
  for (const std::string act : {"os.fork()", "os.posix_spawn('/bin/true', ['true'], {})",
                                "os.execv('/bin/true', ['true'])", "os.system('true')"}) {
    CAPTURE(act);
    CHECK(contains(error_of([&] { outcome(act); }), "xacro was ended, since the file made it start another program"));
  }
  if (has_landlock_for_xacro()) {
    const std::vector<std::string> files{"/etc/passwd", "/proc/self/environ", (outside / "secret").string()};
    for (const std::string& file : files) {
      CAPTURE(file);
      CHECK(outcome("open('" + file + "').read()") == std::string("refused"));
    }
  } else {
    MESSAGE("not tested whether other files can be read: this kernel has no Landlock");
  }
  const XacroVariable distribution("ROS_DISTRO", "jazzy"), secret("SECRET_TOKEN", "secret");
  const BuiltScene built = XacroFile(link_named("' '.join(sorted(os.environ))")).build();
  CHECK(built.scene.has_insertion_point("ROS_DISTRO ROS_PACKAGE_PATH"));
}

TEST_CASE("a request gives xacro no argument in which code could stand") {
  const TemporaryFolder folder;
  const AllowedFolders allowed(std::vector{folder.path()});
  const auto request = [&](const std::string& arguments) {
    return error_of([&] {
      allowed.parse("<part file='r.xacro' name='R' insert_at='ROOT' xacro_arguments=\"" + arguments + "\"/>",
                    "request");
    });
  };
  CHECK(request("size:=2 name_2:=a/b-c.d+e") == "nothing was thrown");
  for (const std::string wrong : {"size:=' + str(1) + '", "size:=$(env", "a:=b:=c", "a:=b;c", "a'b:=c"}) {
    CAPTURE(wrong);
    CHECK(contains(request(wrong), "request:1:"));
    CHECK(contains(request(wrong), "attribute \"xacro_arguments\": a request may not give"));
  }
}

TEST_CASE("a file whose expressions are code runs nothing and reads nothing") {
  if (!has_python_module("xacro")) return;
  const RealXacro xacro;
  const TemporaryFolder outside;
  CHECK(xacro.build("<link name='${1 + 1}'/>" + joint_xml("k", "fixed", "a", "2")).scene.has_insertion_point("2"));
  const std::string made = (outside / "pwned").string();
  for (const char* name : {"r.xacro", "r.urdf"}) {
    CAPTURE(name);
    const std::string system =
        xacro.error("<xacro:if value=\"" + escape("['system']('touch " + made + "')") + "\"/>", name);
    CHECK(contains(system, "xacro was ended, since the file made it start another program"));
    CHECK(contains(
        xacro.error("<xacro:property name='p' value=\"" + escape("['open']('" + made + "', 65)") + "\"/>${p}", name),
        "xacro cannot expand it"));
    CHECK_FALSE(std::filesystem::exists(made));
  }
  const XacroVariable home("HOME", "/home/of/user");
  CHECK(contains(xacro.error("<link name='$(env HOME)'/>"), "files see ROS_DISTRO"));
  CHECK(xacro.build("<link name='x$(optenv HOME none)'/>" + joint_xml("k", "fixed", "a", "xnone"))
            .scene.has_insertion_point("xnone"));
}

TEST_CASE("xacro includes and loads files of its folders and packages alone") {
  if (!has_python_module("xacro")) return;
  const RealXacro xacro;
  const TemporaryFolder outside;
  const std::string macro = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:macro name='m'>" +
                            link_xml("of_macro") + joint_xml("k", "fixed", "a", "of_macro") + "</xacro:macro></robot>";
  std::filesystem::create_directories(xacro.folder() / "other_pkg/urdf");
  for (const std::filesystem::path& file : {xacro.folder() / "other_pkg/urdf/m.xacro", outside / "m.xacro"}) {
    write_text(file, macro);
  }
  write_text(xacro.folder() / "c.yaml", "name: of_yaml\n");
  write_text(outside / "c.yaml", "name: of_yaml\n");
  const auto include = [](const std::string& file) { return "<xacro:include filename='" + file + "'/><xacro:m/>"; };
  const auto load = [](const std::string& file) {
    return "<link name=\"${xacro.load_yaml('" + file + "')['name']}\"/>" + joint_xml("k", "fixed", "a", "of_yaml");
  };
  const InputLog inputs;
  CHECK(xacro.build(include("$(find other_pkg)/urdf/m.xacro")).scene.has_insertion_point("of_macro"));
  CHECK(xacro.build(include("../other_pkg/urdf/m.xacro"), "pkg/r.xacro").scene.has_insertion_point("of_macro"));
  CHECK(xacro.build(load("c.yaml")).scene.has_insertion_point("of_yaml"));
  CHECK(std::ranges::count_if(inputs.files(), [](const auto& file) { return file.filename() == "m.xacro"; }) == 2);
  CHECK(std::ranges::count_if(inputs.files(), [](const auto& file) { return file.filename() == "c.yaml"; }) == 1);
  if (!has_landlock_for_xacro()) {
    MESSAGE("not tested whether other files can be read: this kernel has no Landlock");
    return;
  }
  for (const std::string& content : {include((outside / "m.xacro").string()), load((outside / "c.yaml").string()),
                                     load("/etc/passwd"), load("$(find etc)/passwd")}) {
    CAPTURE(content);
    CHECK(contains(xacro.error(content), "xacro cannot expand it"));
  }
  CHECK(contains(xacro.error(include((outside / "m.xacro").string())), "--package NAME=FOLDER adds a folder"));
  const std::string circle = xacro.error(include("r.xacro"));
  CHECK(contains(circle, "; a file includes itself, or a macro or a property uses itself"));
  CHECK(circle.size() < 1000);
  std::filesystem::create_directories(outside / "share/of_ament");
  write_text(outside / "share/of_ament/m.xacro", macro);
  const XacroVariable prefix("AMENT_PREFIX_PATH", outside.path().string());
  CHECK(xacro.build(include("$(find of_ament)/m.xacro")).scene.has_insertion_point("of_macro"));
  CHECK(contains(xacro.error(include("$(find of_ament)/../../m.xacro")), "xacro cannot expand it"));
  // Links of colcon build --symlink-install lead to the sources of a package.
  write_text(outside / "package.xml", "<package><name>linked</name></package>");
  std::filesystem::create_directory(xacro.folder() / "linked");
  for (const char* name : {"package.xml", "m.xacro"}) {
    std::filesystem::create_symlink(outside / name, xacro.folder() / "linked" / name);
  }
  CHECK(xacro.build(include("$(find linked)/m.xacro")).scene.has_insertion_point("of_macro"));
}

TEST_CASE("xacro ends when the process that started it is killed") {
  const XacroFile xacro("while True: pass");
  const pid_t host = ::fork();
  if (host == 0) {
    xacro.error();
    ::_exit(0);
  }
  const std::string children = "/proc/" + std::to_string(host) + "/task/" + std::to_string(host) + "/children";
  const auto is_held = [](int process) {
    const std::string status = "/proc/" + std::to_string(process) + "/status";
    return std::filesystem::exists(status) && read_text(status).find("Seccomp:\t2") != std::string::npos;
  };
  constexpr int kTries = 3000;
  int child = 0;
  for (int i = 0; i < kTries && !(child > 0 && is_held(child)); ++i) {
    ::usleep(10'000);
    const std::string list = read_text(children);
    if (!list.empty()) child = std::stoi(list);
  }
  CHECK(child > 0);
  ::kill(host, SIGKILL);
  ::waitpid(host, nullptr, 0);
  int i = 0;
  while (i < kTries && is_held(child)) {
    ::usleep(10'000);
    ++i;
  }
  CHECK(i < kTries);
}

TEST_CASE("without a filter for system calls xacro is not started") {
  const XacroFile xacro(link_named("'a'"));
  const pid_t child = ::fork();
  if (child == 0) {
    sock_filter code[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                          BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_seccomp, 0, 1),
                          BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL),
                          BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
    const sock_fprog filter{std::size(code), code};
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0) {
      ::_exit(2);
    }
    try {
      xacro.build();
    } catch (const std::exception& error) {
      const bool is_named = std::string(error.what()).find("of a process (seccomp)") != std::string::npos;
      ::_exit(is_named && dynamic_cast<const MachineError*>(&error) != nullptr ? 0 : 1);
    }
    ::_exit(1);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}

TEST_SUITE_END();

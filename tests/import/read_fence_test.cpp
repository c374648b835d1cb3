// Which files a part file may name.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "scenegraph/language/source_text.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// A robot in ws/robot/meshes, and files around it.
class FencedPart {
 public:
  FencedPart() {
    for (const char* file :
         {"secret.png", "ws/secret.png", "ws/robot/beside.png", "ws/robot/textures/t.png", "ws/robot/meshes/own.png",
          "ws/robot/meshes/below/b.png", "ws/other/package.xml", "ws/other/o.png"}) {
      fs::create_directories((folder_ / file).parent_path());
      write_text(folder_ / file, "x");
    }
  }
  fs::path operator/(const std::string& name) const { return folder_ / name; }
  fs::path part() const { return folder_ / "ws/robot/meshes/part.obj"; }
  void add(const std::string& name) const { write_text(folder_ / name, ""); }

  /// Whether the part may name the file.
  bool may_name(const std::string& name) const {
    const ReadFence fence(folders_of_part(part()));
    const fs::path file = part().parent_path() / name;
    const bool may = is_readable(file);
    if (may) {
      CHECK_NOTHROW(require_readable(file));
    } else {
      CHECK_THROWS_WITH_AS(read_whole_file(file),
                           (file.string() + ": error: lies outside the folders of the part that names it; --package "
                                            "NAME=FOLDER adds a folder")
                               .c_str(),
                           InputError);
    }
    return may;
  }

 private:
  TemporaryFolder folder_;
};

TEST_CASE("without a mark, a part may name files in its folder and in the one above") {
  const FencedPart part;
  for (const char* name : {"own.png", "below/b.png", "../textures/t.png", "../beside.png", "below/../own.png",
                           "../meshes/own.png", "not_there.png"}) {
    CAPTURE(name);
    CHECK(part.may_name(name));
  }
  for (const char* name :
       {"../../secret.png", "../../other/o.png", "below/../../../secret.png", "../../../secret.png", "/etc/hostname"}) {
    CAPTURE(name);
    CHECK_FALSE(part.may_name(name));
  }
  CHECK(part.may_name((part / "ws/robot/textures/t.png").string()));
  CHECK_FALSE(part.may_name((part / "ws/secret.png").string()));
}

TEST_CASE("a part of a package or model may name the files of all of it, and no others") {
  for (const char* mark : {"package.xml", "manifest.xml", "model.config"}) {
    const FencedPart part;
    part.add("ws/robot/meshes/" + std::string(mark));
    CHECK(part.may_name("own.png"));
    CHECK_FALSE(part.may_name("../beside.png"));
    fs::remove(part / ("ws/robot/meshes/" + std::string(mark)));
    part.add("ws/" + std::string(mark));
    CHECK(part.may_name("../../secret.png"));
    CHECK(part.may_name("../../other/o.png"));
    CHECK_FALSE(part.may_name("../../../secret.png"));
  }
}

TEST_CASE("a mark counts up to five folders above the part") {
  const TemporaryFolder folder;
  write_text(folder / "model.config", "");
  const auto may_name_all = [&](const fs::path& part) {
    const ReadFence fence(folders_of_part(part));
    return is_readable(folder / "x.png");
  };
  CHECK(may_name_all(folder / "1/2/3/4/5/part.obj"));
  CHECK_FALSE(may_name_all(folder / "1/2/3/4/5/6/part.obj"));
}

TEST_CASE("the folder above a part is not open if it is shared: temporary files, the home folder, the root") {
  const TemporaryFolder folder, home;
  const auto opens = [&](const fs::path& part, const fs::path& file) {
    const ReadFence fence(folders_of_part(part));
    return is_readable(file);
  };
  CHECK(opens(folder / "part.obj", folder / "x"));
  CHECK_FALSE(opens(folder / "part.obj", folder.path().parent_path() / "x"));
  fs::create_directories(home / "models");
  const char* const before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("HOME", home.path().c_str(), 1);
  CHECK(is_shared_folder(home.path()));
  CHECK(is_shared_folder(home.path().parent_path()));
  CHECK(is_shared_folder("/"));
  CHECK_FALSE(is_shared_folder(home / "models"));
  CHECK_FALSE(opens(home / "models/part.obj", home / "x"));
  write_text(home / "package.xml", "");  // in an archive that was unpacked there
  CHECK_FALSE(opens(home / "models/part.obj", home / "x"));
  CHECK_FALSE(opens(home / "models/car/part.obj", home / "x"));
  CHECK(opens(home / "models/car/part.obj", home / "models/x"));
  before == nullptr ? ::unsetenv("HOME") : ::setenv("HOME", kept.c_str(), 1);
  CHECK(opens("/part.obj", "/etc/hostname"));  // what is below the folder of a part is open
}

// Sets an environment variable and keeps the working directory as long as it lives.
class ChangedSurroundings {
 public:
  explicit ChangedSurroundings(const char* variable) : variable_(variable) {
    if (const char* const value = std::getenv(variable)) before_ = value;
  }
  ~ChangedSurroundings() {
    before_ ? ::setenv(variable_, before_->c_str(), 1) : ::unsetenv(variable_);
    fs::current_path(folder_);
  }
  ChangedSurroundings(const ChangedSurroundings&) = delete;
  ChangedSurroundings& operator=(const ChangedSurroundings&) = delete;
  void set(const fs::path& value) const { ::setenv(variable_, value.c_str(), 1); }

 private:
  const char* variable_;
  std::optional<std::string> before_;
  fs::path folder_ = fs::current_path();
};

TEST_CASE("the folder for temporary files is shared as soon as it is made") {
  const TemporaryFolder folder;
  const ChangedSurroundings surroundings("TMPDIR");
  surroundings.set(folder / "later");
  CHECK_FALSE(is_shared_folder(folder / "later"));
  fs::create_directory(folder / "later");
  CHECK(is_shared_folder(folder / "later"));
  const ReadFence fence(folders_of_part(folder / "later/model/part.obj"));
  CHECK_FALSE(is_readable(folder / "later/x.png"));
}

TEST_CASE("a relative folder for temporary files starts at the present working directory") {
  const TemporaryFolder folder;
  const ChangedSurroundings surroundings("TMPDIR");
  surroundings.set("temporary");
  for (const char* const name : {"first", "second"}) fs::create_directories(folder / name / "temporary");
  for (const auto& [here, elsewhere] : {std::pair("first", "second"), {"second", "first"}}) {
    fs::current_path(folder / here);
    CHECK(is_shared_folder(folder / here / "temporary"));
    CHECK_FALSE(is_shared_folder(folder / elsewhere / "temporary"));
  }
}

TEST_CASE("a folder that is shared by a link is the one to which the link leads now") {
  const TemporaryFolder folder;
  for (const char* const name : {"first", "second"}) fs::create_directories(folder / name / "model");
  const fs::path link = folder / "link";
  for (const char* const variable : {"TMPDIR", "HOME"}) {
    CAPTURE(variable);
    const ChangedSurroundings surroundings(variable);
    surroundings.set(link);
    for (const auto& [here, elsewhere] : {std::pair("first", "second"), {"second", "first"}}) {
      fs::remove(link);
      fs::create_directory_symlink(folder / here, link);
      CHECK(is_shared_folder(folder / here));
      CHECK_FALSE(is_shared_folder(folder / elsewhere));
      const ReadFence fence(folders_of_part(folder / here / "model/part.obj"));
      CHECK_FALSE(is_readable(folder / here / "x.png"));
    }
  }
}

TEST_CASE("symbolic links count where they lead, except those into a package") {
  const FencedPart part;
  fs::create_symlink(part / "ws/secret.png", part / "ws/robot/meshes/leak.png");
  fs::create_symlink(part / "ws/other/o.png", part / "ws/robot/meshes/of_package.png");
  fs::create_directory_symlink("/etc", part / "ws/robot/meshes/etc");
  fs::create_symlink(part / "ws/robot/textures/t.png", part / "ws/robot/meshes/within.png");
  CHECK_FALSE(part.may_name("leak.png"));
  CHECK_FALSE(part.may_name("etc/hostname"));
  CHECK(part.may_name("within.png"));
  CHECK(part.may_name("of_package.png"));  // as colcon installs packages with --symlink-install
}

TEST_CASE("a part that is a link itself has the folders of both places") {
  const FencedPart part;
  fs::create_directories(part / "installed/meshes");
  const fs::path link = part / "installed/meshes/part.obj";
  part.add("ws/robot/meshes/part.obj");
  fs::create_symlink(part.part(), link);
  const ReadFence fence(folders_of_part(link));
  CHECK(is_readable(part / "installed/meshes/a.png"));
  CHECK(is_readable(part / "ws/robot/textures/t.png"));
  CHECK_FALSE(is_readable(part / "ws/secret.png"));
}

TEST_CASE("a name with a NUL byte is refused, and its message shows the NUL") {
  const FencedPart part;
  const fs::path name = part.part().parent_path() / std::string("own.png\0.obj", 12);
  const std::string expected =
      (part.part().parent_path() / "own.png").string() + "\\x00.obj: error: has a NUL byte in its name";
  const auto check = [&] {
    CHECK(error_of([&] { read_whole_file(name); }).starts_with(expected));
    CHECK(error_of([&] { SourceText::read(name); }).starts_with(expected));
  };
  check();
  const ReadFence fence(folders_of_part(part.part()));
  check();
}

TEST_CASE("fences are of their thread, nested, and admit folders") {
  const FencedPart part;
  const fs::path secret = part / "ws/secret.png";
  CHECK(is_readable(secret));
  CHECK_FALSE(readable_folders());
  admit_folder(part / "ws");  // nothing to admit it to
  const ReadFence outer({part / "ws/robot"});
  CHECK_FALSE(is_readable(secret));
  std::thread([&] { CHECK(is_readable(secret)); }).join();
  {
    const ReadFence inner(folders_of_part(part / "ws/other/part.obj"));
    CHECK(is_readable(part / "ws/robot/beside.png"));  // of the outer one
    CHECK(is_readable(part / "ws/other/o.png"));
    CHECK_FALSE(is_readable(part / "secret.png"));
    admit_folder(part / ".");
    CHECK(is_readable(part / "secret.png"));
    const ReadOpening opening;
    CHECK(is_readable("/etc/hostname"));
  }
  CHECK_FALSE(is_readable(part / "ws/other/o.png"));
  CHECK_FALSE(is_readable(part / "secret.png"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();

// Which files requests of other programs may read: those below the folders of --allow, whatever names them, and
// wherever links lead in the meantime.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/scene.h>
#include <simvis/sensor.h>
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/statement_attributes.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/allowed_folders.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/sky_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// An attribute of a table that names a file, and what else a command with it needs.
struct FileRow {
  std::string ending, bytes;      ///< of a file that the attribute takes
  std::string before{}, after{};  ///< the command around ATTRIBUTE="FILE"
  bool is_late = false;           ///< the picture is read when a camera shows it
};

std::string grey_picture() {
  const test::ByteString bytes = test::png(2, 2, 8, 0, {{10, 200}, {200, 10}});
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// By "TYPE ATTRIBUTE". A row of a table that is missing here fails the tests.
std::map<std::string, FileRow> known_rows() {
  const std::string of_shape = "<part name='NEW' insert_at='ROOT' shape=";
  const std::string sky =
      test::sky_exr(test::sky_picture(8, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); }));
  return {
      {"include file", {".xml", "<scene/>", "<include", "/>"}},
      {"part file", {".stl", test::stl_box(true), "<part name='NEW' insert_at='ROOT'", "/>"}},
      {"part texture", {".png", grey_picture(), of_shape + "'box' size='1 1 1'", "/>", true}},
      {"part heights", {".png", grey_picture(), of_shape + "'heightmap' size='4 4'", "/>"}},
      {"point_cloud file", {".xyz", "0 0 0\n", "<element type='point_cloud' name='NEW' insert_at='ROOT'", "/>"}},
      {"temperature texture",
       {".png", grey_picture(), "<element type='temperature' name='NEW' insert_at='P' part='P'", "/>"}},
      {"sky_light picture", {".exr", sky, "<element type='sky_light' name='NEW' insert_at='ROOT'", "/>"}},
      {"laser_scanner pattern",
       {".csv", "azimuth_deg,elevation_deg\n0,0\n10,0\n", "<sensor type='laser_scanner' name='NEW' insert_at='ROOT'",
        "/>"}},
      {"robot srdf", {".srdf", "<robot/>", "<element type='robot' name='NEW' insert_at='ROBOT'", "/>"}},
      {"models srdf", {".srdf", "<robot/>", "<element type='models' name='NEW' insert_at='ROBOT'", "/>"}},
  };
}

/// "TYPE ATTRIBUTE" of all rows of this kind in the tables of all commands.
std::vector<std::string> rows_of_kind(AttributeKind kind) {
  std::vector<std::string> found;
  const auto add = [&](std::string_view type, AttributeTable table) {
    for (const AttributeSpec& row : table) {
      if (row.kind == kind) found.push_back(std::string(type) + " " + std::string(row.name));
    }
  };
  add("include", kIncludeRows);
  add("part", kPartCommonRows);
  add("part", Scene::part_attributes());
  for (const ElementType* const type : element_types()) add(type->name, type->attributes);
  for (const SensorType* const type : sensor_types()) add(type->name, all_attributes(*type));
  return found;
}

/// A host whose clients may name files of one folder, beside a folder of others.
class Host {
 public:
  Host() {
    for (const char* const folder : {"allowed", "outside"}) fs::create_directories(folder_ / folder);
    write_text(allowed("robot.urdf"),
               "<robot name='r'><link name='base'>" + inertial(1, "0 0 0", 0.02) + "</link></robot>");
    build(
        "<part name='P' insert_at='ROOT' shape='box' size='1 1 1'/>"
        "<element type='physics' name='PHYSICS' insert_at='ROOT'/>"
        "<part name='ROBOT' insert_at='ROOT' file='robot.urdf'/>");
  }
  fs::path allowed(const std::string& name = "") const { return folder_ / ("allowed/" + name); }
  fs::path outside(const std::string& name = "") const { return folder_ / ("outside/" + name); }

  /// What a request is answered; "done": it was carried out, and is taken back.
  std::string answer(const std::string& xml) {
    try {
      const AllowedFolders folders(std::vector<fs::path>{allowed()});
      folders.carry_out([&] { builder_->execute(folders.parse(xml, "request")); });
    } catch (const Error& error) {
      return error.what();
    }
    if (xml.find("NEW") != xml.npos) build("<remove name='NEW'/>");
    return "done";
  }
  /// The same without limits, as for the user's own scene.
  void build(const std::string& xml) { builder_->execute(parse_commands(xml, "scene.xml", allowed())); }
  BuiltScene& built() { return *built_; }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<BuiltScene> built_ = std::make_unique<BuiltScene>();
  std::unique_ptr<SceneBuilder> builder_ =
      std::make_unique<SceneBuilder>(*built_, std::span<const AttributeOverride>());
};

std::string request(const std::string& name, const FileRow& row, const std::string& file) {
  return row.before + " " + name.substr(name.find(' ') + 1) + "=\"" + file + "\"" + row.after;
}

std::string without(std::string text, const std::string& name) {
  for (std::size_t at = 0; !name.empty() && (at = text.find(name)) != text.npos;) text.replace(at, name.size(), "FILE");
  return text;
}

void replace_by_link(const fs::path& target, const fs::path& link) {
  const fs::path made = link.string() + ".new";
  fs::create_symlink(target, made);
  fs::rename(made, link);
}

/// While it lives, a name is in turns that of a file and that of a link.
class SwappedFile {
 public:
  SwappedFile(const fs::path& name, const std::string& bytes, const fs::path& target)
      : swapping_([this, name, bytes, target] {
          const fs::path file = name.string() + ".file";
          while (!ends_) {
            write_text(file, bytes);
            fs::rename(file, name);
            replace_by_link(target, name);
            ++swaps_;
          }
        }) {
    while (swaps_ == 0) std::this_thread::yield();
  }
  ~SwappedFile() {
    ends_ = true;
    swapping_.join();
  }
  SwappedFile(const SwappedFile&) = delete;
  SwappedFile& operator=(const SwappedFile&) = delete;
  int swaps() const { return swaps_; }

 private:
  std::atomic<bool> ends_ = false;
  std::atomic<int> swaps_ = 0;
  std::thread swapping_;
};

}  // namespace

TEST_CASE("an attribute that names a file is known by its kind, and its file is read in the allowed folder") {
  const std::map<std::string, FileRow> known = known_rows();
  for (const std::string& name : rows_of_kind(AttributeKind::file)) {
    CAPTURE(name);
    REQUIRE(known.contains(name));
    const FileRow& row = known.at(name);
    Host host;
    write_text(host.allowed("own" + row.ending), row.bytes);
    fs::create_symlink("own" + row.ending, host.allowed("link" + row.ending));
    CHECK(host.answer(request(name, row, "own" + row.ending)) == "done");
    CHECK(host.answer(request(name, row, host.allowed("own" + row.ending).string())) == "done");
    CHECK(host.answer(request(name, row, "link" + row.ending)) == "done");
  }
  CHECK(rows_of_kind(AttributeKind::file).size() == known.size());
  Host host;
  CHECK(host.answer("<sensor type='laser_scanner' name='NEW' insert_at='ROOT' pattern='device:velodyne_vlp16'/>") ==
        "done");
}

TEST_CASE("a request is refused each file outside, in the same words whether it is there or not") {
  int tried = 0;
  for (const auto& [name, row] : known_rows()) {
    CAPTURE(name);
    Host host;
    const std::string there = "file" + row.ending, missing = "gone" + row.ending;
    write_text(host.outside(there), row.bytes);
    fs::create_directory_symlink(host.outside(), host.allowed("folder"));
    fs::create_directories(host.allowed("below"));
    for (const std::string& file : {there, missing}) fs::create_symlink(host.outside(file), host.allowed("to_" + file));
    fs::create_symlink("to_" + there, host.allowed("link_to_" + there));
    fs::create_symlink("to_" + missing, host.allowed("link_to_" + missing));
    const std::string outside = host.outside().string();
    for (const std::string& start :
         {outside, "/proc/self/root" + outside, std::string("../outside/"), std::string("below/../../outside/"),
          std::string("gone/../../outside/"), std::string("folder/"), std::string("to_"), std::string("link_to_")}) {
      CAPTURE(start);
      const std::string refused = without(host.answer(request(name, row, start + there)), there);
      CHECK(refused.find("a request may not use the file") != refused.npos);
      CHECK(refused == without(host.answer(request(name, row, start + missing)), missing));
      ++tried;
    }
    for (const std::string& device : {std::string("/dev/zero"), std::string("/dev/../dev/zero"), std::string("zero")}) {
      if (device == "zero") fs::create_symlink("/dev/zero", host.allowed(device));
      CHECK(host.answer(request(name, row, device)).find("a request may not use the file") != std::string::npos);
    }
  }
  CHECK(tried == 8 * static_cast<int>(rows_of_kind(AttributeKind::file).size()));
}

TEST_CASE("a FIFO in the allowed folder does not stop the host") {
  for (const auto& [name, row] : known_rows()) {
    CAPTURE(name);
    if (row.is_late) continue;
    Host host;
    REQUIRE(::mkfifo(host.allowed("fifo" + row.ending).c_str(), 0600) == 0);
    CHECK(host.answer(request(name, row, "fifo" + row.ending)) != "done");
  }
}

// Read as a whole, the file in the folder is refused; so each request that succeeds has read the one outside.
TEST_CASE("a link that is swapped while a request is carried out leads to no file outside") {
  for (const auto& [name, row] : known_rows()) {
    CAPTURE(name);
    if (row.is_late) continue;
    Host host;
    write_text(host.outside("file" + row.ending), row.bytes);
    const SwappedFile swapped(host.allowed("file" + row.ending), "no such format", host.outside("file" + row.ending));
    const int tries = row.ending == ".stl" ? 60 : 500;
    int done = 0;
    for (int i = 0; i < tries || swapped.swaps() < 20; ++i)
      done += host.answer(request(name, row, "file" + row.ending)) == "done" ? 1 : 0;
    CHECK(done == 0);
  }
}

TEST_CASE("of a name that is swapped with a link, a closed scope reads the file that lies within, or none") {
  const TemporaryFolder folder;
  for (const char* const each : {"within", "outside"}) fs::create_directories(folder / each);
  write_text(folder / "outside/secret", "secret");
  const SwappedFile swapped(folder / "within/file", "own", folder / "outside/secret");
  const ReadFence fence(closed_scope({folder / "within"}));
  int read = 0, refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    try {
      const Bytes bytes = read_whole_file(folder / "within/file");
      REQUIRE(std::string(bytes.begin(), bytes.end()) != "secret");
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(read > 0);
  CHECK(refused > 0);
}

TEST_CASE("a folder of a closed scope that becomes a link opens nothing") {
  const TemporaryFolder folder;
  for (const char* const each : {"within", "outside"}) fs::create_directories(folder / each);
  write_text(folder / "within/file", "own");
  write_text(folder / "outside/file", "secret");
  const ReadFence fence(closed_scope({folder / "within"}));
  CHECK(read_whole_file(folder / "within/file").size() == 3);
  fs::rename(folder / "within", folder / "moved");
  fs::create_directory_symlink(folder / "outside", folder / "within");
  CHECK_THROWS_AS(read_whole_file(folder / "within/file"), InputError);
}

TEST_CASE("a picture that a request names and that is read later lies within the folders then too") {
  const FileRow row = known_rows().at("part texture");
  for (const bool swaps : {false, true}) {
    Host host;
    write_text(host.outside("file.png"), row.bytes);
    write_text(host.allowed("file.png"), row.bytes);
    const AllowedFolders folders(std::vector<fs::path>{host.allowed()});
    folders.carry_out([&] {
      SceneBuilder(host.built(), {}).execute(folders.parse(request("part texture", row, "file.png"), "request"));
    });
    if (swaps) replace_by_link(host.outside("file.png"), host.allowed("file.png"));
    host.built().scene.read_pictures();
    const std::vector<std::string>& warnings = host.built().scene.warnings();
    CHECK(warnings.size() == (swaps ? 1 : 0));
    if (swaps) CHECK(warnings.back().find("lies outside the folders") != std::string::npos);
  }
}

}  // namespace simvis

TEST_SUITE_END();
